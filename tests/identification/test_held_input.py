"""An input that a controller puts out in steps: exact against the matrix exponential, whatever the sampling."""

import math
from pathlib import Path

import numpy as np
import pytest
import torch
from scipy.linalg import expm

from gear_damping.identification.decimation import decimated
from gear_damping.identification.observation import fit_record
from gear_damping.identification.oscillator.fit import fit_oscillator
from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.measurement.record import Channel, Record
from gear_damping.physics.systems.oscillator import Oscillator

OMEGA, RATIO, GAIN, RATE = 2 * math.pi * 2.0, 0.05, 30.0, 20.0
FAST = 100.0  # Hz, 50 samples a period: within one the force is known by its mean


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


def through(force, stamps, at):
    """Displacement at instants, each value of the force staying from its stamp until the next."""
    a = np.array([[0, 1, 0], [-(OMEGA**2), -2 * RATIO * OMEGA, GAIN], [0, 0, 0]])
    events, state, found = np.union1d(stamps, at), np.zeros(2), {}
    for begin, end in zip(events, np.append(events[1:], events[-1]), strict=True):
        found[begin] = state[0]
        acting = force[max(np.searchsorted(stamps, begin, side="right") - 1, 0)]
        state = (expm(a * (end - begin)) @ np.array([*state, acting]))[:2]
    return np.array([found[one] for one in at])


@pytest.mark.parametrize(("late", "jitter"), [(0.0, 0.2), (0.37, 0.0), (0.37, 0.2)])
def test_a_force_in_steps_is_held_between_uneven_and_late_stamps(late, jitter):
    """Late: its sensor, by a share of a step; the response was sampled at the same stamps."""
    random = np.random.default_rng(3)
    stamps = (np.arange(1500) + jitter * random.uniform(-1, 1, 1500)) / FAST
    force = np.repeat(random.choice([-1.0, 1.0], 60), 25)
    acts = stamps - late / FAST
    response = through(force, acts, np.maximum(stamps, acts[0]))
    left = {}
    for hold in (True, False):
        channels = {
            "displacement": Channel("displacement", response, "m", datum="arbitrary"),
            "force": Channel("force", force, "N", hold=hold, delay=late / FAST),
        }
        rate = (len(stamps) - 1) / (stamps[-1] - stamps[0])
        measured = Record("a", Path("a.csv"), "", "fit", rate, stamps, channels, {}, None, False, jitter == 0)
        one = fit_record(measured, Oscillator)
        assert one.held == ("force",) * hold
        left[hold] = fitted(one)[1] / response.std()
    assert left[True] < 0.003
    assert left[False] > 5 * left[True]
