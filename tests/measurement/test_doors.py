"""No false alarm at the door: what looks like a fault and is none, each beside the fault that it looks like."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.checks import refuse_not_finite
from gear_damping.measurement.irregular_stamps import irregularity
from gear_damping.measurement.record_checks import share_at_stamps
from gear_damping.measurement.timebase import stamped_time

RATE = 1000.0
TURN = 2 * np.pi


@pytest.fixture
def rng():
    return np.random.default_rng(7)


def _signal(time: np.ndarray) -> np.ndarray:
    return 2 * np.sin(TURN * 31 * time) + 0.7 * np.cos(TURN * 87.3 * time + 1)


def _oscillator(bench, time: np.ndarray, values: np.ndarray, force: np.ndarray | None = None):
    """An oscillator's record; its displacement is in rad."""
    bench.columns = {"t": time, "x": values} | ({} if force is None else {"u": force})
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "rad"}}
    if force is not None:
        channels["force"] = {"column": "u", "unit": "V"}
    bench.content = {"system": "oscillator", "records": [{"file": "run_1.csv", "channels": channels}]}
    bench.write_csv()
    return bench.load_as_it_is().records[0]


def _problems(record) -> list[str]:
    return [finding.kind for finding in record.findings if finding.severity == "data_problem"]


def _stamped(bench, stamps: np.ndarray, taken: np.ndarray | None = None, noise: np.ndarray | float = 0.0):
    """A record with stamps, its samples taken at them or at other times."""
    return _oscillator(bench, stamps, _signal(stamps if taken is None else taken) + noise)


# --- stamps


@pytest.mark.parametrize("noise", [0.0, 0.02])
@pytest.mark.parametrize("kind", ["each by itself", "step by step", "late"])
def test_jitter_of_seven_percent_is_a_note_and_keeps_the_stamps(bench, rng, kind, noise):
    even, n = np.arange(2000) / RATE, 2000
    if kind == "each by itself":
        stamps = even + 0.07 * rng.standard_normal(n) / RATE
    elif kind == "step by step":
        stamps = np.cumsum(1 + 0.07 * rng.standard_normal(n)) / RATE
    else:
        stamps = even + np.minimum(0.07 * rng.exponential(size=n), 0.45) / RATE
    record = _stamped(bench, stamps, noise=noise * rng.standard_normal(n))
    assert _problems(record) == []
    notes = [finding for finding in record.findings if finding.kind == "uneven_stamps"]
    assert [note.severity for note in notes] == ["note"]
    assert not record.uniform
    np.testing.assert_array_equal(record.time, stamps)
    assert record.sampling_rate == pytest.approx((n - 1) / (stamps[-1] - stamps[0]), rel=1e-12)


@pytest.mark.parametrize("jitter", [0.1, 0.2])
def test_stamps_that_were_written_late_to_even_samples_are_a_problem(bench, rng, jitter):
    even = np.arange(2000) / RATE
    stamps = even + jitter * rng.uniform(-1, 1, 2000) / RATE
    noise = 0.01 * rng.standard_normal(2000)
    record = _stamped(bench, stamps, taken=even, noise=noise)
    assert _problems(record) == ["uneven_stamps"]
    assert "give sampling_rate" in " ".join(finding.message for finding in record.findings)
    assert _problems(_stamped(bench, stamps, noise=noise)) == []


@pytest.mark.parametrize("seed", range(6))
def test_noise_that_hides_the_jitter_gives_no_verdict_on_the_stamps(seed):
    rng = np.random.default_rng(seed)
    even = np.arange(500) / RATE
    stamps = even + 0.1 * rng.uniform(-1, 1, 500) / RATE
    share, error = share_at_stamps(_signal(even) + 0.5 * rng.standard_normal(500), stamps)
    assert share + 4 * error > 0.35
    assert share - 4 * error < 1


def test_one_late_stamp_is_no_problem_and_many_are(bench, rng):
    even = np.arange(2000) / RATE
    stamps = even + 0.05 * rng.uniform(-1, 1, 2000) / RATE
    stamps[700] += 0.7 / RATE
    assert _problems(_stamped(bench, stamps)) == []
    assert irregularity(stamps) is None
    assert irregularity(even + 0.7 * (np.arange(2000) % 20 == 7) / RATE).kind == "uneven_stamps"


def test_lost_samples_are_counted_under_jitter_too(bench, rng):
    stamps = (np.arange(2000) + 0.05 * rng.standard_normal(2000)) / RATE
    record = _stamped(bench, np.delete(stamps, [*range(500, 503), 1200]))
    (found,) = [finding for finding in record.findings if finding.kind == "dropped_samples"]
    assert found.sample == 500
    assert "about 4 sample(s) were dropped in 2 gap(s)" in found.message
    assert record.sampling_rate == pytest.approx(RATE, rel=0.01)


@pytest.mark.parametrize("until", [800, 1000, 1940])
@pytest.mark.parametrize("slower", [4, 5])
def test_the_bend_where_a_logger_changes_its_rate_is_no_late_stamp(bench, rng, slower, until):
    """A decay of 3.1 Hz at 100 Hz, then at 25 or 20 Hz: its values know where they were taken."""
    time = np.r_[0:until, until:2000:slower] / 100
    values = 12 * np.exp(-0.29 * time) * np.cos(TURN * 3.1 * time) + 0.02 * rng.standard_normal(time.size)
    record = _oscillator(bench, time, values)
    assert _problems(record) == []
    assert not any(
        "sampling_rate instead" in finding.message for finding in record.findings if finding.channel != "time"
    )


def test_late_stamps_are_told_within_each_rate_of_a_logger(bench, rng):
    even = np.r_[0:1000, 1000:2000:2] / RATE
    step = np.where(np.arange(even.size) < 1000, 1, 2) / RATE
    stamps = even + 0.2 * step * rng.uniform(-1, 1, even.size)
    assert "uneven_stamps" in _problems(_stamped(bench, stamps, taken=even))


@pytest.mark.parametrize("jitter", [0.0, 0.02])
@pytest.mark.parametrize("change", [0.05, 1.0])
def test_samples_of_a_changing_rate_are_taken_at_their_stamps(bench, rng, change, jitter):
    index = np.arange(2000)
    late = np.where(index > 700, (index - 700) * change, 0.0)
    stamps = (index + late + jitter * rng.standard_normal(2000)) / RATE
    record = _stamped(bench, stamps)
    (note,) = [finding for finding in record.findings if finding.kind == "uneven_stamps"]
    assert note.severity == "note"
    assert "the rate changes" in note.message
    assert note.sample == pytest.approx(701, abs=2)
    assert not record.uniform
    np.testing.assert_array_equal(record.time, stamps)


def test_stamps_of_events_are_kept(bench):
    """A wheel that coasts down writes a row a turn: steps a hundred times as long at the end, and some between."""
    speed = 20.0 * np.exp(-np.linspace(0, 4.5, 1500))
    stamps = np.sort(np.r_[np.cumsum(1 / speed), np.linspace(0.01, 60, 300)])
    record = _stamped(bench, stamps)
    assert _problems(record) == []
    np.testing.assert_array_equal(record.time, stamps)


@pytest.mark.parametrize("far", [1e12, 1e20, 1e160, 1e300])
def test_a_last_stamp_beyond_all_others_is_a_gap(far):
    """What rounding hides of all other steps beside it is no rate."""
    stamps = np.arange(1000) / RATE
    stamps[-1] += far
    base = stamped_time(stamps, "t", "a.csv")
    (finding,) = base.findings
    assert (finding.kind, finding.severity, finding.sample) == ("dropped_samples", "data_problem", 999)
    assert base.sampling_rate == pytest.approx(RATE, rel=1e-3)


@pytest.mark.parametrize("jitter", [0.0, 0.08])
def test_a_clock_that_jumps_by_part_of_a_step_is_a_problem(bench, rng, jitter):
    stamps = (np.arange(2000) + jitter * rng.uniform(-1, 1, 2000)) / RATE
    stamps[900:] += 2.5 / RATE
    record = _stamped(bench, stamps)
    (problem,) = [finding for finding in record.findings if finding.severity == "data_problem"]
    assert (problem.kind, problem.sample) == ("clock_jumps", 900)
    assert "jumps" in problem.message


@pytest.mark.parametrize(("rate", "places", "start"), [(333.0, 3, 0.0), (600.0, 3, 12.0), (90.0, 2, 1.7e9)])
def test_stamps_of_few_digits_are_an_even_grid(bench, rate, places, start):
    taken = np.arange(1500) / rate
    stamps = np.round(start + taken, places)
    record = _stamped(bench, stamps, taken=taken)
    assert record.uniform
    assert _problems(record) == []
    assert record.sampling_rate == pytest.approx(rate, rel=1e-6)
    assert np.ptp(record.time - start - taken) < 1e-3 / rate + 1e-6
    assert any("rounded" in note for note in record.notes)


@pytest.mark.parametrize(("rate", "places"), [(6000.0, 6), (12800.0, 7), (1500.0, 5)])
def test_stamps_that_rounding_hardly_moves_are_the_even_grid_too_and_jitter_of_as_much_is_none(rate, places, rng):
    even = np.arange(20000) / rate
    base = stamped_time(np.round(even, places), "t", "a.csv")
    assert base.stamps is None
    assert base.sampling_rate == rate
    np.testing.assert_allclose(base.time, even, rtol=0, atol=1e-6 / rate)
    jittered = stamped_time(np.round(even + 0.004 * rng.uniform(-1, 1, 20000) / rate, places + 3), "t", "a.csv")
    assert jittered.stamps is not None


def test_stamps_that_are_moved_to_a_grid_are_moved_without_harm(bench, rng):
    even = np.arange(2000) / RATE
    stamps = even + 0.004 * rng.uniform(-1, 1, 2000) / RATE
    record = _stamped(bench, stamps)
    assert record.uniform
    inner = slice(10, -10)
    error = (record.channels["displacement"].values - _signal(record.time))[inner]
    assert np.sqrt(np.mean(error**2)) < 1e-4 * np.std(_signal(even))


# --- flat tops


def _friction_pendulum(rate: float, friction: float, torque: float = 12.0) -> np.ndarray:
    """A pendulum with dry friction, which stands at its turning points until the pull is enough; 6 s."""
    step, angle, speed = 1 / rate, 1.2, 0.0
    angles = np.empty(int(6 * rate))
    for k in range(angles.size):
        angles[k] = angle
        pull = torque * np.sin(0.9 * TURN * k * step) - 19.6 * np.sin(angle) - 0.1 * speed
        if speed == 0 and abs(pull) <= friction:
            continue
        new = speed + step * (pull - friction * np.sign(speed if speed else pull))
        speed = 0.0 if speed * new < 0 else new
        angle += step * speed
    return angles


@pytest.mark.parametrize(("friction", "torque"), [(0.0, 12.0), (2.0, 12.0), (5.0, 12.0), (1.0, 0.0), (0.0, 4.0)])
@pytest.mark.parametrize("step", [1e-3, 3e-3, 2e-2])
def test_an_encoder_that_dwells_at_turning_points_is_not_clipped(bench, friction, torque, step):
    angle = step * np.round(_friction_pendulum(500, friction, torque) / step)
    assert _problems(_oscillator(bench, np.arange(angle.size) / 500, angle)) == []
    index = np.arange(0, angle.size - 1, 0.6)  # put on another grid by a straight line
    between = np.interp(index, np.arange(angle.size), angle)
    assert _problems(_oscillator(bench, np.arange(index.size) / 833.0, between)) == []


def _stuck_drive(gain: float) -> np.ndarray:
    """A table that a proportional control drives from one place to another; it sticks short of them. 8 s at 1 kHz."""
    place, speed, places = 0.0, 0.0, np.empty(8000)
    for k in range(8000):
        pull = gain * ((-5.0 if k // 2500 % 2 else 5.0) - place)
        if speed == 0 and abs(pull) <= 320:
            pull = 0.0
        else:
            new = speed + 1e-3 * (pull - 14.0 * speed - 320 * np.sign(speed if speed else pull))
            speed = 0.0 if speed * new < 0 else new
            place += 1e-3 * speed
        places[k] = place
    return places


@pytest.mark.parametrize("gain", [120.0, 150.0, 200.0])
@pytest.mark.parametrize("step", [1e-3, 4.66e-3])
def test_a_drive_that_sticks_where_it_came_to_rest_is_not_clipped(bench, gain, step):
    places = step * np.round(_stuck_drive(gain) / step)
    assert _problems(_oscillator(bench, np.arange(8000) / 1000, places)) == []


def test_a_sensor_with_room_left_is_not_clipped(bench):
    time = np.arange(3000) / 500
    _oscillator(bench, time, np.minimum(np.sin(3.1 * time), 0.8))
    assert bench.kinds() == ["clipped"]
    bench.channels["displacement"]["range"] = {"value": 2, "unit": "rad"}
    assert bench.kinds() == []


def test_a_sample_at_every_count_has_stamps_of_its_own(bench):
    """The stamps lie where a swing passes the marks of an encoder, and are far from even."""
    fine = np.arange(0, 30, 1e-4)
    counts = np.round(0.5 * np.exp(-0.05 * fine) * np.cos(5 * fine) / 2.6e-3)
    at = np.flatnonzero(np.diff(counts)) + 1
    assert _problems(_oscillator(bench, fine[at], 2.6e-3 * counts[at])) == []


@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize("step", [0.0, 2.9142e-3, 2e-2])
@pytest.mark.parametrize("side", [1, -1])
def test_an_encoder_that_is_cut_off_is_clipped(bench, rng, step, noise, side):
    angle = side * (_friction_pendulum(500, 0.5) + noise * rng.standard_normal(3000))
    cut = np.minimum(angle, np.quantile(angle, 0.9))
    cut = side * (step * np.round(cut / step) if step else cut)
    assert _problems(_oscillator(bench, np.arange(3000) / 500, cut)) == ["clipped"]


@pytest.mark.parametrize("period", [6, 12, 40])
def test_a_fast_signal_that_is_cut_off_again_and_again_is_clipped(bench, rng, period):
    wave = np.sin(TURN * np.arange(2000) / period + 0.3) + 0.1 * rng.standard_normal(2000)
    time = np.arange(2000) / RATE
    assert _problems(_oscillator(bench, time, wave)) == []
    assert _problems(_oscillator(bench, time, np.minimum(wave, np.quantile(wave, 0.7)))) == ["clipped"]


def test_a_velocity_that_stands_still_is_not_clipped(bench):
    time = np.arange(3000) / 500
    speed = np.maximum(0.0, np.sin(3 * time))  # moved one way, braked to rest each time
    bench.columns = {"t": time, "v": 0.01 * np.round(speed / 0.01)}
    channels = {"time": {"column": "t", "unit": "s"}, "velocity": {"column": "v", "unit": "m/s"}}
    bench.content = {"system": "oscillator", "records": [{"file": "run_1.csv", "channels": channels}]}
    assert bench.kinds() == []


def test_a_drive_at_its_limit_is_what_was_applied(bench):
    time = np.arange(3000) / 500
    force = np.clip(15 * np.sin(4 * time), -10, 10)
    assert _problems(_oscillator(bench, time, np.sin(3.1 * time), force)) == []
    bench.channels["force"]["range"] = {"value": 10, "unit": "V"}
    assert bench.kinds() == ["clipped"]


# --- what else looks like a fault


@pytest.mark.parametrize("step", [1e-3, 2e-2])
def test_a_coarse_encoder_at_a_high_rate_was_not_interpolated(bench, step):
    time = np.arange(4000) / 2000
    assert _problems(_oscillator(bench, time, step * np.round(np.exp(-time) * np.cos(9 * time) / step))) == []


def test_gaps_are_told_by_the_rows_that_a_slice_counts():
    stamps = np.delete(np.arange(2000) / RATE, [500, 501, 1200])
    message = irregularity(stamps, first=300).message
    assert "about 3 sample(s) were dropped in 2 gap(s), before row(s) 800, 1498 of the file (at " in message


def test_stamps_that_leap_at_each_full_minute_are_clocks():
    seconds = 55 + np.arange(2000) / 100
    message = irregularity(105900 + np.where(seconds >= 60, 4040, 0) + seconds).message
    assert message.startswith("numbers such as 105959.99 and then 110000 are clocks, HHMMSS")
    assert "dropped" in irregularity(105900 + np.where(seconds >= 60, 33, 0) + seconds).message


def test_a_column_without_a_number_is_to_be_left_out():
    values = np.full(2000, np.nan)
    with pytest.raises(InputError, match="name another column, or leave it out"):
        refuse_not_finite(values, "channels.force", "run.csv")
    with pytest.raises(InputError, match="use slices that leave them out"):
        refuse_not_finite(np.r_[0.0, values], "channels.force", "run.csv")
