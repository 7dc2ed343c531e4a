"""What relieved tips do not carry, against a sum over the pairs of teeth one by one."""

import math

import numpy as np
import pytest
import torch
from effect_bench import Bench

PHASE, RATIO, SPEED, TEETH = 0.7, 1.6, 4600 * math.pi / 30, 20
DEPTH, ASYMMETRY, SHARE, MEETS = 9e-6, 0.3, 0.35, 0.1  # the pinion's tips are cut back more
BATCH = 400


def not_carried(pitches, pressed, length, power):
    """Of a place in base pitches since pair 0 entered: every pair has its own way through the contact."""
    lost, ends = 0.0, 1.0
    for pair in range(-2, math.ceil(pitches) + 1):
        way = pitches - pair
        ends = min(ends, abs(way), abs(way - RATIO))
        if not 0 < way < RATIO:
            continue
        for inside, side in ((way, 1 - ASYMMETRY), (RATIO - way, 1 + ASYMMETRY)):  # a pair parts at the pinion's tip
            relief = side * DEPTH * max(0.0, 1 - inside / length) ** power
            if relief > 0 and pressed > 0:
                lost += (pressed**-4 + relief**-4) ** -0.25
    return lost, ends


@pytest.mark.parametrize("length", [0.25, 0.55])
@pytest.mark.parametrize(("form", "power"), [("linear", 1), ("parabolic", 2)])
@pytest.mark.parametrize("size", [2e-6, 1.6e-5])
def test_a_pair_lacks_its_relief_or_all_that_it_would_carry(length, form, power, size):
    given = {"tip_relief.depth": DEPTH, "tip_relief.length": length, "tip_relief.share": SHARE, "mesh_phase": PHASE}
    given |= {"tip_relief.asymmetry": ASYMMETRY}
    bench = Bench("tip_relief", {"form": form}, given, batch=BATCH)
    time = torch.linspace(0, 7.3 * 2 * math.pi / SPEED / TEETH, BATCH, dtype=torch.float64)
    pressed = size * (1 + torch.sin(torch.arange(BATCH, dtype=torch.float64)))  # to flanks that just part
    pressed[::10] = -size
    at = bench.kinematics(time, (pressed, torch.zeros(BATCH, dtype=torch.float64)))
    bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)
    stiffness = (at.stiffness * bench.unit("N/m")).numpy()
    found = (at.normal_force * bench.unit("N")).numpy() - stiffness * pressed.numpy()
    pitches = (TEETH * SPEED * time.numpy() + PHASE) / (2 * math.pi)
    wanted, ends = np.array([not_carried(*one, length, power) for one in zip(pitches, pressed.numpy(), strict=True)]).T
    inner = ends > MEETS / 2  # nearer a pair is on its way in or out
    assert inner.sum() > BATCH / 2
    off = np.abs(found + SHARE * stiffness * wanted)[inner]
    assert off.max() < 1e-9 * stiffness.max() * DEPTH
    assert np.abs(found[~inner]).max() <= 1.001 * SHARE * stiffness.max() * DEPTH * (2.6 if length > RATIO - 1 else 1.3)


def test_a_relief_shortens_a_light_contact_more_than_a_heavy_one():
    """The share of the mean stiffness that is lost falls with the load."""
    shares = []
    for deflection in (1e-6, 1e-5, 1e-4):
        bench = Bench("tip_relief", {}, {"tip_relief.depth": DEPTH, "tip_relief.length": 0.4}, batch=BATCH)
        time = torch.arange(BATCH, dtype=torch.float64) / BATCH * 2 * math.pi / SPEED / TEETH
        at = bench.kinematics(time, (torch.full_like(time, deflection), torch.zeros_like(time)))
        bench.equation.rates(at, bench.prepared.base, bench.prepared.terms)
        shares.append(float(1 - (at.normal_force / at.stiffness / at.deflection).mean()))
    assert shares[0] > 2 * shares[1] > 8 * shares[2] > 0
