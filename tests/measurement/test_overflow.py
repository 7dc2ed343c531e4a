"""Integers that overflow leap over the whole range; a motion that is fast, or that stays inside, does not."""

import numpy as np
import pytest

from gear_damping.measurement.overflow import overflowed
from gear_damping.measurement.record import Channel
from gear_damping.measurement.wraps import run_over

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


COUNTED = 5 * np.exp(-0.031 * 45.87 * np.arange(1200) / 200) * np.cos(45.87 * np.arange(1200) / 200 + 0.3)


@pytest.mark.parametrize(("bits", "gain"), [(8, 30), (12, 500), (16, 8000), (16, 12000), (24, 2500000)])
def test_integers_with_a_sign_that_ran_over_their_register_are_found(bits, gain):
    half = 2 ** (bits - 1)
    counts = np.round(gain * COUNTED)
    wrapped = (counts + half) % (2 * half) - half
    found = run_over(wrapped, "displacement", "cnt")
    assert (found.kind, found.severity) == ("run_over", "data_problem")
    assert np.abs(wrapped[found.sample] - wrapped[found.sample - 1]) > half
    assert f"by about {2 * half} from sample to sample" in found.message
    assert f"integers from {-half} to {half - 1}" in found.message


@pytest.mark.parametrize("period", [2.1, 2.6, 4.0, 9.3, 27.4])
def test_counts_with_a_sign_that_stay_inside_did_not_run_over(period):
    rng, n = np.random.default_rng(3), np.arange(3000)
    for size in (30, 100, 127, 2000, 32767):
        swing = size * np.exp(-0.003 * n) * np.cos(2 * np.pi * n / period + 0.4)
        assert run_over(np.round(swing), "displacement", "cnt") is None, size
        assert run_over(np.round(size / 4 * rng.standard_normal(n.size)), "displacement", "cnt") is None, size


def test_the_register_of_a_counter_is_not_one_count_short():
    found = run_over(np.round(500 * COUNTED + 800) % 4096, "displacement", "cnt")
    assert "take 4096 from those above 2047" in found.message
    assert "gain: 4096" in found.message
