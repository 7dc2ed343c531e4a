"""An input that a controller puts out in steps: exact against the matrix exponential, whatever the sampling."""

import math

import numpy as np
import pytest
import torch
from scipy.linalg import expm

from gear_damping.identification.decimation import decimated
from gear_damping.identification.oscillator.fit import fit_oscillator
from gear_damping.identification.output_error.records import FitRecord, Observed

OMEGA, RATIO, GAIN, RATE = 2 * math.pi * 2.0, 0.05, 30.0, 20.0


def stepped(force, rate):
    """Displacement at the samples, each value of the force staying until the next."""
    a = np.array([[0, 1, 0], [-(OMEGA**2), -2 * RATIO * OMEGA, GAIN], [0, 0, 0]])
    transition, state, found = expm(a / rate), np.zeros(2), []
    for value in force:
        found.append(state[0])
        state = (transition @ np.array([*state, value]))[:2]
    return np.array(found)


def record(force, response, rate, held):
    inputs = {"force": torch.as_tensor(force)}
    return FitRecord(
        "a", torch.as_tensor(response), rate, inputs, observed=Observed(offset=True), held=("force",) * held
    )


def fitted(one):
    fit = fit_oscillator([one])
    return fit.damping_ratio_percent.value / 100, float(fit.residuals["a"].square().mean()) ** 0.5


def test_a_force_in_steps_is_fitted_exactly_where_it_is_held():
    force = np.random.default_rng(1).choice([-1.0, 1.0], 400)
    response = stepped(force, RATE)
    ratio, left = fitted(record(force, response, RATE, held=True))
    assert ratio == pytest.approx(RATIO, rel=1e-3)
    assert left < 1e-4 * response.std()
    _, smooth = fitted(record(force, response, RATE, held=False))
    assert smooth > 0.02 * response.std()


def test_a_lower_rate_keeps_the_time_at_which_a_held_force_acts():
    rate, hold = 1000.0, 10
    force = np.repeat(np.random.default_rng(2).normal(size=5000), hold)
    response = stepped(force, rate)
    errors = []
    for held in (True, False):
        slow = decimated([record(force, response, rate, held)], 1.0)[0]
        assert slow.sampling_rate < rate
        assert not slow.held
        errors.append(fitted(slow)[1])
    assert errors[0] < 0.5 * errors[1]
