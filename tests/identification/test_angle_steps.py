"""Angles in steps, against how the shaft turned."""

import numpy as np
import pytest

from gear_damping.identification.angle_steps import between_steps

RATE, SAMPLES = 50e3, 4000


def turned(rpm, wobble=1e-3):
    """An angle with a wobble once a turn and a slow drift of the speed."""
    time = np.arange(SAMPLES) / RATE
    angle = rpm * np.pi / 30 * time * (1 + 0.002 * np.sin(30 * time))
    return angle + wobble * np.sin(angle)


@pytest.mark.parametrize("rpm", [60, 900, 3100, 9000])
@pytest.mark.parametrize("counts", [1024, 4096, 65536])
def test_the_rounding_is_taken_out_and_the_turning_is_not(rpm, counts):
    angle, step = turned(rpm), 2 * np.pi / counts
    recorded = step * np.floor(angle / step)
    found = between_steps(recorded)
    error = found - angle
    assert np.std(error) < 0.4 * np.std(recorded - angle)
    assert abs(error.mean() + step / 2) < 0.1 * step


def test_advances_between_two_roundings_of_their_digits_are_one_advance():
    angle, step = turned(900), 1e-3 + 0.5e-9
    recorded = 7.3 + step * np.floor(angle / step)
    assert np.std(between_steps(recorded) - 7.3 - angle) < 0.4 * np.std(recorded - 7.3 - angle)


def test_an_angle_without_steps_stays_as_it_is():
    angle = turned(3100) + 5e-6 * np.random.default_rng(1).standard_normal(SAMPLES)
    assert between_steps(angle) is angle


def test_noise_larger_than_the_steps_is_no_reason_to_smooth():
    angle = turned(3100) + 1e-4 * np.random.default_rng(2).standard_normal(SAMPLES)
    rounded = 1e-6 * np.round(angle / 1e-6)
    np.testing.assert_array_equal(between_steps(rounded), rounded)


def test_a_shaft_that_stands_still_stays_where_it_is():
    np.testing.assert_allclose(between_steps(np.full(100, 0.3)), 0.3)
