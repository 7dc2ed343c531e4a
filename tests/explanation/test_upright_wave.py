"""The ideal wave upside down, moved by the part in which two pairs carry, is the same wave."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.fitting import InitialValues, fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis
from gear_damping.explanation.model.nominal_gear_pair import upright
from gear_damping.identification.observation import MESH_PHASE, Known
from gear_damping.identification.output_error.least_squares import Rounds
from gear_damping.identification.output_error.records import FitRecord, FreeParameter, Observed
from gear_damping.measurement.record import Channel
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.simulation.simulate import simulate

RATE, SAMPLES, SPEEDS, PHASES = 20_000.0, 1200, (300.0, 410.0), (0.7, 4.1)
NOISE = 1e-10  # m; of the transmission error's micrometres, so that no cost is that of rounding alone
MESH = "fourier_mesh_stiffness"
TRUE = {f"{MESH}.maximum": 3.4e8, f"{MESH}.minimum": 2.1e8, f"{MESH}.contact_ratio": 1.45}


@pytest.fixture(scope="module")
def mirrored():
    """A fit that stands at the mirror of what made the records, one phase a record; and its evidence."""
    effects = (FourierMeshStiffness(), ViscousDamping())
    model, records = Model(GearPair(), list(effects)), []
    noise = NOISE * torch.randn(len(PHASES), SAMPLES, dtype=torch.float64, generator=torch.Generator().manual_seed(3))
    for number, (speed, phase) in enumerate(zip(SPEEDS, PHASES, strict=True)):
        given = {"pinion_speed": speed, "mesh_phase": phase, "pinion_torque": 100.0}
        runs = simulate(model, model.values(1, **TRUE, **given), sampling_rate=RATE, n_samples=SAMPLES)
        conditions = {"pinion_speed": speed, "pinion_torque": 100.0}
        seen = Observed("transmission_error")
        known = {"observed": seen, "own": (MESH_PHASE,)}
        records.append(FitRecord(f"r{number}", runs.response[0] + noise[number], RATE, {}, conditions, **known))
    channel = Channel("transmission_error", np.zeros(1), "m")
    evidence = Evidence("gear_pair", tuple(records), tuple(records[:1]), Known({}, {}), channel, False, noise=NOISE)
    high, low, ratio = TRUE.values()
    begun = {f"{MESH}.maximum": low, f"{MESH}.minimum": high, f"{MESH}.contact_ratio": 3 - ratio}
    free = [FreeParameter(name, value, 0.2 if value < 3 else value) for name, value in begun.items()]
    own = {f"mesh_phase@r{n}": phase - 2 * np.pi * (ratio - 1) for n, phase in enumerate(PHASES)}
    hypothesis = Hypothesis(GearPair(), effects, begun, tuple(free))
    return fit_hypothesis(hypothesis, evidence, InitialValues(own=own), Rounds(15)), evidence


def test_it_is_turned_and_the_phases_with_it(mirrored):
    found, evidence = mirrored
    assert found.fitted.cost < 1.1 * len(PHASES) * SAMPLES * evidence.noise**2  # the mirror is the same wave
    assert found.values[f"{MESH}.maximum"] < found.values[f"{MESH}.minimum"]
    turned = upright(found, evidence)
    for name, value in TRUE.items():
        assert turned.values[name] == pytest.approx(value, rel=1e-4)
    for number, phase in enumerate(PHASES):
        away = turned.values[f"mesh_phase@r{number}"] - phase
        assert np.angle(np.exp(1j * away)) == pytest.approx(0, abs=1e-3)


def test_one_that_stands_upright_stays(mirrored):
    turned = upright(*mirrored)
    assert upright(turned, mirrored[1]) is turned
    values = {name: value for name, value in turned.values.items() if "contact_ratio" not in name}
    standing = replace(turned, values=values | {f"{MESH}.minimum": 9e8})
    assert upright(standing, mirrored[1]) is standing
    assert torch.isfinite(torch.tensor(turned.fitted.cost))
