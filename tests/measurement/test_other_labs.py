"""Files as other labs write them: what stood before, behind and beside the values was once taken for something else."""

import numpy as np
import pytest
import yaml
from nptdms import ChannelObject, TdmsWriter
from scipy.io import wavfile

from gear_damping.errors import InputError
from gear_damping.measurement.checks import check_channel
from gear_damping.measurement.encoders import angle_from_counts, angle_from_pulses
from gear_damping.measurement.formats.moments import moments_of
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.record import Channel
from gear_damping.measurement.record_checks import check_record
from gear_damping.units import parse_unit, to_si

TIME = np.arange(400) / 500.0
DECAY = 30e-3 * np.exp(-2 * TIME) * np.cos(2 * np.pi * 12 * TIME)
ROWS = "\n".join(f"{t:.4f} {x:.6g}" for t, x in zip(TIME, DECAY, strict=True))


def loaded(folder, text, channels, system="oscillator", name="data.csv", **record):
    """The measurement of one record that lies in a text file."""
    (folder / name).write_text(text, encoding="utf-8")
    content = {"system": system, "records": [{"file": name, "channels": channels, **record}]}
    (folder / "measurement.yaml").write_text(yaml.safe_dump(content))
    return load_measurement(folder / "measurement.yaml")


def decay_of(measurement):
    return measurement.records[0].channels["displacement"].values


BY_INDEX = {"time": {"column": 0, "unit": "s"}, "displacement": {"column": 1, "unit": "m"}}


@pytest.mark.parametrize(
    "head",
    [
        "Beam test no. five, tip sensor\nt a\n",
        "Beam test no. five, tip sensor\n",
        "% t a\n",
        "; t a\n",
        "// t a\n",
        "! t a\n",
        "Time (s)   Acc (m)\n",
        "# made by hand\nt a\n",
        "",
    ],
)
def test_titles_and_signs_of_comment_are_no_columns(tmp_path, head):
    found = loaded(tmp_path, head + ROWS, BY_INDEX, name="data.txt")
    np.testing.assert_allclose(decay_of(found), DECAY, atol=1e-7)
    assert found.records[0].sampling_rate == pytest.approx(500.0)


@pytest.mark.parametrize(
    "head",
    [
        "Beam, tip sensor, lab three, Monday\nt,x\n",
        "File,beam.csv\nRate (Hz),500\nChannels,2\nt,x\n",
        "File,beam.csv\nt,x\n",
    ],
)
def test_the_names_are_those_next_above_the_values(tmp_path, head):
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
    found = loaded(tmp_path, head + ROWS.replace(" ", ","), channels)
    np.testing.assert_allclose(decay_of(found), DECAY, atol=1e-7)


def test_a_row_of_units_never_gives_the_names(tmp_path):
    (tmp_path / "a.csv").write_text("Zeit;Kanal 1;Kanal 1\n[s];[g];[mm/s^2]\n0;1;2\n1;3;4\n2;4;5\n")
    table = read_table(tmp_path / "a.csv")
    assert list(table.names) == ["Zeit", "Kanal 1", "Kanal 1"]
    assert [table.unit(k) for k in range(3)] == ["s", "g", "mm/s^2"]


def test_a_comment_behind_the_values_is_no_row(tmp_path):
    text = "t,x\n" + ROWS.replace(" ", ",") + "\n# end of data\n"
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
    np.testing.assert_allclose(decay_of(loaded(tmp_path, text, channels)), DECAY, atol=1e-7)


def test_a_gain_may_lie_between_volts_in_the_file_and_what_they_stand_for(tmp_path):
    text = "t,CH1 [mV]\n" + "\n".join(f"{t:.4f},{98.2 * x:.8g}" for t, x in zip(TIME, DECAY, strict=True))
    channel = {"column": "CH1 [mV]", "unit": "m", "gain": 98.2}
    found = loaded(tmp_path, text, {"time": {"column": "t", "unit": "s"}, "displacement": channel})
    np.testing.assert_allclose(decay_of(found), DECAY, atol=1e-8)
    assert not [f for f in found.findings if f.kind == "unit_conflict"]
    del channel["gain"]
    other = loaded(tmp_path, text, {"time": {"column": "t", "unit": "s"}, "displacement": channel})
    (problem,) = [f for f in other.findings if f.severity == "data_problem"]
    assert problem.kind == "unit_conflict"
    assert "write gain: what the column holds for one m (1 where its header names something else)" in problem.message


def test_what_a_header_says_in_brackets_may_be_a_side_and_no_unit(tmp_path):
    text = "t,Weg (A)\n" + "\n".join(f"{t:.4f},{x:.8g}" for t, x in zip(TIME, DECAY, strict=True))
    channel = {"column": "Weg (A)", "unit": "m", "gain": 1}  # as the remedy for the conflict says
    found = loaded(tmp_path, text, {"time": {"column": "t", "unit": "s"}, "displacement": channel})
    assert not [f for f in found.findings if f.severity == "data_problem"]


@pytest.mark.parametrize(("unit", "conflicts"), [("kgf", False), ("N", True)])
def test_a_load_cell_may_say_kilograms_for_a_force(tmp_path, unit, conflicts):
    text = "t,x,Last [kg]\n" + "\n".join(f"{t:.4f},{x:.8g},{9 * x:.8g}" for t, x in zip(TIME, DECAY, strict=True))
    channels = {"displacement": {"column": "x", "unit": "m"}, "force": {"column": "Last [kg]", "unit": unit}}
    found = loaded(tmp_path, text, {"time": {"column": "t", "unit": "s"}, **channels})
    assert any(f.kind == "unit_conflict" for f in found.findings) is conflicts


def test_a_wrong_unit_of_time_is_not_silent(tmp_path):
    text = "Time [ms],x\n" + "\n".join(f"{1e3 * t:.4f},{x:.6g}" for t, x in zip(TIME, DECAY, strict=True))
    channels = {"time": {"column": "Time [ms]", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
    with pytest.raises(InputError, match=r"time.unit = 's': the header of column 'Time \[ms\]' says 'ms'"):
        loaded(tmp_path, text, channels)
    assert loaded(tmp_path, text, channels | {"time": {"column": 0}}).records[0].sampling_rate == pytest.approx(500.0)


def test_pulses_take_the_unit_of_their_column(tmp_path):
    time, pulses = np.arange(1000) / 1000, np.arange(0, 1.2, 0.01) - 0.05
    encoders = {"pinion": {"timestamps": 2, "counts_per_revolution": 60}}
    rows = [f"{t:.4f},{1e-6:g},{1e6 * p:.1f}" if i < len(pulses) else f"{t:.4f},{1e-6:g}," for i, (t, p) in
            enumerate(zip(time, np.pad(pulses, (0, 1000 - len(pulses))), strict=True))]  # fmt: skip
    channels = {"time": {"column": 0, "unit": "s"}, "transmission_error": {"column": 1, "unit": "m"}}
    asked = {"system": "gear_pair", "encoders": encoders, "conditions": {"pinion_torque": {"value": 9, "unit": "N*m"}}}
    found = loaded(tmp_path, "t,x,tp [us]\n" + "\n".join(rows), channels, **asked)
    angle = found.records[0].channels["pinion_angle"].values
    assert np.ptp(angle) == pytest.approx(2 * np.pi * 0.999 / 0.01 / 60, rel=1e-3)


def test_pulses_that_all_lie_behind_the_record_are_refused():
    with pytest.raises(InputError, match="fewer than 2 of them in the record"):
        angle_from_pulses(np.arange(1, 70) * 1e4, np.arange(0, 1, 1e-3), 60, 1, "tacho", "file")


@pytest.mark.parametrize("bits", [16, 24, 32])
def test_a_counter_that_runs_over_goes_on(bits):
    true = 2**bits - 3000 + 7.0 * np.arange(2000)
    found = angle_from_counts(true % 2**bits, 1000)
    np.testing.assert_allclose(found - found[0], 2 * np.pi * (true - true[0]) / 1000, atol=1e-9)


def test_a_counter_of_two_counts_a_turn_counts_turns():
    counts = np.floor(np.arange(500) / 7.0)
    assert angle_from_counts(counts, 2)[-1] == pytest.approx(np.pi * counts[-1])
    again = angle_from_counts(np.arange(500) % 60, 60)  # and one that begins anew after each turn
    assert again[-1] == pytest.approx(2 * np.pi * 499 / 60)


@pytest.mark.parametrize("places", [(70, 71, 72), (70, 120, 150, 220), (5, 6, 7, 150, 151, 220)])
def test_marks_for_missing_values_are_no_motion(tmp_path, places):
    values = DECAY.copy()
    values[list(places)] = -9999
    text = "t,x\n" + "\n".join(f"{t:.4f},{x:.6g}" for t, x in zip(TIME, values, strict=True))
    found = loaded(tmp_path, text, {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}})
    said = [f for f in check_record(found.records[0]) if f.severity == "data_problem"]
    assert [f.kind for f in said] == ["marked_values"]
    assert f"-9999 m at {len(places)} samples, the first at {places[0]}" in said[0].message


@pytest.mark.parametrize(
    ("places", "resting", "faults"),
    [(range(6), 0.0, 0), (range(590, 600), 0.0, 0), (range(6), -9999.0, 1), ((70, 71, 72), 0.0, 1)],
)
def test_an_input_that_is_not_switched_on_yet_is_not_missing(places, resting, faults):
    """A duty that steps from 0 to its constant value; what comes back in between, and what is no rest, is a mark."""
    force = np.full(600, 0.5)
    force[list(places)] = resting
    found = check_channel(Channel("force", force, "N"), np.array([], int))
    assert [one.kind for one in found if one] == ["marked_values"] * faults


def test_a_blow_of_a_hammer_is_no_fault(tmp_path):
    force, answer = np.zeros(400), np.where(TIME > 0.1, 2 * np.exp(-3 * (TIME - 0.1)), 0.0) * np.sin(75 * (TIME - 0.1))
    force[50], answer[50] = 119.9, 40.0
    source = np.random.default_rng(1)
    force, answer = force + 0.1 * source.standard_normal(400), answer + 0.01 * source.standard_normal(400)
    text = "t,f,a\n" + "\n".join(",".join(f"{v:.6g}" for v in row) for row in zip(TIME, force, answer, strict=True))
    channels = {"time": {"column": "t", "unit": "s"}, "force": {"column": "f", "unit": "N"}}
    channels["acceleration"] = {"column": "a", "unit": "m/s^2"}
    assert not [f for f in loaded(tmp_path, text, channels).findings if f.kind == "spike"]
    force[50], force[300] = 0.0, 119.9  # a leap of the response by itself is one
    text = "t,f,a\n" + "\n".join(",".join(f"{v:.6g}" for v in row) for row in zip(TIME, force, answer, strict=True))
    assert [f.kind for f in loaded(tmp_path, text, channels).findings if f.kind == "spike"] == ["spike"]


@pytest.mark.parametrize("empty", ["", "NaN", "N/A", "-", "OVLD"])
def test_what_is_missing_outside_the_used_rows_is_no_fault(tmp_path, empty):
    cells = [empty if i < 20 else f"{x:.6g}" for i, x in enumerate(DECAY)]
    text = "t,x\n" + "\n".join(f"{t:.4f},{x}" for t, x in zip(TIME, cells, strict=True))
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
    found = loaded(tmp_path, text, channels, slice=[20, 400])
    np.testing.assert_allclose(decay_of(found), DECAY[20:], atol=1e-7)
    with pytest.raises(InputError, match=r"an empty cell|not a number|not finite"):
        loaded(tmp_path, text, channels, slice=[10, 400])


@pytest.mark.parametrize("empty", ["", "NaN"])
def test_a_slower_channel_ends_where_its_rows_do(tmp_path, empty):
    slow, torque = TIME[::10], np.sin(TIME[::10])
    rows = []
    for i, (t, x) in enumerate(zip(TIME, DECAY, strict=True)):
        beside = f"{slow[i]:.4f},{torque[i]:.6g}" if i < len(slow) else f"{empty},{empty}"
        rows.append(f"{t:.4f},{x:.6g},{beside}")
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
    channels["force"] = {"column": "f", "unit": "N", "time": {"column": "ts", "unit": "s"}}
    found = loaded(tmp_path, "t,x,ts,f\n" + "\n".join(rows), channels, slice=[0, 380])
    np.testing.assert_allclose(found.records[0].channels["force"].values, np.sin(TIME[:380]), atol=1e-3)


def test_the_range_of_a_wav_of_floats_is_what_one_stands_for(tmp_path):
    samples = (DECAY / 0.1).astype(np.float32)
    wavfile.write(tmp_path / "a.wav", 500, samples)
    content = {"system": "oscillator", "records": [{"file": "a.wav", "channels": {
        "acceleration": {"column": 0, "unit": "m/s^2", "range": {"value": 100, "unit": "m/s^2"}}}}]}  # fmt: skip
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    found = load_measurement(tmp_path / "measurement.yaml").records[0].channels["acceleration"]
    np.testing.assert_allclose(found.values, 100 * DECAY / 0.1, rtol=1e-5)


@pytest.mark.parametrize("line", ["? [a, b]\n: 3\n", "{a: b}: 3\n"])
def test_a_key_that_is_no_name_is_said(tmp_path, line):
    (tmp_path / "measurement.yaml").write_text("system: oscillator\n" + line)
    with pytest.raises(InputError, match="a key is a name, not a list or a mapping"):
        load_measurement(tmp_path / "measurement.yaml")


def test_a_column_of_another_clock_keeps_its_own_frequencies(tmp_path):
    fast, slow = np.sin(2 * np.pi * 40 * np.arange(2000) / 1000), np.sin(2 * np.pi * 3 * np.arange(500) / 100)
    with TdmsWriter(tmp_path / "a.tdms") as writer:
        writer.write_segment([ChannelObject("g", "fast", fast, {"wf_increment": 1e-3}),
                              ChannelObject("g", "slow", slow, {"wf_increment": 1e-2}),
                              ChannelObject("g", "fast2", fast, {"wf_increment": 1e-3})])  # fmt: skip
    found = inspect_table(read_table(tmp_path / "a.tdms"))
    strongest = {c.reference.split("/")[-1]: c.spectrum.strongest for c in found.columns}
    assert strongest["slow"] == pytest.approx(3.0, abs=0.3)
    assert strongest["fast"] == pytest.approx(40.0, abs=1.0)


@pytest.mark.parametrize(
    ("unit", "same", "factor"),
    [("m/s2", "m/s^2", 1.0), ("sec", "s", 1.0), ("mil", "um", 25.4), ("ips", "mm/s", 25.4), ("RPM", "rpm", 1.0),
     ("micron", "um", 1.0), ("kNm", "N*m", 1e3), ("Volts", "mV", 1e3), ("kg*m2", "kg*m^2", 1.0)],
)  # fmt: skip
def test_units_as_they_are_written(unit, same, factor):
    assert to_si(1.0, unit, same) == pytest.approx(factor * to_si(1.0, same, same))


@pytest.mark.parametrize("name", ["V2", "A2", "t2", "12"])
def test_the_name_of_a_channel_is_no_unit(name):
    with pytest.raises(InputError):
        parse_unit(name)


@pytest.mark.parametrize("unit", ["1/min", "min^-1", "min-1", "min⁻¹", "r/min", "U/min"])
def test_what_counts_by_the_minute_is_turns_where_a_shaft_is_meant(unit):
    assert to_si(60.0, unit, "rad/s") == pytest.approx(2 * np.pi)


def test_by_the_minute_is_a_rate_elsewhere():
    assert to_si(60.0, "1/min", "Hz") == pytest.approx(1.0)


@pytest.mark.parametrize("unit", ["Hz", "1/s"])
def test_a_speed_says_what_it_counts(unit):
    with pytest.raises(InputError, match="say what it counts: 'rpm', 'rev/s' or 'rad/s'"):
        to_si(1.0, unit, "rad/s")


@pytest.mark.parametrize(
    ("before", "behind"),
    [
        ("2023-10-31T23:59:{:06.3f}Z", "2023-11-01T00:00:{:06.3f}Z"),
        ("31.10.2023 23:59:{:06.3f}", "01.11.2023 00:00:{:06.3f}"),
        ("10/31/2023 11:59:{:06.3f} PM", "11/1/2023 12:00:{:06.3f} AM"),
        ("23:59:{:06.3f}", "00:00:{:06.3f}"),
    ],
)
def test_dates_and_clocks_are_seconds_from_the_first(tmp_path, before, behind):
    times = np.round(np.arange(0, 20, 0.02), 3)
    clocks = [before.format(50 + t) if t < 10 else behind.format(t - 10) for t in times]
    rows = "\n".join(f"{clock}\t{np.sin(t):.6g}" for clock, t in zip(clocks, times, strict=True))
    channels = {"time": {"column": "t"}, "displacement": {"column": "x", "unit": "m"}}
    record = loaded(tmp_path, "t\tx\n" + rows, channels).records[0]
    np.testing.assert_allclose(record.time, times, atol=1e-9)


def test_minutes_and_seconds_since_a_start_are_a_clock():
    assert moments_of(["00:59.5", "01:00.0", "01:00.5"]).seconds.tolist() == [0, 0.5, 1]
    assert moments_of(["00:59.5", "end"]) is None


def test_a_date_alone_is_no_clock(tmp_path):
    rows = "\n".join(f"2023-11-05,{x:.6g}" for x in DECAY)
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
    with pytest.raises(InputError, match="a date or a clock in a form that is not read; remedy: give sampling"):
        loaded(tmp_path, "t,x\n" + rows, channels)


@pytest.mark.parametrize(("written", "asked"), [("x \u00b5m", "x \u03bcm"), ("La\u0308nge", "L\u00e4nge")])
def test_letters_in_other_codes_are_the_same(tmp_path, written, asked):
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": asked, "unit": "m"}}
    found = loaded(tmp_path, f"t,{written}\n" + ROWS.replace(" ", ","), channels)
    np.testing.assert_allclose(decay_of(found), DECAY, atol=1e-7)


def test_time_in_the_notation_of_iso_is_time(tmp_path):
    (tmp_path / "a.csv").write_text("Zeit/s,a\n" + ROWS.replace(" ", ","))
    found = inspect_table(read_table(tmp_path / "a.csv"))
    assert (found.time.index, found.time.unit) == (0, "s")
    assert found.rate == pytest.approx(500.0)


@pytest.mark.parametrize(
    ("fit", "held", "said"),
    [
        ({"slice": [0, 250]}, {"slice": [200, 400]}, "rows 200 to 250 of it are fitted in records\\[0\\]"),
        ({"slice": [0, 250]}, {}, "rows of it are fitted"),
        ({}, {}, "all rows of it are fitted"),
        ({"slice": [0, 250]}, {"slice": [250, 400]}, ""),
        (
            {"window": {"from": 0, "to": 0.5, "unit": "s"}},
            {"window": {"from": 300, "to": 700, "unit": "ms"}},
            "0.3 s to 0.5 s of it",
        ),
    ],
)
def test_what_is_held_out_is_not_fitted(tmp_path, fit, held, said):
    (tmp_path / "data.csv").write_text("t,x\n" + ROWS.replace(" ", ","))
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
    records = [{"file": "data.csv", "name": role, "role": role, "channels": channels, **rows}
               for role, rows in (("fit", fit), ("holdout", held))]  # fmt: skip
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    if not said:
        assert len(load_measurement(tmp_path / "measurement.yaml").records) == 2
        return
    with pytest.raises(InputError, match=said):
        load_measurement(tmp_path / "measurement.yaml")


@pytest.mark.parametrize(("held", "is_told"), [("y", False), ("x", True)])
def test_trials_side_by_side_share_their_time_and_their_force(tmp_path, held, is_told):
    """Three columns beside one time: what is held out is another one."""
    rows = (f"{k * 0.002:g},{x:.9g},{2 * x:.9g},0.1" for k, x in enumerate(DECAY))
    (tmp_path / "data.csv").write_text("t,x,y,F\n" + "\n".join(rows))
    shared = {"time": {"column": "t", "unit": "s"}, "force": {"column": "F", "unit": "N"}}
    records = [{"file": "data.csv", "name": role, "role": role,
                "channels": shared | {"displacement": {"column": column, "unit": "m"}}}
               for role, column in (("fit", "x"), ("holdout", held))]  # fmt: skip
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    if is_told:
        with pytest.raises(InputError, match="all rows of it are fitted"):
            load_measurement(tmp_path / "measurement.yaml")
        return
    assert [record.role for record in load_measurement(tmp_path / "measurement.yaml").records] == ["fit", "holdout"]


def test_segments_and_delays_lie_within_the_records(tmp_path):
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
    text = "t,x\n" + ROWS.replace(" ", ",")
    late = channels | {"displacement": {"column": "x", "unit": "m", "delay": {"value": 3, "unit": "s"}}}
    with pytest.raises(InputError, match=r"channels.displacement.delay = '3 s': the record is 0.798 s long"):
        loaded(tmp_path, text, late)
    (tmp_path / "data.csv").write_text(text)
    content = {"system": "oscillator", "segments": {"value": 50, "unit": "s"}}
    content["records"] = [{"file": "data.csv", "channels": channels}]
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(InputError, match=r"segments = '50 s': is longer than every record, the longest of 0.798 s"):
        load_measurement(tmp_path / "measurement.yaml")


@pytest.mark.parametrize(("unit", "step"), [("us", 2000), ("ms", 2)])
def test_a_clock_goes_on_where_its_register_is_full(tmp_path, unit, step):
    ticks = (2**32 - 150 * step + step * np.arange(TIME.size)) % 2**32
    rows = "\n".join(f"{tick},{x:.6g}" for tick, x in zip(ticks, DECAY, strict=True))
    channels = {"time": {"column": "t", "unit": unit}, "displacement": {"column": "x", "unit": "m"}}
    time = loaded(tmp_path, "t,x\n" + rows, channels).records[0].time
    np.testing.assert_allclose(time - time[0], TIME, atol=1e-9)
    assert inspect_table(read_table(tmp_path / "data.csv")).rows == (0, TIME.size)


def test_a_clock_that_starts_again_elsewhere_has_no_full_register(tmp_path):
    ticks = 2000 * (np.arange(TIME.size) % 200)
    rows = "\n".join(f"{tick},{x:.6g}" for tick, x in zip(ticks, DECAY, strict=True))
    channels = {"time": {"column": "t", "unit": "us"}, "displacement": {"column": "x", "unit": "m"}}
    with pytest.raises(InputError, match="2 recordings one after another"):
        loaded(tmp_path, "t,x\n" + rows, channels)


def test_the_rate_of_a_dataset_is_the_file_s_and_a_scale_beside_it_is_said(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["acc"] = DECAY
        file["acc"].attrs.update({"sampling_rate": 500.0, "unit": "m", "scale": 0.5, "add_offset": 3.0})
    table = read_table(tmp_path / "a.h5")
    assert table.clock(0) == (0.0, 500.0)
    assert any("scale = 0.5, which is not applied" in note for note in table.notes)
    assert any("add_offset = 3.0, which is not applied" in note for note in table.notes)


@pytest.mark.parametrize("name", ["scale", "scale_factor", "gain", "slope", "calibration_factor"])
def test_a_record_says_a_factor_beside_its_column_unless_a_gain_is_declared(name, tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["acc"] = DECAY
        file["acc"].attrs.update({"sampling_rate": 500.0, "unit": "m", name: 0.001, "offset": 0.0})
    path = tmp_path / "m.yaml"
    said = {}
    for gain in ("", ", gain: 1"):
        path.write_text(
            "system: oscillator\nrecords:\n  - file: a.h5\n    channels:\n      displacement: {column: acc"
            + gain
            + "}\n"
        )
        found = load_measurement(path).findings
        said[gain] = [one.message for one in found if (one.kind, one.severity) == ("not_applied", "note")]
    assert len(said[""]) == 1
    assert f"has an attribute {name} = 0.001, which is not applied" in said[""][0]
    assert "write gain: one over it" in said[""][0]
    assert said[", gain: 1"] == []


def test_a_level_is_no_motion(tmp_path):
    rows = "\n".join(f"{t:.4f},{x:.6g}" for t, x in zip(TIME, DECAY, strict=True))
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "dB"}}
    with pytest.raises(
        InputError, match=r"displacement.unit = 'dB': a level is a logarithm, and no signal; remedy: give"
    ):
        loaded(tmp_path, "t,x\n" + rows, channels)


def test_rows_that_are_written_when_something_changes_have_lost_nothing(tmp_path):
    """A wheel of 2 s a period whose way an interface writes in steps of a millimetre, at hundredths of a second."""
    time = np.arange(0, 15, 0.01)
    way = np.round(np.exp(-0.2 * time) * np.cos(3.1 * time) * 0.13, 3)
    kept = np.r_[True, np.diff(way) != 0]
    kept[300:600] &= np.arange(300) % 12 == 0  # slow here
    rows = "\n".join(f"{t:.2f}\t{x:.3f}" for t, x in zip(time[kept], way[kept], strict=True))
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
    (record,) = loaded(tmp_path, "t\tx\n" + rows, channels).records
    assert not [finding for finding in record.findings if finding.severity == "data_problem"]
    assert not record.uniform
