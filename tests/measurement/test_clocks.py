"""Clocks as other programs write them, and files that a recorder did not finish."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.moments import is_moment, moments_of
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.recordings import past_overflow, recordings

HUNDREDTHS = np.arange(0, 3.2, 0.01)


@pytest.mark.parametrize(
    "form",
    [
        "01-Mar-2024 12:00:{:06.3f}",  # MATLAB
        "20240301T1200{:06.3f}",  # ISO 8601 without signs
        "2024-03-01T12:00:{:06.3f}+01:00",
        "1 Mar 2024 12:00:{:06.3f}",
        "2024年3月1日 12:00:{:06.3f}",
        "01/03/2024 02:00:{:06.3f} p. m.",
        "0 days 00:00:{:06.3f}",  # pandas
        "2 days, 0:00:{:06.3f}",  # Python
        "2024/03/01-12:00:{:06.3f}",
        "2024-061 12:00:{:06.3f}",  # the day of a leap year
    ],
)
def test_dates_with_clocks_are_seconds_from_the_first(form):
    texts = [form.format(second) for second in HUNDREDTHS]
    assert is_moment(texts[0])
    np.testing.assert_allclose(moments_of(texts).seconds, HUNDREDTHS, atol=1e-9)


def test_a_time_that_runs_past_a_day_says_the_days_before_its_clock():
    """As .NET writes a TimeSpan: without a day below one."""
    texts = [f"23:59:{58 + k / 10:06.3f}" for k in range(20)] + [f"1.00:00:{k / 10:06.3f}" for k in range(20)]
    np.testing.assert_allclose(moments_of(texts).seconds, np.arange(40) / 10, atol=1e-9)


@pytest.mark.parametrize("frames", [24, 25, 30])
def test_the_last_number_of_a_time_code_counts_frames(frames):
    texts = [f"00:00:{k // frames:02d}:{k % frames:02d}" for k in range(5 * frames)]
    np.testing.assert_allclose(moments_of(texts).seconds, np.arange(5 * frames) / frames, atol=1e-9)


def test_hundredths_behind_a_colon_are_no_frames():
    texts = [f"00:00:{k // 100:02d}:{k % 100:02d}" for k in range(320)]
    np.testing.assert_allclose(moments_of(texts).seconds, HUNDREDTHS, atol=1e-9)


def test_what_a_clock_says_of_a_second_goes_on_behind_it():
    time = 0.412 + np.arange(1000) / 200
    np.testing.assert_allclose(past_overflow(time % 1.0), time, atol=1e-9)


def test_recordings_of_a_second_each_stay_apart():
    time = np.tile(np.arange(200) / 200, 3)
    assert recordings(time) == [(0, 200), (200, 400), (400, 600)]


@pytest.mark.parametrize(
    ("end", "rows", "said"),
    [("", 40, ""), ("1,2", 40, " and the line before them"), ("1", 40, " and the line before them")],
)
def test_zeros_that_a_recorder_left_when_its_power_failed_are_left_out(tmp_path, end, rows, said):
    body = "".join(f"{k},{0.5 * k}\n" for k in range(rows))
    (tmp_path / "run.csv").write_bytes(f"t,x\n{body}{end}".encode() + bytes(512))
    table = read_table(tmp_path / "run.csv")
    assert table.values(1).tolist() == [0.5 * k for k in range(rows)]
    assert any("512 bytes of zero at its end" + said in note for note in table.notes)


def test_numbers_with_their_unit_behind_them_are_read_in_it(tmp_path):
    body = "".join(f"{0.005 * k:g} sec,{0.5 * k}\n" for k in range(40))
    (tmp_path / "run.csv").write_text("Time,x\n" + body)
    table = read_table(tmp_path / "run.csv")
    assert table.unit(0) == "sec"
    np.testing.assert_allclose(table.values(0), 0.005 * np.arange(40), atol=1e-12)


def test_a_unit_in_cells_that_contradicts_the_header_is_no_number(tmp_path):
    body = "".join(f"{0.005 * k:g} ms,{0.5 * k}\n" for k in range(40))
    (tmp_path / "run.csv").write_text("Time [s],x\n" + body)
    with pytest.raises(InputError, match="'0 ms': not a number"):
        read_table(tmp_path / "run.csv").values(0)


def test_a_clock_that_is_put_back_within_its_zone_goes_on():
    texts = [f"2024-10-27T02:59:{58 + k / 2:04.1f}+02:00" for k in range(4)]
    texts += [f"2024-10-27T02:00:{k / 2:04.1f}+01:00" for k in range(4)]
    np.testing.assert_allclose(moments_of(texts).seconds, np.arange(8) / 2, atol=1e-9)


def test_stamps_of_whole_packets_are_not_left_out_row_by_row(tmp_path):
    rows = [f"{0.05 * (k // 10):.3f},{np.cos(0.1 * k):.5f}" for k in range(400)]
    (tmp_path / "a.csv").write_text("t,x\n" + "\n".join(rows))
    channels = "{time: {column: t, unit: s}, displacement: {column: x, unit: mm}}"
    (tmp_path / "m.yaml").write_text(f"system: oscillator\nrecords: [{{file: a.csv, channels: {channels}}}]\n")
    with pytest.raises(InputError, match=r"360 repeated time stamp.*10 samples at each.*give sampling_rate") as caught:
        load_measurement(tmp_path / "m.yaml")
    assert "leave those rows out" not in str(caught.value)


@pytest.mark.parametrize(
    "form", ["2024-03-01_12-00-{:02d}.{:03d}", "2024-03-01 12-00-{:02d}_{:03d}", "2024_03_01-12.00.{:02d},{:03d}"]
)
def test_a_clock_as_it_stands_in_names_of_files(form):
    texts = [form.format(k // 100, 10 * (k % 100)) for k in range(320)]
    np.testing.assert_allclose(moments_of(texts).seconds, HUNDREDTHS, atol=1e-9)


def test_a_date_among_numbers_is_what_a_spreadsheet_made_of_one(tmp_path):
    body = "".join(f"{k / 100},{'2024-01-05' if k == 30 else 0.5 * k}\n" for k in range(60))
    (tmp_path / "run.csv").write_text(f"t,x\n{body}")
    channels = "{time: {column: t, unit: s}, displacement: {column: x, unit: mm}}"
    (tmp_path / "m.yaml").write_text(f"system: oscillator\nrecords: [{{file: run.csv, channels: {channels}}}]\n")
    with pytest.raises(InputError, match=r"where a spreadsheet made a date of a number, correct the cell"):
        load_measurement(tmp_path / "m.yaml")
