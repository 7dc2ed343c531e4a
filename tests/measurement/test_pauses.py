"""A recorder that pauses or loses samples, and a clock that jumps: the values over the gap tell which."""

import numpy as np
import pytest
import yaml

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.gaps import share_over_gaps
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.starting_yaml import starting_yaml

SAMPLES, STEP, GAPS = 1200, 0.01, np.array([150, 320, 480, 700, 810, 990, 1100])


def stamps_with_gaps(seed=0):
    """Steps of 10 ms that scatter, and seven that last 2.3 to 6.6 times as long."""
    random = np.random.default_rng(seed)
    steps = STEP * (1 + 0.05 * random.normal(size=SAMPLES))
    steps[GAPS] *= random.uniform(2.3, 6.6, size=GAPS.size)
    return np.cumsum(steps)


def moved(stamps, paused, noise, seed=1):
    """A decaying swing at the stamps, or at even instants with a clock that jumps."""
    time = stamps if paused else STEP * np.arange(SAMPLES)
    swing = np.exp(-0.05 * time) * np.sin(2 * np.pi * 0.7 * time)
    return swing + noise * np.random.default_rng(seed).normal(size=SAMPLES)


def loaded(folder, stamps, values):
    np.savetxt(folder / "swing.csv", np.column_stack([stamps, values]), "%.9g", ",", header="t,x", comments="")
    channels = "{time: {column: t, unit: s}, displacement: {column: x, unit: mm}}"
    text = f"system: oscillator\nrecords:\n- file: swing.csv\n  channels: {channels}\n"
    (folder / "measurement.yaml").write_text(text)
    return load_measurement(folder / "measurement.yaml").records[0]


@pytest.mark.parametrize("noise", [0.0, 0.003])
@pytest.mark.parametrize("paused", [True, False])
def test_values_over_gaps_tell_a_pause_from_a_clock(paused, noise, tmp_path):
    stamps = stamps_with_gaps()
    share, error = share_over_gaps(moved(stamps, paused, noise), stamps)
    assert error < 0.08
    (finding,) = [
        one for one in loaded(tmp_path, stamps, moved(stamps, paused, noise)).findings if one.channel == "time"
    ]
    if paused:
        assert share == pytest.approx(1, abs=0.15)
        assert (finding.kind, finding.severity) == ("uneven_stamps", "note")
        assert "the recorder paused" in finding.message
    else:
        assert share < 0.5
        assert (finding.kind, finding.severity) == ("clock_jumps", "data_problem")


def test_noise_alone_bears_out_nothing(tmp_path):
    stamps = stamps_with_gaps()
    values = np.random.default_rng(3).normal(size=SAMPLES)
    (finding,) = [one for one in loaded(tmp_path, stamps, values).findings if one.channel == "time"]
    assert finding.severity == "data_problem"


def test_few_gaps_tell_nothing():
    stamps = STEP * np.arange(SAMPLES) + 0.05 * (np.arange(SAMPLES) > 400)
    assert share_over_gaps(moved(stamps, True, 0.0), stamps) == (1.0, np.inf)


@pytest.mark.parametrize(
    ("scatter", "frequency", "severity"),
    [(0.1, 0.7, "note"), (0.01, 0.7, "data_problem"), (0.1, 20.0, "data_problem")],
)
@pytest.mark.parametrize("longest", [2.6, 4.45])
def test_a_program_that_asks_for_its_samples_may_come_late(scatter, frequency, severity, longest, tmp_path):
    """A clock that is steady jumps instead, and what is fast beside so long a step is lost."""
    random = np.random.default_rng(5)
    steps = STEP * (1 + scatter * random.normal(size=SAMPLES))
    steps[[300, 700]] = longest * STEP
    stamps = np.cumsum(steps)
    values = np.sin(2 * np.pi * frequency * stamps) + 1e-3 * random.normal(size=SAMPLES)
    (finding,) = [one for one in loaded(tmp_path, stamps, values).findings if one.kind != "resampled"]
    assert finding.severity == severity
    assert ("comes late" in finding.message) is (severity == "note")


def kept(lost, frequency, rate=100.0, noise=1e-4):
    """Stamps and values of a decaying swing whose samples `lost` are not there."""
    time = np.delete(np.arange(3000), lost) / rate
    swing = np.exp(-0.05 * time) * np.sin(2 * np.pi * frequency * time)
    return time, swing + noise * np.random.default_rng(4).normal(size=time.size)


@pytest.mark.parametrize(
    ("lost", "frequency", "severity"),
    [
        ([700], 0.7, "note"),
        ([*range(700, 703), 1900], 0.7, "note"),
        (range(700, 950), 0.7, "data_problem"),  # almost two periods
        (range(700, 750), 0.7, "data_problem"),  # a third of one
        (range(700, 703), 20.0, "data_problem"),  # more than half of one
    ],
)
def test_lost_samples_are_a_note_where_they_follow_from_their_neighbours(lost, frequency, severity, tmp_path):
    stamps, values = kept(list(lost), frequency)
    record = loaded(tmp_path, stamps, values)
    (finding,) = [one for one in record.findings if one.channel == "time"]
    assert (finding.kind, finding.severity) == ("dropped_samples", severity)
    assert "before row(s) 700" in finding.message
    assert f"(at {stamps[700]:.6g}" in finding.message
    covered = (len(record.time) - 1) / record.sampling_rate
    if severity == "note":
        assert covered == pytest.approx(record.time[-1] - record.time[0], abs=1e-6)


def test_stamps_of_few_digits_keep_their_rate_beside_a_gap(tmp_path):
    even = np.delete(np.arange(4000), [1234]) / 59.69
    stamps = np.round(even, 3)
    record = loaded(tmp_path, stamps, np.sin(2 * np.pi * 0.6 * even))
    assert np.ptp(record.time - even) < 2e-4  # rounding alone spreads them over 1e-3
    (finding,) = [one for one in record.findings if one.channel == "time"]
    assert finding.severity == "note"


def test_a_recorder_that_paused_is_simulated_to_its_end(tmp_path):
    stamps = stamps_with_gaps()
    record = loaded(tmp_path, stamps, moved(stamps, True, 0.001))
    assert (len(stamps) - 1) / record.sampling_rate == pytest.approx(stamps[-1] - stamps[0], rel=1e-6)


@pytest.mark.parametrize("polled", [True, False])
def test_samples_that_come_when_they_come_are_taken_so_unless_their_values_came_evenly(polled, tmp_path):
    random = np.random.default_rng(5)
    steps = np.resize([1, 1, 1, 3, 1, 1, 2.5, 1, 1, 1], SAMPLES) * random.uniform(0.7, 1.3, size=SAMPLES)
    stamps = np.cumsum(STEP * steps)
    time = stamps if polled else np.linspace(0, stamps[-1], SAMPLES)
    values = np.sin(2 * np.pi * 2.1 * time) + 0.003 * random.normal(size=SAMPLES)
    found = [one for one in loaded(tmp_path, stamps, values).findings if one.kind == "uneven_stamps"]
    assert [one.severity for one in found] == (["note"] if polled else ["note", "data_problem"])
    assert "many are long" in found[0].message


def test_a_step_that_rounding_makes_long_loses_no_sample(tmp_path):
    """2.43 ms on the average, written in whole ms: 4 ms stand for 3 ms and more, beside others that stand for 3."""
    steps = 2.3e-3 * np.ones(400)
    steps[::40] = 3.6e-3
    stamps = np.round(np.cumsum(steps), 3)
    assert np.sum(np.diff(stamps) > 3.5e-3) >= 3
    (finding,) = [one for one in loaded(tmp_path, stamps, np.sin(60 * stamps)).findings if one.channel == "time"]
    assert (finding.kind, finding.severity) == ("uneven_stamps", "note")
    assert "scatter" in finding.message


def test_a_sample_lost_beside_stamps_of_few_digits_is_still_seen(tmp_path):
    stamps = np.delete(np.round(STEP * np.arange(400), 2), [77, 201, 202])
    found = loaded(tmp_path, stamps, np.random.default_rng(7).normal(size=stamps.size)).findings
    assert [one.kind for one in found if one.channel == "time"] == ["dropped_samples"]


def test_recordings_one_after_another_are_told_with_their_slices(tmp_path):
    stamps = np.concatenate([0.02 * np.arange(n) + start for n, start in ((353, 0.1), (384, 0.02), (400, 0.0))])
    with pytest.raises(InputError, match=r"the clock starts again at sample 353, 737: 3 recordings") as raised:
        loaded(tmp_path, stamps, np.sin(stamps))
    assert "slice: [0, 353], [353, 737], [737, 1137]" in str(raised.value)
    found = inspect_table(read_table(tmp_path / "swing.csv"))
    assert (found.rate, found.rows, found.faults) == (pytest.approx(50.0), (737, 1137), ())
    assert "3 recordings one after another, each with its own clock: rows [0, 353], [353, 737], [7" in found.taken
    text = starting_yaml(found, ("oscillator", "one column"), ())
    assert yaml.safe_load(text)["records"][0]["slice"] == [737, 1137]


def test_a_stamp_out_of_order_is_no_recording(tmp_path):
    stamps = STEP * np.arange(400.0)
    values = np.sin(stamps)
    stamps[200] -= 30 * STEP
    with pytest.raises(InputError, match="1 backward time stamp"):
        loaded(tmp_path, stamps, values)


@pytest.mark.parametrize("jumps", [False, True])
def test_many_single_lost_samples_count_where_the_values_moved_as_long_as_the_stamps_say(jumps, tmp_path):
    """A row a second is taken out of a slow decay at 20 Hz, ms since 1970; a clock that jumps says the same stamps."""
    even = np.arange(200)
    stamps = np.delete(even, np.arange(14, 200, 19)) / 20
    decay = np.exp(-0.4 * (even[: stamps.size] / 20 if jumps else stamps))
    values = decay + 1e-3 * np.random.default_rng(6).normal(size=stamps.size)
    np.savetxt(tmp_path / "a.csv", np.column_stack([1544018294436 + 1000 * stamps, values]), "%.9f", ",")
    channels = "{time: {column: 0, unit: ms}, velocity: {column: 1, unit: rad/s}}"
    text = f"system: oscillator\nrecords:\n- file: a.csv\n  channels: {channels}\n"
    (tmp_path / "measurement.yaml").write_text(text)
    (record,) = load_measurement(tmp_path / "measurement.yaml").records
    (finding,) = [one for one in record.findings if one.channel == "time"]
    assert (finding.kind, finding.severity) == ("dropped_samples", "data_problem" if jumps else "note")
    assert "(at 1544018295.19, 1544018296.14, 1544018297.09," in finding.message


def test_many_single_lost_samples_of_noise_alone_stay_a_fault(tmp_path):
    random = np.random.default_rng(3)
    stamps = kept(np.arange(14, 3000, 19), 0.7)[0]
    values = random.normal(size=stamps.size)
    stamps = stamps + 1e-4 * random.normal(size=stamps.size)
    (finding,) = [one for one in loaded(tmp_path, stamps, values).findings if one.channel == "time"]
    assert finding.severity == "data_problem"


@pytest.mark.parametrize(("moves", "severity"), [("paused", "note"), ("by chance", "note"), ("jumped", "data_problem")])
def test_shifts_by_less_than_a_step_are_a_fault_where_the_values_contradict_them(moves, severity, tmp_path):
    """Whole milliseconds at 40 Hz, of which now and then one is late, and those behind it as much."""
    random = np.random.default_rng(8)
    steps = np.full(2400, 0.025)
    steps[np.arange(100, 2400, 180)] += random.integers(4, 15, size=13) / 1000
    stamps = np.cumsum(steps)
    time = 0.025 * np.arange(2400) if moves == "jumped" else stamps
    noise = 3.0 if moves == "by chance" else 0.0003
    values = np.sin(2 * np.pi * 0.3 * time) + noise * random.normal(size=2400)
    (finding,) = [one for one in loaded(tmp_path, stamps, values).findings if one.channel == "time"]
    assert finding.severity == severity
    assert ("the recorder paused, and" in finding.message) is (moves == "paused")
    assert ("the values do not tell" in finding.message) is (moves == "by chance")


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("paused", [True, False])
def test_long_steps_of_a_program_that_asks_are_pauses_unless_the_values_say_otherwise(paused, seed, tmp_path):
    """A flight logger with steps of 9 ms and some of 20 to 60: by where a window began it was refused or was not."""
    random = np.random.default_rng(seed)
    steps = 0.009 * random.uniform(0.7, 1.3, size=SAMPLES)
    late = random.choice(np.arange(10, SAMPLES - 10), 40, replace=False)
    steps[late] = random.uniform(0.02, 0.06, size=late.size)
    stamps = np.cumsum(steps)
    time = stamps if paused else np.linspace(0, stamps[-1], SAMPLES)
    values = np.sin(2 * np.pi * 0.38 * time) + 0.01 * random.normal(size=SAMPLES)
    found = [one for one in loaded(tmp_path, stamps, values).findings if one.channel == "time"]
    assert any(one.severity == "data_problem" for one in found) != paused
