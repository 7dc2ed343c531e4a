"""Inputs that come in steps are told from those that a sensor read."""

import numpy as np
import pytest

from gear_damping.measurement.record import Channel
from gear_damping.measurement.record_checks import _stale
from gear_damping.measurement.staircase import is_staircase

RNG = np.random.default_rng(4)
TIME = np.arange(2000) / 1e3
SINE = np.sin(2 * np.pi * 7 * TIME)
INPUTS = {
    "a switch every sample": (RNG.choice([-1.0, 1.0], 2000), True),
    "levels that are held": (np.repeat(RNG.normal(size=100), 20), True),
    "a converter's levels, held": (np.repeat(RNG.integers(-500, 500, 100), 20) * 0.01, True),
    "a command that goes up and down by one": (np.repeat([0.0, 1, 2, 3, 2, 1, 0], 300), True),
    "a command to either side": (np.repeat([0.0, 2.5, -2.5, 0], 500), True),
    "few levels by chance, each for eight samples": (np.repeat(RNG.integers(-6, 7, 250), 8) * 0.5, True),
    "a command that wanders by two levels": (np.repeat(np.cumsum(RNG.choice([-2, -1, 2], 250)), 8) * 0.5, True),
    "a sine": (SINE, False),
    "a slow sine behind a coarse converter": (np.round(20 * np.sin(2 * np.pi * TIME)) / 20, False),
    "a sine behind a coarse converter": (np.round(20 * SINE) / 20, False),
    "noise behind a coarse converter": (np.round(RNG.normal(size=2000)), False),
    "a hammer between two rests": (np.where(abs(TIME - 1) < 0.02, np.cos(60 * (TIME - 1)), 0.0), False),
    "a constant": (np.ones(2000), False),
    "a chirp that is held for three samples": (np.repeat(np.sin(2 * np.pi * 3 * TIME[::3] ** 2), 3)[:2000], True),
}


@pytest.mark.parametrize("name", INPUTS)
def test_steps_are_told_from_what_was_read(name):
    values, held = INPUTS[name]
    assert is_staircase(values) is held


@pytest.mark.parametrize(
    ("name", "stale", "step", "is_said"),
    [
        ("displacement", True, 0.0, True),
        ("displacement", False, 0.0, False),
        ("displacement", False, 0.4, False),  # a coarse converter repeats what it reads, and moves by its own step
        ("force", True, 0.0, False),  # a command stays
    ],
)
def test_a_response_that_is_read_more_often_than_it_is_measured_is_told(name, stale, step, is_said):
    """A webcam of 12 pictures a second behind rows of 29."""
    time = np.arange(600) / 29
    at = np.floor(time * 12) / 12 if stale else time
    values = 20 * np.exp(-0.05 * at) * np.cos(2 * np.pi * 1.16 * at)
    values = np.round(values, 4) if not step else step * np.round(values / step)
    found = _stale(Channel(name, values, "m", "m", 1.0))
    assert (found is not None) == is_said
    assert not found or found.message.startswith("59 % of the samples of displacement repeat the one before")
