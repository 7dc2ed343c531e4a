"""A wave of negative amplitude turned by half: the same motion and the same sensitivities; closed forms of a cosine."""

import math
from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.positive import phase_of_strength, positive
from gear_damping.identification.output_error.least_squares import Fitted
from gear_damping.identification.output_error.problem import Prediction
from gear_damping.identification.output_error.records import FreeParameter

TIME = torch.linspace(0, 6, 50, dtype=torch.float64)
AMPLITUDE, PHASE, OTHER = "e.amplitude", "e.phase", "k"


def motion(shared, free):
    """Minus the residual of a record: an amplitude and a phase of its own, and a slope."""
    amplitude, phase, slope = (parameter.value(z) for parameter, z in zip(free, shared, strict=True))
    return amplitude * torch.cos(TIME + phase) + slope * TIME


def outcome_of(amplitude, phase, name=PHASE):
    free = [FreeParameter(AMPLITUDE, 0.0, 1e-3), FreeParameter(name, 0.2, 0.5), FreeParameter(OTHER, 1.0)]
    shared = torch.tensor([amplitude / 1e-3, (phase - 0.2) / 0.5, 0.3], dtype=torch.float64)
    jacobian = torch.autograd.functional.jacobian(lambda z: motion(z, free), shared)
    prediction = Prediction(-motion(shared, free).reshape(1, 1, -1), jacobian.reshape(1, 1, *jacobian.shape))
    fitted = Fitted(shared, torch.zeros(1, 0), prediction, 1.0, converged=True)
    values = {p.name: float(p.value(z)) for p, z in zip(free, shared, strict=True)}
    problem = SimpleNamespace(free=free)
    return Outcome(None, problem, fitted, values, [], [], own={"e.phase@held": 1.0, "mesh_phase@held": 1.0})


def candidate_of(phase=None):
    common = [FreeParameter(OTHER, 1.0), FreeParameter(AMPLITUDE, 0.0), FreeParameter(PHASE, 0.0)]
    shared, own = ({1: 2}, {}) if phase is None else ({}, {1: phase})
    return SimpleNamespace(hypothesis=SimpleNamespace(common=common), phases=shared, own_phases=own, own_levels=False)


@pytest.mark.parametrize("name", [PHASE, "e.phase@run"])
def test_the_same_motion_by_a_positive_amplitude(name):
    before = outcome_of(-0.004, 2.9, name)
    after = positive(before, [candidate_of(None if name == PHASE else PHASE)])
    assert after.values[AMPLITUDE] == pytest.approx(0.004)
    assert after.values[name] == pytest.approx(2.9 - math.pi)
    assert after.own == pytest.approx({"e.phase@held": 1.0 - math.pi, "mesh_phase@held": 1.0})
    free = after.problem.free
    torch.testing.assert_close(motion(after.fitted.shared, free), motion(before.fitted.shared, free))
    wanted = torch.autograd.functional.jacobian(lambda z: motion(z, free), after.fitted.shared)
    torch.testing.assert_close(after.fitted.prediction.sensitivity[0, 0], wanted)
    assert before.values[AMPLITUDE] == pytest.approx(-0.004)  # what it was is left alone
    assert float(before.fitted.prediction.sensitivity[0, 0, 0, 0]) == pytest.approx(1e-3 * math.cos(2.9))


def test_a_positive_amplitude_stays():
    before = outcome_of(0.004, 2.9)
    assert positive(before, [candidate_of()]) is before


def test_phases_are_found_by_the_strengths_that_they_turn():
    assert phase_of_strength(candidate_of()) == {AMPLITUDE: PHASE}
    assert phase_of_strength(candidate_of("e.phase")) == {AMPLITUDE: "e.phase"}
