"""Windows of time and lower rates: which rows they take, what passes the filter, and what the ends keep."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from gear_damping.errors import InputError
from gear_damping.measurement import load
from gear_damping.measurement.cutting import SlowerTime, moved, slower, window_rows
from gear_damping.measurement.timebase import TimeBase, stamped_time, steady_time

RATE = 1000.0


def test_windows_that_meet_share_no_row_and_leave_none_out():
    time = 5.0 + np.arange(2001) / RATE
    first = window_rows(time, (5.0, 6.0))
    second = window_rows(time, (6.0, 7.0))
    assert first == (0, 1000)
    assert second == (1000, 2000)
    assert window_rows(time, (5.0, 7.001)) == (0, 2001)


def test_a_window_takes_stamps_as_they_are_written():
    time = np.round(np.arange(400) * 0.1, 1)  # 3 * 0.1 > 0.3
    assert window_rows(time, (0.3, 0.6)) == (3, 6)
    time[300:] = np.nan
    assert window_rows(time, (2.5, 20.0)) == (25, 200)


@pytest.mark.parametrize("window", [(1.0, 2.5), (-0.5, 1.0), (1.0001, 1.0004)])
def test_a_window_beyond_the_record_is_refused_with_the_times_it_has(window):
    with pytest.raises(InputError, match=r"records\[0\]\.window.*(from 0 to 1.999 s|no sample lies in it)"):
        window_rows(np.arange(2000) / RATE, window, "records[0].window", "measurement.yaml")


def _damped(time):
    return np.exp(-3 * time) * np.sin(2 * np.pi * 20 * time + 1.0)


@pytest.mark.parametrize("rate", [200.0, 333.0, 141.3, 900.0])
def test_a_signal_below_the_new_band_is_kept_up_to_the_ends(rate):
    base = steady_time(RATE, 0, 1500)
    low = slower(base, rate)
    assert low.sampling_rate == rate
    np.testing.assert_allclose(np.diff(low.time), 1 / rate, rtol=1e-9)
    assert base.time[-1] - 1 / rate < low.time[-1] <= base.time[-1] + 1e-9
    error = low.resample(_damped(base.time)) - _damped(low.time)
    assert np.max(np.abs(error)) < 1e-3
    assert np.max(np.abs(error[30:-30])) < 5e-5


@pytest.mark.parametrize("frequency", [101.0, 130.0, 250.0, 480.0])
def test_nothing_folds_into_the_new_band(frequency):
    base = steady_time(RATE, 0, 3000)
    values = slower(base, 200.0).resample(np.sin(2 * np.pi * frequency * base.time + 0.4))
    assert np.max(np.abs(values[30:-30])) < 2e-4


def test_noise_does_not_grow_at_the_ends():
    base = steady_time(RATE, 0, 800)
    low = slower(base, 200.0)
    rng = np.random.default_rng(4)
    ends = [low.resample(rng.normal(size=800))[[0, 1, -2, -1]] for _ in range(12)]
    assert np.sqrt(np.mean(np.square(ends))) < 1.0


def test_a_large_angle_that_runs_on_stays_straight():
    base = steady_time(RATE, 0, 1000)
    low = slower(base, 250.0)
    np.testing.assert_allclose(low.resample(1e4 + 188.5 * base.time), 1e4 + 188.5 * low.time, rtol=1e-12)


def test_a_rate_above_the_recorded_one_is_refused_and_its_own_changes_nothing():
    base = steady_time(RATE, 0, 100)
    with pytest.raises(InputError, match=r"1200 Hz lie above the recorded 1000 Hz; nothing was measured in between"):
        slower(base, 1200.0, "records[0].resample")
    assert slower(base, RATE) is base


def test_stamps_with_jitter_are_read_where_they_lie():
    rng = np.random.default_rng(2)
    stamps = 2.0 + (np.arange(1500) + rng.uniform(-0.07, 0.07, 1500)) / RATE
    base = stamped_time(stamps, "time", "a.csv")
    low = slower(base, 200.0)
    assert low.uniform
    error = low.resample(_damped(stamps - 2.0)) - _damped(low.time - 2.0)
    assert np.max(np.abs(error)) < 2e-3


def test_a_faster_channel_of_its_own_goes_through_the_same_filter():
    base, own = steady_time(RATE, 0, 1000), steady_time(5000.0, 0, 5000)
    low = slower(base, 200.0)
    assert isinstance(low, SlowerTime)
    folded = 0.2 * np.sin(2 * np.pi * 190 * own.time)
    values = moved(low, own, _damped(own.time) + folded, "T1", "a.csv")
    assert np.max(np.abs(values - _damped(low.time))[30:-30]) < 2e-4
    with pytest.raises(InputError, match=r"covers 0 to 0\.4998 s, the record 0 to 0.995 s"):
        moved(low, steady_time(5000.0, 0, 2500), np.zeros(2500), "T1", "a.csv")


def test_a_slower_channel_of_its_own_is_interpolated():
    low = slower(steady_time(RATE, 0, 1000), 200.0)
    own = TimeBase(np.arange(120) / 100, 100.0)
    values = moved(low, own, np.sin(2 * np.pi * 2 * own.time), "T1", "a.csv")
    np.testing.assert_allclose(values, np.sin(2 * np.pi * 2 * low.time), atol=1e-4)


@pytest.fixture
def with_plan(monkeypatch):
    """Sets fields of every declared record's plan."""

    def change(**fields):
        def declared(*args):
            plan = load_declared(*args)
            return replace(plan, records=tuple(replace(record, **fields) for record in plan.records))

        monkeypatch.setattr(load, "declared_plan", declared)

    load_declared = load.declared_plan
    return change


def test_a_window_cuts_every_channel_of_a_record(bench, with_plan):
    whole = bench.load().records[0]
    with_plan(window=(0.005, 0.015))
    cut = bench.load().records[0]
    assert cut.time.size == 200
    assert cut.time[0] == 0.005
    for name, channel in cut.channels.items():
        np.testing.assert_array_equal(channel.values, whole.channels[name].values[100:300])
    bench.record["slice"] = [150, 400]
    assert "the record goes from 0.0075 to 0.01995 s" in bench.only_problem(write=False)


def test_a_window_counts_on_the_clock_of_a_rate_too(bench, with_plan):
    del bench.channels["time"]
    bench.channels["sampling_rate"] = {"value": 20, "unit": "kHz"}
    with_plan(window=(0.005, 0.015))
    record = bench.load().records[0]
    assert record.time.size == 200
    assert record.time[0] == 0.005


def test_a_window_too_short_is_refused(bench, with_plan):
    with_plan(window=(0.005, 0.0052))
    assert "4 samples; a record needs at least 8" in bench.only_problem()


def test_resampling_takes_all_channels_to_the_new_rate(bench, with_plan):
    bench.columns["theta1"] = np.mod(bench.columns["theta1"] * 5, 2 * np.pi)  # the encoder begins again
    whole = bench.load().records[0]
    with_plan(resample=8000.0)
    record = bench.load().records[0]
    assert record.sampling_rate == 8000
    assert record.uniform
    assert record.time.size == 160
    angle = np.interp(record.time, whole.time, whole.channels["pinion_angle"].values)
    np.testing.assert_allclose(record.channels["pinion_angle"].values, angle, atol=1e-9)
    for name in ("transmission_error", "pinion_torque"):
        exact = np.interp(record.time, np.linspace(0, whole.time[-1], 400), whole.channels[name].values)
        scale = np.ptp(exact)
        np.testing.assert_allclose(record.channels[name].values, exact, atol=0.02 * scale)
    assert any("resampled from 20000 to 8000 Hz; flat up to 3200 Hz" in note for note in record.notes)


def test_resampling_to_a_higher_rate_or_to_nothing_is_one_problem(bench, with_plan):
    with_plan(resample=30000.0)
    assert "records[0].resample = 30000.0: 30000 Hz lie above the recorded 20000 Hz" in bench.only_problem()
    with_plan(resample=100.0)
    assert "leaves 2 samples; a record needs at least 8" in bench.only_problem()


@pytest.mark.parametrize(("hole", "cell"), [(None, ""), (805, "nan"), (805, "n/a")])
def test_the_filter_reaches_into_the_rows_beside_a_window(hole, cell, tmp_path):
    """A ringing that the filter stops leaves nothing at the ends of a window, unless a row beside it is no number."""
    time = np.arange(4000) / RATE
    swing = np.sin(2 * np.pi * 13.0 * time)
    values = swing + 6 * np.sin(2 * np.pi * 311.0 * time + 1.0)
    cells = [f"{value:.9g}" if row != hole else cell for row, value in enumerate(values)]
    (tmp_path / "a.csv").write_text("\n".join(["x", *cells]) + "\n")
    channels = {"sampling_rate": "1 kHz", "displacement": {"column": "x", "unit": "mm"}}
    record = {"file": "a.csv", "resample": "200 Hz", "window": {"from": 0.9, "to": 3.0, "unit": "s"}}
    path = tmp_path / "measurement.yaml"
    path.write_text(yaml.safe_dump({"system": "oscillator", "records": [record | {"channels": channels}]}))
    found = load.load_measurement(path).records[0]
    assert found.time[0] == pytest.approx(0.9)
    assert found.time[-1] == pytest.approx(2.995)
    left = found.channels["displacement"].values - np.sin(2 * np.pi * 13.0 * found.time)
    assert np.max(np.abs(left)) < (2e-3 if hole is None else 0.2)


def test_what_a_lower_rate_takes_away_is_said(with_plan_of_a_fork):
    kept, lost = with_plan_of_a_fork
    assert not kept
    assert len(lost) == 1
    assert "takes 100 % of the variance of displacement away" in lost[0].message
    assert lost[0].severity == "data_problem"  # what is left are edges of the filter, and no motion


@pytest.fixture
def with_plan_of_a_fork(tmp_path):
    """Findings about a motion of 30 Hz and one of 439 Hz, both wanted at 500 Hz."""
    time, found = np.arange(20000) / 1e4, []
    for frequency in (30.0, 439.0):
        np.savetxt(tmp_path / "a.csv", np.sin(2 * np.pi * frequency * time), header="x", comments="")
        channels = {"sampling_rate": {"value": 10, "unit": "kHz"}, "displacement": {"column": "x", "unit": "mm"}}
        record = {"file": "a.csv", "resample": {"value": 500, "unit": "Hz"}, "channels": channels}
        path = tmp_path / "measurement.yaml"
        path.write_text(yaml.safe_dump({"system": "oscillator", "records": [record]}))
        findings = load.load_measurement(path).records[0].findings
        found.append([finding for finding in findings if finding.kind == "resampled_away"])
    return found


def test_a_constant_torque_loses_nothing_at_a_lower_rate(bench, with_plan):
    bench.record["resample"] = {"value": 8000, "unit": "Hz"}
    bench.columns["T1"] = np.full(400, 150.0)
    lost = [finding.channel for finding in bench.load().findings if finding.kind == "resampled_away"]
    assert "pinion_torque" not in lost
