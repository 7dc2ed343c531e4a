"""Stamps rounded to more than a step, so that many samples share one: an even grid where they tell a round rate."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.timebase import stamped_time
from tests.measurement.bare import inspected

WAVE = 12 * np.cos(0.19 * np.arange(2000))


@pytest.mark.parametrize("rounded", [np.round, np.floor])
@pytest.mark.parametrize(
    ("rate", "digit", "n"),
    [(100.0, 0.1, 2000), (102.4, 0.1, 4000), (25.0, 1.0, 400), (100.0, 1.0, 1200), (1 / 0.003, 0.1, 4000)],
)
def test_a_round_rate_is_told_by_stamps_that_samples_share(rate, digit, n, rounded):
    time = 0.0371 + np.arange(n) / rate
    base = stamped_time(rounded(time / digit) * digit, "t", "a.csv")
    assert base.uniform
    assert base.sampling_rate == pytest.approx(rate, rel=1e-9)
    assert f"rounded to {digit:g} s, or those of whole packets: taken as an even" in base.notes[0]
    np.testing.assert_allclose(base.time, time, atol=1.01 * digit)


def test_stamps_as_a_table_writes_them_tell_their_rate(tmp_path):
    stamps = np.array([float(f"{k / 100:.1f}") for k in range(2000)])
    found = inspected(tmp_path, time=stamps, x=WAVE)
    assert (found.rate, found.faults) == (pytest.approx(100.0, rel=1e-12), ())


def test_where_no_round_rate_is_told_both_readings_and_its_bounds_are_said():
    stamps = np.round(np.arange(600) / 103.27, 1)
    with pytest.raises(InputError, match="repeated") as caught:
        stamped_time(stamps, "t", "a.csv")
    said = str(caught.value)
    assert "rounded to 0.1 s they may stand for any even rate from 103." in said
    assert "give sampling_rate instead of the time column, whose stamps are rounded or of whole packets" in said
    assert "about 103 Hz by them" in said


def test_packets_of_unequal_length_are_no_even_grid():
    rng = np.random.default_rng(0)
    with pytest.raises(InputError, match="rounded or of whole packets"):
        stamped_time(np.repeat(np.arange(200) * 0.1, rng.integers(8, 13, 200)), "t", "a.csv")
