"""Integers that overflow leap over the whole range; a motion that is fast, or that stays inside, does not."""

import numpy as np
import pytest

from gear_damping.measurement.overflow import overflowed
from gear_damping.measurement.record import Channel

RATE, RANGE = 48e3, 200.0
T = np.arange(4000) / RATE


def _decay(amplitude, frequency=1700.0):
    return amplitude * np.exp(-300 * T) * np.sin(2 * np.pi * frequency * T + 0.2)


def _wrapped(values):
    return (values + RANGE) % (2 * RANGE) - RANGE


def _said(values, name="acceleration", full=RANGE):
    return overflowed(Channel(name, values, "m/s^2", declared_unit="m/s^2", range=full))


def test_values_that_came_back_at_the_other_end_are_found():
    values = _decay(260)
    found = _said(_wrapped(values))
    assert found.kind == "overflow"
    assert found.severity == "data_problem"
    assert found.sample == np.flatnonzero(np.abs(values) > RANGE)[0]


@pytest.mark.parametrize(
    "values",
    [_decay(199), np.clip(_decay(260), -RANGE, RANGE), _decay(190, 21e3)],
    ids=["inside", "clipped", "as fast as the rate allows"],
)
def test_what_stays_inside_is_none(values):
    assert _said(values) is None


def test_nothing_is_said_of_an_unknown_range_or_of_an_input():
    assert _said(_wrapped(_decay(260)), full=None) is None
    assert _said(_wrapped(_decay(260)), name="force") is None
