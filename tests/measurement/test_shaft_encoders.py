"""Angles from encoders and tachos, and the transmission error that two encoders see."""

from math import cos, pi

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.encoders import (
    angle_from_counts,
    angle_from_pulses,
    edges_of_square_pulses,
    pulse_numbers,
    rising_edges,
)

RADIUS_PINION = 20 * 3e-3 * cos(pi / 9) / 2
RADIUS_GEAR = 2 * RADIUS_PINION


def _rig(bench, **files):
    np.savez(bench.folder / "run.npz", **files)
    bench.content["parameters"] = {
        "n_teeth_pinion": 20,
        "n_teeth_gear": 40,
        "module": {"value": 3, "unit": "mm"},
        "pressure_angle": {"value": 20, "unit": "deg"},
    }
    bench.content["records"] = [
        {
            "file": "run.npz",
            "channels": {"time": {"column": "t", "unit": "s"}},
            "conditions": {"pinion_torque": {"value": 150, "unit": "N*m"}},
        }
    ]
    return bench.record


def test_counts_that_begin_again_each_turn_become_one_angle():
    angle = np.linspace(0, 30, 500)
    counts = np.mod(angle / (2 * pi) * 2048, 2048)
    np.testing.assert_allclose(angle_from_counts(counts, 2048), angle, atol=1e-11)
    np.testing.assert_allclose(angle_from_counts(counts, 2048, -1), -angle, atol=1e-11)


def test_pulse_times_of_a_slowly_swinging_shaft_give_its_angle():
    fine = np.linspace(0, 1, 200_001)
    swing = 50 * fine + 0.3 * np.sin(2 * pi * 3 * fine)
    pulses = np.interp(np.arange(0, swing[-1], 2 * pi / 60), swing, fine)
    time = np.linspace(0.002, 0.99, 700)
    expected = 50 * time + 0.3 * np.sin(2 * pi * 3 * time)
    found = angle_from_pulses(pulses, time, 60, 1, "key", "file")
    assert np.max(np.abs(found - expected)) < 2e-4


@pytest.mark.parametrize(
    ("pulses", "said"),
    [
        ([0.1], "at least 2"),
        ([0, 0.2, 0.1, 1], "pulse 2 does not come after"),
        ([0, 0.1, 0.2], "do not cover"),
    ],
)
def test_pulses_that_cannot_be_used_are_refused(pulses, said):
    with pytest.raises(InputError, match=said):
        angle_from_pulses(np.array(pulses), np.linspace(0, 1, 50), 4, 1, "key", "file")


@pytest.mark.parametrize("offset", [0.05, 0.95])
def test_a_shaft_that_speeds_up_is_told_by_one_pulse_a_turn(offset):
    """From 814 to 1120 rpm in 0.4 s, in closed form: one of 61 teeth meshes every 0.1 rad, the ends included."""
    first, rise = 814 * pi / 30, 80.0
    turns = 2 * pi * (np.arange(6) + offset)
    pulses = ((first**2 + 2 * rise * turns) ** 0.5 - first) / rise
    time = np.linspace(0, 0.4, 20000)
    found = angle_from_pulses(pulses[pulses <= 0.4], time, 1, 1, "key", "file")
    true = first * time + rise * time**2 / 2
    np.testing.assert_allclose(found - found[0], true, atol=2e-3)


def test_between_uneven_pulses_a_shaft_does_not_turn_back():
    pulses = np.array([0.0, 0.1, 0.2, 0.21, 0.31, 0.41, 0.51])
    found = angle_from_pulses(pulses, np.linspace(0, 0.51, 3000), 1, 1, "key", "file")
    assert np.all(np.diff(found) >= 0)


def running_up(per_revolution):
    """Times of the pulses of a shaft that speeds up from 50 to 60 rad/s in a second, in closed form."""
    turned = np.arange(1, int(55 * per_revolution / (2 * pi))) * 2 * pi / per_revolution
    return ((50**2 + 2 * 10 * turned) ** 0.5 - 50) / 10


@pytest.mark.parametrize("lost", [[20], [20, 21], [1], [-2], [7, 30, 31, 32], [*range(5, 60, 6)]])
@pytest.mark.parametrize("per_revolution", [12, 60])
def test_the_turn_of_lost_pulses_is_counted(lost, per_revolution):
    pulses, time = running_up(per_revolution), np.linspace(0.05, 0.95, 900)
    kept = np.delete(pulses, [i for i in lost if i < len(pulses)])
    found = angle_from_pulses(kept, time, per_revolution, 1, "key", "file")
    true = 50 * time + 5 * time**2
    np.testing.assert_allclose(found - found[0], true - true[0], atol=1e-3)


def test_pulses_of_a_shaft_that_swings_or_starts_are_all_there():
    starting = (2 * np.arange(1, 40)) ** 0.5  # from rest: each step shorter, the first 2.4 times the second
    assert pulse_numbers(starting).tolist() == list(range(39))
    fine = np.linspace(0, 4, 400_001)
    swinging = np.interp(np.arange(0.5, 150, 2 * pi / 5), 50 * fine + 0.9 * np.sin(2 * pi * 4 * fine), fine)
    assert pulse_numbers(swinging).tolist() == list(range(len(swinging)))


def test_a_wheel_that_has_lost_pulses_is_said(bench):
    pulses = np.delete(running_up(60), [100, 200])
    time = np.arange(0.05, 0.95, 1e-3)
    _rig(bench, t=time, x=np.sin(50 * time), p=np.r_[pulses, np.full(len(time) - len(pulses), np.nan)])
    bench.content["records"][0]["channels"]["transmission_error"] = {"column": "x", "unit": "um"}
    bench.content["records"][0]["encoders"] = {
        "tacho": {"timestamps": "p", "unit": "s", "pulses_per_revolution": 60, "direction": 1}
    }
    found = [finding for finding in bench.load_as_it_is().findings if finding.kind == "lost_pulses"]
    assert [(one.severity, one.message.partition(",")[0]) for one in found] == [
        ("note", "2 pulses are missing between others")
    ]


@pytest.mark.parametrize(
    ("rate", "cut", "said"), [(1250.0, {}, True), (1000.0, {}, False), (1250.0, {"slice": [0, 600]}, False)]
)
def test_stamps_that_go_on_behind_a_whole_record_are_said(bench, rate, cut, said):
    """A record of 40 kHz that was declared as 50 ended at .24 s, and its stamps at .3."""
    pulses = running_up(60)
    samples = np.arange(round(1000 * pulses[-1]))
    _rig(bench, x=np.sin(0.05 * samples), p=np.r_[pulses, np.full(len(samples) - len(pulses), np.nan)])
    record = bench.content["records"][0]
    record |= cut
    record["channels"] = {**record["channels"], "transmission_error": {"column": "x", "unit": "um"}}
    record["channels"].pop("time", None)
    record["channels"]["sampling_rate"] = f"{rate} Hz"
    record["encoders"] = {"tacho": {"timestamps": "p", "unit": "s", "pulses_per_revolution": 60, "direction": 1}}
    notes = [note for note in bench.load_as_it_is().records[0].notes if "its stamps go on" in note]
    assert len(notes) == said
    assert not said or "at 999.113 Hz both end together" in notes[0]


def test_edges_are_found_between_samples():
    time = np.arange(1000) / 1000
    edges = rising_edges(np.sin(2 * pi * 7.3 * time - 1), time, 0.0)
    np.testing.assert_allclose(edges, (1 / (2 * pi) + np.arange(edges.size)) / 7.3, atol=1e-6)


def tacho(swing, rate, seconds, once=1):
    """Samples of a square pulse at each of `once` marks in a turn, and the true times at which it rises."""
    time = np.arange(round(rate * seconds)) / rate
    turns = once * swing(time) / (2 * pi)
    fine = np.linspace(0, seconds, 2_000_001)
    rises = np.interp(np.arange(1, np.floor(turns[-1]) + 1), once * swing(fine) / (2 * pi), fine)
    return time, 5.0 * (np.mod(turns, 1.0) < 0.3), rises[rises < time[-1]]


@pytest.mark.parametrize("drift", [0.0, 3.0, -8.0])  # rad/s^2
def test_square_pulses_of_an_even_rotation_are_told_better_than_to_a_sample(drift):
    time, signal, rises = tacho(lambda t: 0.3 + 141.7 * t + drift * t**2 / 2, 50e3, 0.7)
    rounded, (found, late) = (read(signal, time, 2.5) for read in (rising_edges, edges_of_square_pulses))
    assert found.shape == rises.shape
    assert abs((found - rises).mean()) < 4 * late
    assert late < 0.7 * np.std(rounded - rises)
    assert np.std(found - rises) < 0.7 * np.std(rounded - rises)
    assert np.abs(found - rises).max() < 0.6 / 50e3


def test_few_edges_of_a_shaft_that_speeds_up_are_told_better_than_to_a_sample():
    """Six turns from 814 to 1120 rpm: their times are no polynomial of their number, the angle is one of the time."""
    time, signal, rises = tacho(lambda t: 0.3 + 85.2 * t + 80 * t**2 / 2, 50e3, 0.4)
    rounded, (found, late) = (read(signal, time, 2.5) for read in (rising_edges, edges_of_square_pulses))
    assert 0 < late < 0.25 / 50e3
    assert np.std(found - rises) < 0.7 * np.std(rounded - rises)


@pytest.mark.parametrize("noise", [0.02, 0.15])  # V, of pulses of 5 V
def test_noise_of_square_pulses_moves_no_edge(noise):
    time, signal, rises = tacho(lambda t: 0.3 + 342.0 * t, 48e3, 0.6, once=8)
    signal = signal + noise * np.random.default_rng(3).standard_normal(len(signal))
    found, late = edges_of_square_pulses(signal, time, 2.5)
    assert 0 < late < 0.05 / 48e3
    assert np.std(found - rises) < 0.1 * np.std(rising_edges(signal, time, 2.5) - rises)


def test_square_pulses_of_a_run_up_by_hand_are_told_better_than_to_a_sample():
    def swing(t):
        wave = 1.1 * np.sin(2.9 * t) + 0.31 * np.sin(5.3 * t) + 0.11 * np.sin(11.7 * t)
        return 0.1 + 120 * t + 45 * t**2 + wave

    time, signal, rises = tacho(swing, 20e3, 4.0, once=32)
    found, late = edges_of_square_pulses(signal, time, 2.5)
    rounded = rising_edges(signal, time, 2.5)
    assert late > 0
    assert np.std(found - rises) < 0.3 * np.std(rounded - rises)


def test_edges_that_swing_by_more_than_a_sample_stay_where_they_are():
    time, signal, _ = tacho(lambda t: 0.3 + 140 * t + 0.05 * np.sin(2 * pi * 31 * t), 50e3, 0.7)
    found, late = edges_of_square_pulses(signal, time, 2.5)
    np.testing.assert_array_equal(found, rising_edges(signal, time, 2.5))
    assert late == 0.0


def test_pulses_that_rise_slowly_tell_their_edges_between_samples():
    time = np.arange(7000) / 1000
    signal = np.sin(2 * pi * 7.3 * time + 1e-3 * np.sin(2 * pi * 2.9 * time))
    found, late = edges_of_square_pulses(signal, time, 0.0)
    np.testing.assert_array_equal(found, rising_edges(signal, time, 0.0))
    assert late == 0.0


def test_two_encoders_give_the_transmission_error(bench):
    time = np.arange(2000) / 20000
    truth = 3e-6 + 5e-6 * np.sin(2 * pi * 600 * time)
    pinion = 60 * pi * time
    gear = (RADIUS_PINION * pinion - truth) / RADIUS_GEAR
    record = _rig(bench, t=time, p=np.mod(pinion * 4096 / (2 * pi), 4096), g=-gear * 5000 / (2 * pi))
    record["encoders"] = {
        "pinion": {"column": "p", "counts_per_revolution": 4096},
        "gear": {"column": "g", "counts_per_revolution": 5000, "direction": -1},
    }
    loaded = bench.load_as_it_is().records[0]
    error = loaded.channels["transmission_error"]
    np.testing.assert_allclose(error.values, truth - truth.mean(), atol=1e-13)
    assert (error.unit, error.datum) == ("m", "arbitrary")
    np.testing.assert_allclose(loaded.channels["pinion_angle"].values, pinion, atol=1e-10)
    assert loaded.findings == ()
    del bench.content["parameters"]["module"]
    assert "give module under parameters" in bench.only_problem(write=False)


def test_beside_known_inertias_the_angle_is_the_mean_rotation(bench):
    time = np.arange(2000) / 20000
    error, rotation = 5e-6 * np.sin(2 * pi * 600 * time), 60 * pi * time
    inertias = 3e-4, 2e-3
    torques = RADIUS_PINION, -RADIUS_GEAR  # of one force along the line of action
    swings = [arm / inertia for arm, inertia in zip(torques, inertias, strict=True)]
    force = error / (RADIUS_PINION * swings[0] - RADIUS_GEAR * swings[1])
    pinion = rotation + swings[0] * force
    gear = RADIUS_PINION / RADIUS_GEAR * rotation + swings[1] * force
    record = _rig(bench, t=time, p=pinion * 4096 / (2 * pi), g=gear * 5000 / (2 * pi))
    counts = [{"column": "p", "counts_per_revolution": 4096}, {"column": "g", "counts_per_revolution": 5000}]
    record["encoders"] = dict(zip(("pinion", "gear"), counts, strict=True))
    assert np.ptp(bench.load_as_it_is().records[0].channels["pinion_angle"].values - pinion) < 1e-10
    for shaft, inertia in zip(("pinion", "gear"), inertias, strict=True):
        bench.content["parameters"][f"inertia_{shaft}"] = {"value": inertia, "unit": "kg*m^2"}
    loaded = bench.load_as_it_is().records[0].channels
    np.testing.assert_allclose(loaded["transmission_error"].values, error - error.mean(), atol=1e-13)
    assert np.ptp(loaded["pinion_angle"].values - rotation) < 1e-10 < np.ptp(pinion - rotation)


def test_the_index_pulse_is_the_zero_of_the_angle(bench):
    time = np.arange(2000) / 20000
    counts = 60 * pi * time * 4096 / (2 * pi)
    index = (np.arange(2000) >= 400) & (np.arange(2000) < 403)
    record = _rig(bench, t=time, p=counts, z=index.astype(float), x=np.sin(3000 * time))
    record["channels"]["transmission_error"] = {"column": "x", "unit": "um"}
    record["encoders"] = {"pinion": {"column": "p", "counts_per_revolution": 4096, "index": "z"}}
    record["mesh_index"] = True
    loaded = bench.load_as_it_is().records[0]
    angle = loaded.channels["pinion_angle"]
    assert angle.values[400] == pytest.approx(60 * pi / 20000 / 2), "it began in the sample before"
    assert angle.timing_error == pytest.approx(1 / 20000 / 12**0.5)
    assert loaded.mesh_index


@pytest.mark.parametrize("direction", [1, -1])
def test_many_turns_tell_the_index_to_a_part_of_a_sample(bench, direction):
    """The longest sample lasts 0.065 rad; a pulse is seen by the sample behind it."""
    time = np.arange(4000) / 20000
    shaft = 1300 * time + 2000 * time**2
    index = np.r_[0.0, np.diff(np.floor((shaft - 1.234) / (2 * pi)))] > 0
    record = _rig(bench, t=time, p=direction * shaft * 2**20 / (2 * pi), z=index.astype(float), x=np.sin(3000 * time))
    record["channels"]["transmission_error"] = {"column": "x", "unit": "um"}
    encoder = {"column": "p", "counts_per_revolution": 2**20, "index": "z", "direction": direction}
    record["encoders"] = {"pinion": encoder}
    angle = bench.load_as_it_is().records[0].channels["pinion_angle"]
    off = (angle.values - (shaft - 1.234) + pi) % (2 * pi) - pi
    assert np.abs(off).max() < 0.01
    assert np.abs(off).max() < 5 * 1300 * angle.timing_error < 0.05


@pytest.mark.parametrize("stamped", [True, False])
def test_a_tacho_gives_the_pinion_angle(bench, stamped):
    time = np.arange(4000) / 20000
    pulses = np.arange(0.001, 0.2, 2 * pi / 8 / (60 * pi))
    phase = np.mod((time - 0.001) / (2 * pi / 8 / (60 * pi)), 1)
    wave = np.where(phase < 0.5, 5000.0, 0.0)
    wave[np.flatnonzero(phase > 0.7)[40:43]] = 900.0  # a bounce below the threshold
    record = _rig(bench, t=time, x=np.sin(3000 * time), pulses=pulses * 1e3, wave=wave)
    record["channels"]["transmission_error"] = {"column": "x", "unit": "um"}
    tacho = {"timestamps": "pulses", "unit": "ms"} if stamped else {"column": "wave", "unit": "mV"}
    tacho |= {"pulses_per_revolution": 8}
    if not stamped:
        tacho["threshold"] = {"value": 2.5, "unit": "V"}
    record["encoders"] = {"tacho": tacho}
    angle = bench.load_as_it_is().records[0].channels["pinion_angle"].values
    expected = 60 * pi * time
    tolerance = 1e-9 if stamped else 60 * pi / 20000  # a square wave is known to a sample
    assert np.ptp(angle - expected) <= 2 * tolerance


def test_an_encoder_beside_a_measured_angle_is_refused(bench):
    time = np.arange(2000) / 20000
    record = _rig(bench, t=time, x=np.sin(3000 * time), p=1000 * time, angle=60 * pi * time)
    record["channels"]["transmission_error"] = {"column": "x", "unit": "um"}
    record["channels"]["pinion_angle"] = {"column": "angle", "unit": "rad"}
    record["encoders"] = {"pinion": {"column": "p", "counts_per_revolution": 7}}
    with pytest.raises(InputError, match=r"encoders\.pinion: has no meaning beside channels\.pinion_angle"):
        bench.load_as_it_is()


@pytest.mark.parametrize(
    ("encoders", "said"),
    [
        ({"pinion": {"column": "p"}}, "counts_per_revolution: is missing"),
        ({"pinion": {"counts_per_revolution": 9}}, "either column"),
        ({"pinion": {"column": "p", "counts_per_revolution": 0}}, "at least 1"),
        ({"gear": {"column": "p", "counts_per_revolution": 9}}, "gear's encoder alone is no response"),
        ({"pinion": {"column": "q", "counts_per_revolution": 9}}, "no such column"),
    ],
)
def test_an_encoder_that_lacks_something_says_so(bench, encoders, said):
    time = np.arange(2000) / 20000
    _rig(bench, t=time, p=1000 * time)["encoders"] = encoders
    assert said in "\n".join(bench.problems(write=False))


def test_an_oscillator_has_no_encoders(bench):
    _rig(bench, t=np.arange(50) / 100, x=np.sin(np.arange(50)))
    bench.record["channels"]["displacement"] = {"column": "x", "unit": "V"}
    bench.record["encoders"] = {}
    bench.content |= {"system": "oscillator", "parameters": {}}
    bench.record["conditions"] = {}
    assert "only a gear_pair has encoders" in bench.only_problem(write=False)


@pytest.mark.parametrize("rate", [{}, {"sampling_rate": {"value": 5, "unit": "kHz"}}], ids=["no rate", "a rate"])
def test_two_encoders_that_stamp_their_edges_need_no_column_but_a_rate(bench, rate):
    time = np.linspace(0, 1, 400_001)
    pinion = 60 * time + 1e-4 * np.sin(2 * pi * 9 * time)
    gear = 30 * time
    edges = [
        np.interp(np.arange(0.5, shaft[-1] * 900 / (2 * pi)), shaft * 900 / (2 * pi), time) for shaft in (pinion, gear)
    ]
    _rig(bench, a=edges[0], b=edges[1])
    record = bench.content["records"][0]
    record["channels"] = rate
    stamped = {"unit": "s", "counts_per_revolution": 900}
    record["encoders"] = {"pinion": {"timestamps": "a"} | stamped, "gear": {"timestamps": "b"} | stamped}
    if not rate:
        assert "or sampling_rate, at which the angles are taken" in bench.only_problem(write=False)
        return
    loaded = bench.load_as_it_is().records[0]
    begins = max(one[0] for one in edges)
    seen = loaded.channels["transmission_error"].values
    assert len(seen) == int((min(one[-1] for one in edges) - begins) * 5000) + 1
    true = RADIUS_PINION * 1e-4 * np.sin(2 * pi * 9 * (begins + np.arange(len(seen)) / 5000))
    assert np.std(seen - true) < 0.01 * np.std(true)


def test_times_of_pulses_in_another_unit_than_their_name_says_are_refused(bench):
    """Absent, their unit is s."""
    edges = np.arange(1, 900) * 1e3
    _rig(bench, a_us=edges, b=edges / 1e6)
    record = bench.content["records"][0]
    record["channels"] = {"sampling_rate": {"value": 5, "unit": "kHz"}}
    stamped = {"counts_per_revolution": 90}
    record["encoders"] = {"pinion": {"timestamps": "a_us"} | stamped, "gear": {"timestamps": "b"} | stamped}
    said = "encoders.pinion.unit: the times are in s, and their column is named 'a_us'; remedy: write unit: us"
    assert said in "\n".join(bench.problems(write=False))
    record["encoders"]["pinion"]["unit"] = "us"
    assert bench.load_as_it_is().records[0].sampling_rate == pytest.approx(5000)


@pytest.mark.parametrize(
    ("rate", "resample", "is_said"), [(2.0, None, True), (8.0, None, False), (8.0, {"value": 2, "unit": "kHz"}, False)]
)
def test_stamps_that_hold_more_than_the_rate_of_their_angles_are_said(bench, rate, resample, is_said):
    time = np.linspace(0, 1, 400_001)
    shafts = (60 * time + 1e-4 * np.sin(2 * pi * 9 * time), 30 * time)
    edges = [np.interp(np.arange(0.5, one[-1] * 900 / (2 * pi)), one * 900 / (2 * pi), time) for one in shafts]
    _rig(bench, a=edges[0], b=edges[1])
    record = bench.content["records"][0]
    record["channels"] = {"sampling_rate": {"value": rate, "unit": "kHz"}}
    record |= {} if resample is None else {"resample": resample}
    stamped = {"unit": "s", "counts_per_revolution": 900}
    record["encoders"] = {"pinion": {"timestamps": "a"} | stamped, "gear": {"timestamps": "b"} | stamped}
    said = [note for note in bench.load_as_it_is().records[0].notes if "folded back" in note]
    assert [note.split(":")[0] for note in said] == (["pinion", "gear"] if is_said else [])


@pytest.mark.parametrize("bits", [24, 32])
def test_the_clock_of_stamped_edges_goes_on_where_its_register_was_full(bench, bits):
    edges = {"a": np.arange(1200) * 1000.25, "b": np.arange(1200) * 1000.75}  # ticks of 1 us
    begun = {name: np.round(one) + 2**bits - 600_000 for name, one in edges.items()}
    seen = []
    for stamps in (begun, {name: one % 2**bits for name, one in begun.items()}):
        _rig(bench, **stamps)
        record = bench.content["records"][0]
        record["channels"] = {"sampling_rate": {"value": 5, "unit": "kHz"}}
        stamped = {"unit": "us", "counts_per_revolution": 900}
        record["encoders"] = {"pinion": {"timestamps": "a"} | stamped, "gear": {"timestamps": "b"} | stamped}
        seen.append(bench.load_as_it_is().records[0].channels["transmission_error"].values)
    assert len(seen[0]) > 5900
    np.testing.assert_allclose(seen[1], seen[0], atol=1e-12)


@pytest.mark.parametrize("digit", [1e-6, 1e-9])
def test_stamps_of_edges_in_a_smaller_unit_than_said_are_no_endless_record(bench, digit):
    edges = np.arange(0.5, 2000) / 5000
    _rig(bench, a=edges / digit, b=edges / digit)
    record = bench.content["records"][0]
    record["channels"] = {"sampling_rate": {"value": 25, "unit": "MHz"}}
    stamped = {"counts_per_revolution": 900}
    record["encoders"] = {"pinion": {"timestamps": "a"} | stamped, "gear": {"timestamps": "b"} | stamped}
    problem = bench.only_problem(write=False)
    assert "pinion.timestamps" in problem
    assert f"{0.4 / digit:.3g} s" in problem
    assert "unit: us or unit: ns" in problem


@pytest.mark.parametrize("turn", [2048, 32800, 36000, 65535, 65536, 100_000, 9_000_000])
@pytest.mark.parametrize("direction", [1, -1])
def test_a_counter_begins_again_after_a_turn_whatever_register_its_counts_would_fill(turn, direction):
    angle = direction * np.linspace(0, 60, 2000)
    counts = np.floor(np.mod(angle / (2 * pi) * turn, turn))
    found = angle_from_counts(counts, turn)
    np.testing.assert_allclose(found - found[0], angle - angle[0], atol=1.01 * 2 * pi / turn)


@pytest.mark.parametrize(("turn", "bits"), [(200_000, 16), (70_000, 16), (1000, 16), (2**25, 24)])
def test_a_register_that_runs_over_is_told_from_a_turn_by_the_height_of_its_fall(turn, bits):
    angle = np.linspace(0, 60, 2000)
    found = angle_from_counts(np.floor(np.mod(angle / (2 * pi) * turn, 2**bits)), turn)
    np.testing.assert_allclose(found, angle, atol=1.01 * 2 * pi / turn)


def test_an_angle_that_is_rounded_to_a_whole_turn_begins_again_too():
    angle = np.linspace(0.1, 40, 3000)
    rounded = np.round(np.mod(np.degrees(angle), 360), 1)
    rounded[np.argmin(np.abs(rounded - 360))] = 360.0
    found = angle_from_counts(rounded, 360)
    np.testing.assert_allclose(found, angle, atol=1.1e-3)


def test_the_encoder_of_the_gear_tells_the_angle_beside_a_measured_error(bench):
    time = np.arange(2000) / 20000
    gear = 25 * time + 0.01 * np.sin(25 * time)
    record = _rig(bench, t=time, x=np.sin(3000 * time), p=np.mod(np.degrees(gear), 360))
    record["channels"]["transmission_error"] = {"column": "x", "unit": "um"}
    record["encoders"] = {"gear": {"column": "p", "counts_per_revolution": 360}}
    loaded = bench.load_as_it_is().records[0]
    np.testing.assert_allclose(loaded.channels["pinion_angle"].values, 2 * gear, atol=1e-9)
    assert any("from the gear's encoder by the ratio of the teeth" in note for note in loaded.notes)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda content: content["parameters"].pop("n_teeth_gear"), "give n_teeth_gear under parameters"),
        (
            lambda content: content["records"][0].update(mesh_index=True),
            "mesh_index = True: has no meaning without a measured angle",
        ),
        (
            lambda content: content["records"][0]["encoders"].update(tacho={"column": "x", "pulses_per_revolution": 1}),
            "without encoders.pinion beside encoders.tacho",
        ),
        (
            lambda content: content["records"][0]["channels"].update(pinion_angle={"column": "p", "unit": "deg"}),
            "without encoders.pinion beside channels.pinion_angle",
        ),
    ],
)
def test_where_the_encoder_of_the_gear_tells_no_angle_it_is_refused(bench, change, said):
    time = np.arange(2000) / 20000
    record = _rig(bench, t=time, x=np.sin(3000 * time), p=np.degrees(25 * time))
    record["channels"]["transmission_error"] = {"column": "x", "unit": "um"}
    record["encoders"] = {"gear": {"column": "p", "counts_per_revolution": 360}}
    change(bench.content)
    with pytest.raises(InputError, match=said):
        bench.load_as_it_is()


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"unit": "mm/s"}, "at a known radius only; remedy: add where it is measured, radius"),
        ({"unit": "rad/s", "radius": "30 mm"}, "is no velocity along the circumference"),
    ],
)
def test_a_velocity_around_a_shaft_and_its_radius_belong_together(bench, keys, said):
    time = np.arange(2000) / 20000
    record = _rig(bench, t=time, v=np.sin(3000 * time))
    record["channels"]["gear_speed"] = {"column": "v"} | keys
    record["conditions"]["pinion_speed"] = {"value": 600, "unit": "rpm"}
    with pytest.raises(InputError, match=said):
        bench.load_as_it_is()


def test_a_vibrometer_at_a_radius_tells_the_speed_of_its_shaft(bench):
    time = np.arange(2000) / 20000
    speed = 30 + 0.2 * np.sin(3000 * time)
    record = _rig(bench, t=time, v=speed * 31)  # mm/s at 31 mm
    record["channels"]["gear_speed"] = {"column": "v", "unit": "mm/s", "radius": "31 mm", "noise": "3.1 mm/s"}
    record["conditions"]["pinion_speed"] = {"value": 600, "unit": "rpm"}
    found = bench.load_as_it_is().records[0].channels["gear_speed"]
    np.testing.assert_allclose(found.values, speed, rtol=1e-12)
    assert (found.unit, found.noise, found.radius) == ("rad/s", pytest.approx(0.1), None)
