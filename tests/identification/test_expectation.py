"""What is stated of a parameter counts like one sample of what is left, or of the noise where that is more."""

import math

import numpy as np
import pytest
import torch
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares as scipy_least_squares

from gear_damping.identification.output_error.least_squares import fit
from gear_damping.identification.output_error.problem import OutputErrorProblem, samples_alike
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.identification.output_error.uncertainty import noise_covariance
from gear_damping.physics.catalogue import effect_class
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator

STATED, DEVIATION, DAMPING = (2 * math.pi * 10) ** 2, 0.002, 4.0
COEFFICIENT = "viscous_damping.damping_coefficient"
RATE, SAMPLES, NOISE = 500.0, 300, 1e-4
TIME = np.arange(SAMPLES) / RATE


def measured(cubic):
    """A free decay in noise, of a mass of 1 kg on a spring 1 % stiffer than stated, by scipy."""

    def rates(_, state):
        return state[1], -DAMPING * state[1] - 1.01 * STATED * state[0] - cubic * state[0] ** 3

    found = solve_ivp(rates, (0, TIME[-1]), (0.05, 0.0), t_eval=TIME, rtol=1e-9, atol=1e-12).y[0]
    return found + NOISE * np.random.default_rng(0).standard_normal(SAMPLES)


def fitted(values):
    """Stiffness and damping of a linear oscillator by the package, the stiffness as it is stated."""
    free = [
        FreeParameter("stiffness", STATED, logarithmic=True, deviation=DEVIATION),
        FreeParameter(COEFFICIENT, DAMPING, logarithmic=True),
    ]
    model = Model(Oscillator(), [effect_class("viscous_damping")()])
    problem = OutputErrorProblem(
        model, {"amplitude": 0.05}, free, [FitRecord("a", torch.tensor(values), RATE)], noise=NOISE
    )
    return problem, fit(problem, torch.zeros(1, 2, dtype=torch.float64))


def weighed_by(level, values):
    """Coordinates of stiffness and damping and the residual, of a damped cosine and one sample of `level`."""

    def residual(z):
        k, c, x, v = STATED * math.exp(z[0]), DAMPING * math.exp(z[1]), *z[2:]
        omega = math.sqrt(k - c**2 / 4)
        shape = x * np.cos(omega * TIME) + (v + c / 2 * x) / omega * np.sin(omega * TIME)
        return values - np.exp(-c / 2 * TIME) * shape

    rows = scipy_least_squares(
        lambda z: np.append(residual(z), level * z[0] / DEVIATION),
        [0.0, 0.0, 0.05, 0.0],
        x_scale=[1e-2, 1e-1, 1e-2, 1.0],
        xtol=1e-14,
        ftol=1e-14,
    )
    return rows.x[:2], residual(rows.x)


@pytest.mark.parametrize(("lines", "samples"), [(1, 4001), (7, 4001), (50, 6000)])
def test_samples_of_a_few_lines_count_as_few(lines, samples):
    at = np.arange(samples)
    places = 2 * np.pi * (3 + 11 * np.arange(lines)) / samples
    series = torch.tensor(np.cos(np.outer(at, places) + np.arange(lines)).sum(1))
    assert float(samples_alike(series[None])) == pytest.approx((samples // 2 + 1) / (2 * lines), rel=1e-3)
    assert samples_alike(series.new_zeros(0, 2, samples)).shape == (0,)


@pytest.mark.parametrize("shape", [(1, 200), (4, 3000), (9, 801)])
def test_samples_of_white_noise_count_as_many(shape):
    drawn = torch.tensor(np.random.default_rng(2).normal(size=(200, *shape)))
    assert float((samples_alike(drawn) == 1).double().mean()) > 0.98


def test_lines_of_a_mesh_count_as_few_and_a_decay_as_all_of_its_samples():
    """A residual of one line beside a prior of .2 %: of a gear pair as two samples, of an oscillator as 300."""
    line = torch.tensor(np.cos(2 * np.pi * 9 * np.arange(SAMPLES) / SAMPLES))[None, None]
    record = FitRecord("a", torch.zeros(SAMPLES, dtype=torch.float64), RATE, {}, {"pinion_speed": 10.0})
    pair = Model(GearPair(), [effect_class(name)() for name in ("fourier_mesh_stiffness", "viscous_damping")])
    levels = [
        float(OutputErrorProblem(model, {"amplitude": 0.05} if known else {}, [], [record], noise=NOISE).level(line))
        for model, known in ((pair, False), (Model(Oscillator(), [effect_class("viscous_damping")()]), True))
    ]
    assert levels == pytest.approx([0.5**0.5 * (151 / 2) ** 0.5, 0.5**0.5], rel=1e-6)


@pytest.mark.parametrize("cubic", [0.0, 3e5])
def test_it_is_weighed_against_what_is_left(cubic):
    """Without a cubic spring that is the noise; with one it is a hundred times as much, and the statement counts."""
    values = measured(cubic)
    problem, found = fitted(values)
    left = float(found.prediction.residual.square().mean().sqrt())
    at, residual = weighed_by(max(left, NOISE), values)
    assert np.sqrt(np.mean(residual**2)) == pytest.approx(left, rel=1e-3)
    assert found.shared.numpy() == pytest.approx(at, rel=1e-3, abs=1e-5)
    by_noise, _ = weighed_by(NOISE, values)
    assert (abs(by_noise[0] - at[0]) > DEVIATION) == (cubic > 0)
    assert problem.expectation(found.shared, found.prediction.residual[0])[1][0] == pytest.approx(
        max(left, NOISE) / DEVIATION, rel=1e-6
    )


def test_the_interval_of_what_nothing_else_tells_is_the_stated_one():
    """A stiffness that the record hardly shows keeps the deviation that is stated of it, however much is left."""
    values = np.full(SAMPLES, 0.0)
    values[::2] = 1e3 * NOISE
    problem, found = fitted(values - values.mean())
    noise = float(found.prediction.residual.square().mean().sqrt())
    variance = noise_covariance(problem, found)[0, 0] * (noise / NOISE) ** 2
    assert float(variance.sqrt()) == pytest.approx(DEVIATION, rel=0.05)
