"""A sensor that writes one value where the motion is beyond its range, and motions that only look like it."""

import numpy as np
import pytest

from gear_damping.measurement.checks import check_channel
from gear_damping.measurement.out_of_range import out_of_range
from gear_damping.measurement.record import Channel

T = np.arange(2000) / 100
SWING = np.round(12 * np.exp(-0.29 * T) * np.cos(19.5 * T) + np.random.default_rng(5).normal(0, 0.02, T.size), 3)


def _said(values, name="displacement"):
    return out_of_range(Channel(name, values, "mm"))


@pytest.mark.parametrize(("written", "zero"), [(0.0, 0.0), (0.0, 3.0), (-0.25, 0.0)])
@pytest.mark.parametrize("limit", [9.0, 10.0])
def test_a_value_that_is_leapt_to_from_far_out_is_none_of_the_motion(written, zero, limit):
    values = np.where(np.abs(SWING) > limit, written, SWING + zero)
    (found,) = [one for one in check_channel(Channel("displacement", values, "mm"), np.array([], int)) if one]
    assert (found.kind, found.severity) == ("marked_values", "data_problem")
    assert f"leaps to exactly {written:g} mm and back over" in found.message
    assert values[found.sample] == written
    assert values[found.sample - 1] != written


@pytest.mark.parametrize(
    "values",
    [
        SWING,
        np.round(SWING),  # a coarse converter holds its zero
        np.sign(SWING) * np.maximum(np.abs(SWING) - 4, 0),  # it stands in a clearance, and leaves it with small steps
        np.where(np.abs(SWING) > 2, np.sign(SWING) * 5.0, 0.0),  # it goes to and fro between levels
        np.clip(SWING, -8, 8),
        np.where((T > 3) & (T < 3.1), 0.0, SWING),  # once: a link that broke
    ],
)
def test_a_motion_that_stands_or_is_coarse_is_none(values):
    assert _said(values) is None


def test_rates_and_forces_may_leap_from_nothing_and_back():
    pulses = np.where(np.arange(2000) % 200 < 3, 50.0 + T, 0.0)
    assert _said(pulses, "acceleration") is None
    assert _said(pulses, "force") is None
