"""Angles are tried all around, many at once or one after another."""

from math import pi

import pytest
import torch

from gear_damping.identification.output_error import angles
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord, FreeParameter, Observed
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair

RATE, SAMPLES, PHASES = 40_000.0, 300, {"one": 0.9, "two": 4.1}  # Hz, -, rad


def records(responses=None):
    """Two records at different speeds, the second one shorter."""
    found = []
    for name, speed in zip(PHASES, (500.0, 730.0), strict=True):
        count = SAMPLES if name == "one" else SAMPLES // 2
        response = torch.zeros(count, dtype=torch.float64) if responses is None else responses[name][:count]
        angle = {"pinion_angle": speed * torch.arange(count, dtype=torch.float64) / RATE}
        found.append(FitRecord(name, response, RATE, angle, observed=Observed("transmission_error")))
    return found


def problem_of(measured):
    own = [FreeParameter("mesh_phase", 0.0, 0.1, per_record=True)]
    return OutputErrorProblem(
        Model(GearPair(), [FourierMeshStiffness(), ViscousDamping()]), {}, own, measured, noise=1e-8
    )


@pytest.mark.parametrize("most", [1, 10_000, 10**9], ids=["one by one", "some at once", "all at once"])
def test_the_best_is_found_in_every_record(most, monkeypatch):
    monkeypatch.setattr(angles, "MOST_SAMPLES", most)
    still = problem_of(records())
    at = still.unknowns.coordinates({f"mesh_phase@{name}": phase for name, phase in PHASES.items()})
    seen = still.predict(at.unsqueeze(0), still.first_states().unsqueeze(0))[0]
    measured = problem_of(records(dict(zip(PHASES, seen, strict=True))))
    found = angles.scanned(measured, torch.zeros(measured.n_shared, dtype=torch.float64))
    for name, phase in PHASES.items():
        apart = (found[f"mesh_phase@{name}"] - phase + pi) % (2 * pi) - pi
        assert abs(apart) <= pi / angles.STARTS + 1e-9, "the nearest of those that are tried"
