"""Fits whose parameters begin or end at a bound, or far from where they begin."""

import math

import pytest
import torch

from gear_damping.identification.output_error.least_squares import Ends, Rounds, fit
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator

MASS, STIFFNESS, DAMPING, CUBIC = 1.0, (2 * math.pi * 10) ** 2, 4.0, 3e5
COEFFICIENT = "viscous_damping.damping_coefficient"
RATE, SAMPLES = 500.0, 300
MODEL = Model(Oscillator(), [effect_class("viscous_damping")(), effect_class("cubic_stiffness")()])


def decay(stiffness=STIFFNESS, damping=DAMPING, cubic=0.0):
    """A free decay by the classical Runge-Kutta method, forty steps to a sample."""

    def rates(x, v):
        return v, -(damping * v + stiffness * x + cubic * x**3) / MASS

    step, x, v, found = 1 / RATE / 40, 0.05, 0.0, []
    for number in range(40 * SAMPLES):
        found += [x] if number % 40 == 0 else []
        a = rates(x, v)
        b = rates(x + step / 2 * a[0], v + step / 2 * a[1])
        c = rates(x + step / 2 * b[0], v + step / 2 * b[1])
        d = rates(x + step * c[0], v + step * c[1])
        x += step / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
        v += step / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
    return FitRecord("decay", torch.tensor(found, dtype=torch.float64), RATE)


def fitted(record, free, start=None, iterations=20, **given):
    problem = OutputErrorProblem(MODEL, {"stiffness": STIFFNESS, "amplitude": 0.05} | given, free, [record])
    first = torch.zeros(1, len(free), dtype=torch.float64) if start is None else torch.tensor([start]).double()
    found = fit(problem, first, Rounds(iterations), ends=Ends(enough=1e-12))
    return found, {name: float(value) for name, value in problem.unknowns.parameters(found.shared).items()}


def test_a_parameter_that_begins_far_beyond_its_bound_comes_back():
    free = [FreeParameter(COEFFICIENT, 1.0, logarithmic=True, lower=1e-2)]
    given = {"cubic_stiffness.coefficient": 0.0}
    found, values = fitted(decay(), free, [-30.0], **given)
    assert found.converged
    assert values[COEFFICIENT] == pytest.approx(DAMPING, rel=1e-4)


def test_a_strength_far_from_its_scale_is_reached():
    free = [FreeParameter("cubic_stiffness.coefficient", 0.0, scale=CUBIC / 300)]
    found, values = fitted(decay(cubic=CUBIC), free, **{COEFFICIENT: DAMPING})
    assert found.converged
    assert values["cubic_stiffness.coefficient"] == pytest.approx(CUBIC, rel=1e-3)


@pytest.mark.parametrize(("damping", "lower", "upper"), [(2.0, 0.1, 2.0), (6.0, 6.0, 20.0)])
def test_where_a_parameter_is_held_by_its_bound_the_others_are_as_if_it_were_known(damping, lower, upper):
    stiffness = FreeParameter("stiffness", 1.1 * STIFFNESS, logarithmic=True)
    bounded = FreeParameter(COEFFICIENT, math.sqrt(lower * upper), logarithmic=True, lower=lower, upper=upper)
    record, given = decay(), {"cubic_stiffness.coefficient": 0.0}
    found, values = fitted(record, [stiffness, bounded], **given)
    assert found.converged
    assert values[COEFFICIENT] == pytest.approx(damping, rel=1e-5)
    _, known = fitted(record, [stiffness], **given, **{COEFFICIENT: damping})
    assert values["stiffness"] == pytest.approx(known["stiffness"], rel=1e-5)
