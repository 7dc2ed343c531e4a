"""Where a residual of a gear pair rings away from the orders of its shafts, and the torsion that begins there."""

import math

import pytest
import torch

from gear_damping.explanation.model.rig import ringing_frequencies
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.cause import Rig
from gear_damping.physics.effects.shaft_torsion import ShaftTorsion
from gear_damping.physics.systems.gear_pair import GearPair

RATE, PINION, GEAR = 20e3, 31, 45
VALUES = {"natural_frequency": 2 * math.pi * 2500.0, "pinion_speed": 100.0}


def left_of(ring, rpm, seed=0):
    """What is left of .3 s: orders of both shafts and of the mesh, and a ring after a step."""
    time = torch.arange(6000, dtype=torch.float64) / RATE
    turned = 2 * math.pi * rpm / 60 * time
    orders = (1, 2, PINION / GEAR, 2 * PINION / GEAR, PINION, 2 * PINION)
    left = sum(torch.cos(order * turned + order) for order in orders)
    since = (time - 0.12).clamp(min=0)
    left = left + ring * torch.exp(-30 * since) * torch.sin(2 * math.pi * 170.0 * since)
    left = left + 0.05 * torch.randn(6000, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)
    record = FitRecord("a", left, RATE, conditions={"pinion_speed": 2 * math.pi * rpm / 60})
    return record, left


def test_a_ring_after_a_step_is_found_beside_larger_orders():
    found = ringing_frequencies([left_of(0.4, 760), left_of(0.0, 1480, 1), left_of(0.4, 1120, 2)], PINION, GEAR, VALUES)
    assert found == pytest.approx((170.0,), rel=0.02)


def test_orders_alone_are_none_and_neither_is_noise():
    assert ringing_frequencies([left_of(0.0, 760), left_of(0.0, 1480, 1)], PINION, GEAR, VALUES) == ()
    assert ringing_frequencies([], PINION, GEAR, VALUES) == ()


def test_a_torsion_is_tried_where_it_swings_there():
    """By the two-mass formula, k (1 / J + 1 / I) with I = I1 + I2 (r1 / r2)^2 for the shaft of the pinion."""
    base = {"mean_stiffness": 2.3e8, "base_radius_pinion": 0.03, "base_radius_gear": 0.04}
    values = base | {"inertia_pinion": 4e-3, "inertia_gear": 2e-3}
    recipes = ShaftTorsion.cause.recipes_for(Rig(GearPair.name, values=values, frequencies=(170.0,)))
    of_pinion = [one for one in recipes if one.options["shaft"] == "pinion"]
    gears = 4e-3 + 2e-3 * (0.03 / 0.04) ** 2
    swings = [
        math.sqrt(one.strengths["stiffness"] * (1 / one.scanned["motor_inertia"] + 1 / gears)) / (2 * math.pi)
        for one in of_pinion
    ]
    assert sum(swing == pytest.approx(170.0) for swing in swings) == len(
        {one.scanned["motor_inertia"] for one in of_pinion}
    )
