"""Stamps in days, in ticks of 100 ns, and such as a clock beside them contradicts, are not taken for seconds."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement

SECONDS = np.arange(400) * 0.02
MOTION = np.exp(-0.05 * SECONDS) * np.cos(5.6 * SECONDS)
DAYS = {"excel": 45356.586, "matlab": 739316.586, "julian": 2460371.086}


def declared(folder, stamps, unit, more="", columns="t,x", rows=None):
    rows = rows or [f"{t},{x:.6f}" for t, x in zip(stamps, MOTION, strict=True)]
    (folder / "a.csv").write_text("\n".join([columns, *rows]) + "\n")
    (folder / "m.yaml").write_text(
        "system: oscillator\nrecords:\n  - file: a.csv\n    channels:\n"
        f"      time: {{column: t, unit: {unit}}}\n      displacement: {{column: x, unit: mm}}\n{more}"
    )
    return folder / "m.yaml"


@pytest.mark.parametrize("first", DAYS.values(), ids=DAYS)
def test_days_are_no_seconds(first, tmp_path):
    stamps = [f"{first + s / 86400:.12f}" for s in SECONDS]
    with pytest.raises(InputError, match=r"look like days .* write unit: day"):
        load_measurement(declared(tmp_path, stamps, "s"))
    record = load_measurement(declared(tmp_path, stamps, "day")).records[0]
    assert record.time[-1] - record.time[0] == pytest.approx(SECONDS[-1], rel=1e-4)


@pytest.mark.parametrize("first", DAYS.values(), ids=DAYS)
def test_a_clock_of_seconds_that_has_run_as_long_is_one(first, tmp_path):
    record = load_measurement(declared(tmp_path, [f"{first + s:.3f}" for s in SECONDS], "s")).records[0]
    assert record.time[-1] - record.time[0] == pytest.approx(SECONDS[-1], rel=1e-6)


@pytest.mark.parametrize("first", [133541174300000000, 638451000000000000], ids=["windows", ".net"])
def test_ticks_of_100_ns_are_told(first, tmp_path):
    stamps = [str(first + round(s * 1e7)) for s in SECONDS]
    with pytest.raises(InputError, match="ticks of 100 ns, as Windows counts them; remedy: divide the column by 10"):
        load_measurement(declared(tmp_path, stamps, "us"))


def test_stamps_that_a_clock_in_the_same_rows_contradicts_are_refused(tmp_path):
    seconds = 5 * SECONDS
    clocks = [f"05.03.2024 14:03:{10 + int(s):02d}" for s in seconds]
    rows = [f"{t},{c},{x:.6f}" for t, c, x in zip(seconds * 86.4, clocks, MOTION, strict=True)]
    path = declared(tmp_path, None, "s", columns="t,clock,x", rows=rows)
    with pytest.raises(InputError, match=r"last 3447 s, and the clock 'clock' in the same rows 39 s"):
        load_measurement(path)
    rows = [f"{t},{c},{x:.6f}" for t, c, x in zip(seconds, clocks, MOTION, strict=True)]
    record = load_measurement(declared(tmp_path, None, "s", columns="t,clock,x", rows=rows)).records[0]
    assert record.sampling_rate == pytest.approx(10)


def test_inspect_proposes_days(tmp_path):
    path = declared(tmp_path, [f"{DAYS['excel'] + s / 86400:.12f}" for s in SECONDS], "day")
    found = inspect_table(read_table(path.parent / "a.csv"))
    assert found.time.unit == "day"


@pytest.mark.parametrize("name", ["Sample", "No.", "Frame", "Index", "frame number"])
@pytest.mark.parametrize("unit", ["s", "ms"])
def test_row_numbers_are_no_time(name, unit, tmp_path):
    path = declared(tmp_path, range(1, 401), unit, columns=f"{name},x")
    path.write_text(path.read_text().replace("column: t", "column: 0"))
    with pytest.raises(InputError, match=r"channels\.time = 0: counts the rows.*; remedy: give sampling_rate in its"):
        load_measurement(path)


def test_row_numbers_beside_a_step_that_the_file_states_are_no_time(tmp_path):
    path = declared(tmp_path, range(400), "s", columns="Sample Interval,0.02\nt,x")
    with pytest.raises(InputError, match=r"counts the rows.*'Sample Interval' beside the table says 50 Hz"):
        load_measurement(path)


def test_seconds_that_go_on_by_one_are_a_time(tmp_path):
    path = declared(tmp_path, range(400), "s", columns="Sample Interval,1\nt,x")
    assert load_measurement(path).records[0].sampling_rate == pytest.approx(1.0)
    assert load_measurement(declared(tmp_path, range(400), "s")).records[0].sampling_rate == pytest.approx(1.0)


def test_a_free_clock_of_microseconds_is_not_counted_from_1970_in_seconds(tmp_path):
    rows = "\n".join(f"{3_200_000_000 + 10_000 * k},{x:.6f}" for k, x in enumerate(MOTION))
    (tmp_path / "dot.csv").write_text("SampleTimeFine,x\n" + rows + "\n")
    found = inspect_table(read_table(tmp_path / "dot.csv"))
    assert (found.time.unit, found.rate) == ("us", pytest.approx(100.0))


@pytest.mark.parametrize("cut", [0, 17])
def test_packets_that_share_a_stamp_tell_their_rate(cut, tmp_path):
    """Clocks of whole seconds, 25 samples to each; the first packet may be cut, and the last one."""
    rows = "\n".join(f"14:03:{10 + k // 25:02d},{x:.6f}" for k, x in enumerate(MOTION[cut : 400 - cut], cut))
    (tmp_path / "a.csv").write_text("time,x\n" + rows + "\n")
    assert inspect_table(read_table(tmp_path / "a.csv")).rate == pytest.approx(25.0)


@pytest.mark.parametrize("wrong", [3000.0, -30.0])
def test_one_garbled_stamp_is_named_and_no_second_recording(wrong, tmp_path):
    stamps = SECONDS.copy()
    stamps[200] = wrong
    with pytest.raises(InputError, match=r"1 backward time stamp\(s\), the first at sample 200; remedy: leave those"):
        load_measurement(declared(tmp_path, stamps, "s"))


@pytest.mark.parametrize(
    ("name", "unit", "right"), [("t_ms", "s", "ms"), ("time_us", "ms", "us"), ("Time_s", "ms", "s")]
)
def test_the_ending_of_a_name_is_heeded(name, unit, right, tmp_path):
    path = declared(tmp_path, SECONDS, unit, columns=f"{name},x")
    path.write_text(path.read_text().replace("column: t", f"column: {name}"))
    with pytest.raises(InputError, match=f"the column is named '{name}'; remedy: write unit: {right}, or give"):
        load_measurement(path)
    path.write_text(path.read_text().replace(f"unit: {unit}", f"unit: {right}"))
    assert load_measurement(path).records[0].sampling_rate > 49


@pytest.mark.parametrize(("columns", "named"), [("n,Time (s),x", "column 'Time (s)'"), ("", "column 1")])
def test_row_numbers_before_a_column_that_goes_like_a_clock_are_no_time(columns, named, tmp_path):
    rows = [f"{k + 1},{t:.4f},{x:.6f}" for k, (t, x) in enumerate(zip(SECONDS, MOTION, strict=True))]
    path = declared(tmp_path, None, "s", columns=columns, rows=rows)
    path.write_text(path.read_text().replace("column: t", "column: 0").replace("column: x", "column: 2"))
    with pytest.raises(InputError) as caught:
        load_measurement(path)
    assert f"remedy: name {named} as the time" in str(caught.value)


def test_milliseconds_beside_the_seconds_of_the_same_rows_are_a_time(tmp_path):
    rows = [f"{k},{k / 1000:.3f},{x:.6f}" for k, x in enumerate(MOTION)]
    record = load_measurement(declared(tmp_path, None, "ms", columns="t,Time (s),x", rows=rows)).records[0]
    assert record.sampling_rate == pytest.approx(1000)
    assert record.findings == ()


@pytest.mark.parametrize(("first", "unit", "is_said"), [(0, "s", True), (1, "ms", True), (0, "ms", False)])
def test_stamps_that_go_on_by_one_are_said_where_they_may_be_row_numbers(first, unit, is_said, tmp_path):
    record = load_measurement(declared(tmp_path, range(first, first + 400), unit)).records[0]
    notes = [one for one in record.findings if one.kind == "row_numbers"]
    assert [one.severity for one in notes] == ["note"] * is_said
    assert all("give sampling_rate in its place" in one.message for one in notes)


def test_row_numbers_beside_the_axis_of_a_signal_analyser_are_no_time(tmp_path):
    path = declared(tmp_path, range(1, 401), "s", columns="X-axis delta,2.0E-2")
    path.write_text(path.read_text().replace("column: t", "column: 0").replace("column: x", "column: 1"))
    with pytest.raises(InputError, match=r"counts the rows.*'X-axis delta' beside the table says 50 Hz"):
        load_measurement(path)


@pytest.mark.parametrize(
    ("name", "unit", "right"), [("millis", "s", "ms"), ("micros", "ms", "us"), ("t_nanos", "s", "ns")]
)
def test_the_clocks_of_a_controller_are_in_their_own_unit(name, unit, right, tmp_path):
    stamps = [20 * k + 31234 for k in range(400)]
    path = declared(tmp_path, stamps, unit, columns=f"{name},x")
    path.write_text(path.read_text().replace("column: t", f"column: {name}"))
    with pytest.raises(InputError, match=f"the column is named '{name}'; remedy: write unit: {right}"):
        load_measurement(path)
    path.write_text(path.read_text().replace(f"unit: {unit}", f"unit: {right}"))
    assert load_measurement(path).records[0].time.size == 400


OTHER_STAMPS = {
    "part of a day": ([f"{0.5 + s / 86400:.12f}" for s in SECONDS / 4], "parts of a day; remedy: write unit: day"),
    "year": ([f"{2024.16 + s / 31557600:.13f}" for s in SECONDS / 4], "years; remedy: take the year off"),
    "clock": (
        [f"1159{50000 + round(1000 * s):05d}" for s in SECONDS],
        r"clocks HHMMSSmmm; remedy: write them as 12:34",
    ),
    "date": ([f"20240301115{950000 + round(1000 * s):06d}" for s in SECONDS], "dates YYYYMMDDHHMMSSmmm; remedy: write"),
    "WinCC": ([f"{45352.5e6 + s / 0.0864:.6f}" for s in SECONDS], r"days since 1900, times 10\^6; .* make 50 Hz"),
}


@pytest.mark.parametrize(("stamps", "said"), OTHER_STAMPS.values(), ids=OTHER_STAMPS)
def test_numbers_of_dates_and_clocks_are_no_seconds(stamps, said, tmp_path):
    with pytest.raises(InputError, match=f"look like {said}"):
        load_measurement(declared(tmp_path, stamps, "s"))


@pytest.mark.parametrize("first", [0.0, 0.5, 2024.16])
def test_a_fast_clock_that_is_not_beside_its_first_stamp_is_one(first, tmp_path):
    record = load_measurement(declared(tmp_path, [f"{first + s / 100:.6f}" for s in SECONDS], "s")).records[0]
    assert record.sampling_rate == pytest.approx(5000)


def test_days_of_a_column_that_is_named_after_milliseconds_are_read(tmp_path):
    path = declared(tmp_path, [f"{45352.5 + s / 86400:.12f}" for s in SECONDS], "day", columns="Time_ms,x")
    path.write_text(path.read_text().replace("column: t", "column: Time_ms"))
    assert load_measurement(path).records[0].sampling_rate == pytest.approx(50, rel=1e-3)


@pytest.mark.parametrize(("factor", "is_refused"), [(1.0, False), (1.5, False), (86.4, True), (0.014, True)])
def test_a_clock_of_a_few_whole_seconds_tells_a_grossly_wrong_unit(factor, is_refused, tmp_path):
    rows = [
        f"{factor * s:.6f},01.03.2024 12:00:{int(s):02d},{x:.6f}" for s, x in zip(SECONDS * 0.7, MOTION, strict=True)
    ]
    path = declared(tmp_path, None, "s", columns="t,clock,x", rows=rows)
    if is_refused:
        with pytest.raises(InputError, match="the clock 'clock' in the same rows 5 s"):
            load_measurement(path)
    else:
        assert load_measurement(path).records[0].sampling_rate == pytest.approx(50 / 0.7 / factor, rel=1e-3)


SPLIT = 0.4 + SECONDS[:300]  # s, over fewer whole seconds than tell a rate


@pytest.mark.parametrize("clock", ["170929080", "12:00:0"], ids=["number", "clock"])
@pytest.mark.parametrize(("unit", "in_a_second"), [("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_whole_seconds_are_completed_by_the_column_of_their_parts(clock, unit, in_a_second, tmp_path):
    rows = [
        f"{clock}{int(s + 1e-9)},{round((s + 1e-9) % 1 * in_a_second)},{x:.6f}"
        for s, x in zip(SPLIT, MOTION, strict=False)
    ]
    path = declared(tmp_path, None, "s", columns="t,part,x", rows=rows)
    if ":" in clock:
        path.write_text(path.read_text().replace(", unit: s", ""))
    with pytest.raises(InputError, match=f"repeated .* remedy: name column 'part' in its place, with unit: {unit}"):
        load_measurement(path)
    path.write_text(path.read_text().replace("time: {column: t", "time: {column: part").replace(", unit: s", ""))
    path.write_text(path.read_text().replace("{column: part", f"{{column: part, unit: {unit}"))
    assert load_measurement(path).records[0].sampling_rate == pytest.approx(50)


@pytest.mark.parametrize(("name", "few"), [("dt_ms", False), ("t", True)])
def test_steps_from_row_to_row_are_no_stamps(name, few, tmp_path):
    steps = np.random.default_rng(2).uniform(18, 22, SECONDS.size)
    path = declared(tmp_path, np.round(steps) if few else steps, "ms", columns=f"{name},x")
    path.write_text(path.read_text().replace("column: t,", f"column: {name},"))
    with pytest.raises(InputError) as caught:
        load_measurement(path)
    (problem,) = caught.value.problems
    assert "steps from row to row, and no clock" in problem.rule
    assert f"on average they make {1e3 / np.mean(steps):.2g}" in problem.remedy


def test_rows_in_another_order_are_no_steps(tmp_path):
    stamps = np.random.default_rng(2).permutation(SECONDS)
    with pytest.raises(InputError, match="sort the rows by time"):
        load_measurement(declared(tmp_path, stamps, "s"))
