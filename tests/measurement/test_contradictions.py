"""A declaration that its file contradicts ends in one message that names the key, the rule and the remedy."""

import math

import numpy as np
import pytest
import yaml
from scipy.io import savemat

import gear_damping as gd
from gear_damping.explanation.model.contradicted import contradicted
from gear_damping.identification.output_error.records import FreeParameter

TIME = np.arange(400) / 200.0
MOTION = 2.0 * np.exp(-0.5 * TIME) * np.cos(2 * np.pi * 4 * TIME)
FORCE = np.sin(2 * np.pi * 3 * TIME)
X, F = {"column": "x", "unit": "mm"}, {"column": "F", "unit": "N"}


def read(folder, channels, table=None, above="", **more):
    """A record of some columns, loaded."""
    table = table or {"t": TIME, "x": MOTION, "F": FORCE}
    rows = "\n".join(",".join(f"{value:.17g}" for value in row) for row in zip(*table.values(), strict=True))
    (folder / "run.csv").write_text(above + ",".join(table) + "\n" + rows + "\n")
    content = {"records": [{"file": "run.csv", "channels": channels, **more.pop("record", {})}]}
    (folder / "measurement.yaml").write_text(yaml.safe_dump({"system": "oscillator", **content, **more}))
    return gd.load(folder / "measurement.yaml")


def refused(folder, *arguments, **more):
    try:
        gd.identify(read(folder, *arguments, **more))
    except gd.InputError as error:
        return str(error)
    pytest.fail("nothing was refused")


def timed(unit, column="t"):
    return {"time": {"column": column, "unit": unit}, "displacement": X}


@pytest.mark.parametrize("said", ["us", "ms", "s"])
def test_stamps_since_1970_tell_their_unit(said, tmp_path):
    stamps = 1_772_366_400_000_000_000 + 1e9 * TIME
    message = refused(tmp_path, timed(said), {"t": stamps, "x": MOTION})
    assert f"channels.time.unit = '{said}'" in message
    assert "beyond the year 2286; remedy: write unit: ns" in message


def test_the_right_unit_of_such_stamps_is_read(tmp_path):
    table = {"t": 1_772_366_400_000_000_000 + 1e9 * TIME, "x": MOTION}
    (record,) = read(tmp_path, timed("ns"), table).records
    assert record.sampling_rate == pytest.approx(200.0, rel=1e-3)


@pytest.mark.parametrize(("name", "is_refused"), [("seconds_elapsed", True), ("milliseconds", False)])
def test_a_name_that_says_seconds_is_heeded(name, is_refused, tmp_path):
    table = {name: TIME, "x": MOTION}
    if is_refused:
        assert "the column is named 'seconds_elapsed'; remedy: write unit: s" in refused(
            tmp_path, timed("ms", name), table
        )
    else:
        assert read(tmp_path, timed("ms", name), table).records[0].sampling_rate == pytest.approx(2e5)


@pytest.mark.parametrize("column", ["angle [deg]", "Freq (Hz)", "Revolutions [rev]", "x / mm"])
def test_a_header_that_says_no_unit_of_time_is_refused_as_the_time(column, tmp_path):
    message = refused(tmp_path, timed("s", column), {column: 2 * TIME, "x": MOTION})
    assert f"channels.time = '{column}'" in message
    assert "which is no unit of time; remedy: name the column of the time, or give sampling_rate" in message


@pytest.mark.parametrize("column", ["Time (A)", "t [m]", "k (1)", "X [raw]", "X [5 ms]"])
def test_a_name_of_time_or_what_is_no_unit_beside_it_is_taken(column, tmp_path):
    unit = "ms" if "ms" in column else "s"
    channels = {"time": {"column": column} | ({} if unit == "ms" else {"unit": unit}), "displacement": X}
    (record,) = read(tmp_path, channels, {column: TIME, "x": MOTION}).records
    assert record.time.size == TIME.size


def test_a_step_above_the_table_beside_another_rate_is_said(tmp_path):
    channels, table = {"sampling_rate": "400 Hz", "displacement": X}, {"x": MOTION, "F": FORCE}
    (record,) = read(tmp_path, channels, table, "Delta_X,0.005\n").records
    said = [finding.message for finding in record.findings if finding.kind == "rate_conflict"]
    assert said == ["'Delta_X' beside the table says 200 Hz and sampling_rate says 400 Hz, which was used; correct the "
                    "one that is wrong, or give the column as time"]  # fmt: skip
    (record,) = read(tmp_path, channels | {"sampling_rate": "200 Hz"}, table, "Delta_X,0.005\n").records
    assert "rate_conflict" not in {finding.kind for finding in record.findings}


@pytest.mark.parametrize("ending", ["npz", "mat"])
@pytest.mark.parametrize(("beside", "is_said"), [({"Fs": 100.0}, True), ({"Fs": 200.0}, False), ({"dt": 0.01}, True)])
def test_a_rate_beside_arrays_that_contradicts_the_declared_one_is_said(ending, beside, is_said, tmp_path):
    save = np.savez if ending == "npz" else lambda path, **arrays: savemat(path, arrays)
    save(tmp_path / f"run.{ending}", x=MOTION, **beside)
    channels = {"sampling_rate": "200 Hz", "displacement": X}
    content = {"system": "oscillator", "records": [{"file": f"run.{ending}", "channels": channels}]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    findings = gd.load(tmp_path / "measurement.yaml").records[0].findings
    said = [one.message for one in findings if one.kind == "rate_conflict"]
    assert len(said) == is_said
    assert all(one.startswith(f"'{next(iter(beside))}' beside the table says 100 Hz and") for one in said)


@pytest.mark.parametrize(
    ("delay", "said"), [("0.25 s", "last 50 samples"), ("-0.1 s", "first 20 samples"), ("30 ms", "")]
)
def test_an_input_that_a_delay_moves_out_of_the_record_is_said(delay, said, tmp_path):
    (record,) = read(tmp_path, timed("s") | {"force": F | {"delay": delay}}).records
    found = [one.message for one in record.findings if one.kind == "input_beyond_record"]
    assert len(found) == bool(said)
    assert all(said in one for one in found)


def test_a_segment_below_a_sample_is_refused(tmp_path):
    message = refused(tmp_path, timed("s"), segments="1 ms")
    assert "segments = '0.001 s': is shorter than the time to the next sample at 200 Hz" in message


def test_a_force_is_given_once(tmp_path):
    message = refused(tmp_path, timed("s") | {"force": F}, record={"conditions": {"force": "3 N"}})
    assert "conditions.force: the force is given under channels too" in message


def test_a_force_is_no_motion(tmp_path):
    message = refused(tmp_path, timed("s") | {"force": {"column": "x", "unit": "N"}})
    assert "channels.displacement.column: is the column of channels.force too" in message


@pytest.mark.parametrize(("noise", "is_refused"), [("5 m", True), ("1.5 mm", False)])
def test_a_stated_noise_lies_below_what_it_is_the_noise_of(noise, is_refused, tmp_path):
    channels = timed("s") | {"displacement": X | {"noise": noise}}
    if is_refused:
        assert "its stated noise, 5000 mm, is more than all that it shows, 0.9" in refused(tmp_path, channels)
    else:
        assert gd.identify(read(tmp_path, channels)).content["converged"]


def test_a_clock_is_no_motion(tmp_path):
    message = refused(tmp_path, timed("s") | {"displacement": {"column": "t", "unit": "mm"}})
    assert "the displacement is a straight line, as a clock or a counter: name another column" in message


@pytest.mark.parametrize(
    ("stated", "said"),
    [("-2 mm/s^2/N", "comes out at 2"), ("2 m/s^2/N", "and the file states 2000"), ("3 mm/s^2/N", None)],
)
def test_a_gain_far_from_the_stated_one_is_said(stated, said, tmp_path):
    """x'' + 1.2 x' + 630 x = 2 F, integrated by its transfer function."""
    from scipy.signal import lsim

    force = np.random.default_rng(3).normal(size=len(TIME)).cumsum()
    motion = lsim(([2.0], [1.0, 1.2, 630.0]), force, TIME)[1]
    channels, table = timed("s") | {"force": F}, {"t": TIME, "x": motion, "F": force}
    found = gd.identify(read(tmp_path, channels, table, parameters={"force_gain": stated}))
    assert found.content["parameters"]["force_gain"]["value"] == pytest.approx(2.0, rel=0.02)
    assert (said is None) == (found.content["contradicted"] is None)
    assert said is None or (said in found.content["contradicted"] and found.content["contradicted"] in found.table())


@pytest.mark.parametrize("given", ["list", "pattern"])
def test_several_files_are_several_records(given, tmp_path):
    for k in (1, 2):
        (tmp_path / f"part_{k}.csv").write_text("t,x\n0,1\n")
    file = {"list": ["part_1.csv", "part_2.csv"], "pattern": "part_*.csv"}[given]
    message = refused(tmp_path, timed("s"), record={"file": file})
    assert "a record has one file" in message
    assert "make each file a record of its own" in message
    assert given == "list" or "part_1.csv, part_2.csv" in message


def test_a_folder_and_a_measurement_are_no_paths_of_a_yaml(tmp_path):
    measurement = read(tmp_path, timed("s"))
    with pytest.raises(gd.InputError, match=r"is a folder, no file; remedy: give the path of a measurement.yaml, as "):
        gd.load(tmp_path)
    with pytest.raises(gd.InputError, match="must be a path, and is a Measurement"):
        gd.load(measurement)
    with pytest.raises(gd.InputError, match="must be a path, and is an int;"):
        gd.load(3)


@pytest.mark.parametrize(
    ("text", "column", "said"),
    [
        ("pot:606\npot:607\n" * 40, 0, "a name stands before every value, as in 'pot:607'"),
        ("t,x\n" + "2026-03-01T12:00:01,on\n2026-03-01T12:00:02,off\n" * 40, 1, "a header and no rows of numbers"),
        ("0.1 -> 606\n0.2 -> 607\n" * 40, 1, "not a number, and no other of its 80 cells is one; remedy: name another"),
        ("t id\n" + "0.1 1 Rx 07 D0\n0.2 7 Rx 01\n" * 40, 0, "a log of messages by turns, as of a CAN bus, is none"),
    ],
)
def test_logs_that_are_no_tables_say_what_they_are(text, column, said, tmp_path):
    (tmp_path / "log.txt").write_text(text)
    channels = {"sampling_rate": "10 Hz", "displacement": {"column": column, "unit": "mm"}}
    assert said in refused(tmp_path, channels, record={"file": "log.txt"})


def test_a_column_that_ends_before_the_others_has_another_time(tmp_path):
    rows = "\n".join(f"{t:g},{x:g},{x if k < 100 else ''}" for k, (t, x) in enumerate(zip(TIME, MOTION, strict=True)))
    (tmp_path / "two.csv").write_text("t,x,slow\n" + rows + "\n")
    channels = timed("s") | {"displacement": {"column": "slow", "unit": "mm"}}
    message = refused(tmp_path, channels, record={"file": "two.csv"})
    assert "its cells end behind row 99 of 400; remedy: where it was sampled at another rate, give the" in message


def test_two_levels_are_no_counts(tmp_path):
    rows = "\n".join(f"{k / 1000:g},{k % 2},{k // 2 % 2}" for k in range(400))
    (tmp_path / "edges.csv").write_text("t,A,B\n" + rows + "\n")
    parameters = {"n_teeth_pinion": 20, "n_teeth_gear": 40, "module": "3 mm", "pressure_angle": "20 deg"}
    record = {
        "file": "edges.csv", "channels": {"time": {"column": "t", "unit": "s"}},
        "encoders": {name: {"column": c, "counts_per_revolution": 200} for name, c in (("pinion", "A"), ("gear", "B"))},
        "conditions": {"pinion_torque": "60 N*m", "gear_torque": "balanced"},
    }  # fmt: skip
    content = {"system": "gear_pair", "parameters": parameters, "records": [record]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(gd.InputError, match="goes to and fro between 0 and 1: the levels of pulses, and no counts"):
        gd.load(tmp_path / "measurement.yaml")


def test_a_unit_in_another_case_is_known_by_its_letters():
    from gear_damping.units import parse_unit

    with pytest.raises(gd.InputError, match="unknown unit 'Sec'; remedy: did you mean 's'"):
        parse_unit("Sec")


def test_a_prior_of_a_gear_pair_that_its_records_contradict_is_named():
    coordinate = 0.2  # of a logarithm: 22 % above what is stated
    free = [
        FreeParameter("viscous_damping.damping_coefficient", 100.0, logarithmic=True, deviation=0.02, expected=100.0),
        FreeParameter("mesh_phase", 0.0, deviation=0.01, expected=0.0),
    ]
    stated = {"viscous_damping.damping_coefficient": "damping_ratio"}
    said = contradicted(free, [coordinate, 1.0], stated)
    assert said.startswith("damping_ratio lies 10 of its stated uncertainties away: correct its value")
    assert contradicted(free, [0.05, 1.0], stated) is None  # 2.5 of them
    assert contradicted(free, [coordinate, 1.0], {}) is None  # nobody stated it


@pytest.mark.parametrize(
    ("pinion", "gear", "is_said"), [(0.112, 0.046, True), (0.112, 0.2, False), (0.09, 0.046, False)]
)
def test_figures_of_both_shafts_that_are_each_others_are_called_exchanged(pinion, gear, is_said):
    free = [
        FreeParameter(name, stated, logarithmic=True, deviation=0.03, expected=stated)
        for name, stated in (("inertia_pinion", 0.045), ("inertia_gear", 0.11))
    ]
    found = [math.log(pinion / 0.045), math.log(gear / 0.11)]
    said = contradicted(free, found, {"inertia_pinion": "inertia_pinion", "inertia_gear": "inertia_gear"})
    assert said.startswith("inertia_pinion lies ")
    assert ("exchange the two" in said) == is_said


@pytest.mark.parametrize(
    ("column", "said", "conflicts"),
    [
        ({"column": "x_um", "unit": "mm"}, "x_um", True),
        ({"column": "x_um", "unit": "um"}, "x_um", False),
        ({"column": "x_um", "unit": "mm", "gain": 1}, "x_um", False),  # said to be the name that is wrong
        ({"column": "U1", "unit": "mV"}, "U1", False),  # a name of a voltage, and no unit
        ({"column": "v_rad", "unit": "mm"}, "v_rad", False),  # radial
    ],
)
def test_the_unit_that_a_name_ends_in_contradicts_another_of_its_kind(column, said, conflicts, tmp_path):
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": column}
    (record,) = read(tmp_path, channels, {"t": TIME, said: MOTION}).records
    assert any("is named like one in um" in one.message for one in record.findings) is conflicts


@pytest.mark.parametrize(
    ("mean", "torque", "more", "is_said"),
    [
        (-6.0, 60, {}, True),
        (-6.0, 60, {"speed": 100}, "note"),  # a third of a turn, of which an eccentricity makes a mean of its own
        (6.0, 60, {}, False),
        (6.0, -60, {}, True),
        (-6.0, -60, {}, False),
        (-6.0, 60, {"polarity": -1}, False),
        (-6.0, 60, {"datum": "arbitrary"}, False),
        (-0.4, 60, {}, False),  # it crosses zero
    ],
)
def test_a_transmission_error_lies_where_its_torque_presses(tmp_path, mean, torque, more, is_said):
    time = np.arange(4000) / 20e3
    error = mean + np.sin(2 * math.pi * 350 * time) + np.random.default_rng(2).normal(0, 0.05, time.size)
    np.savetxt(tmp_path / "a.csv", error, header="te", comments="")
    parameters = {
        "n_teeth_pinion": 21, "n_teeth_gear": 40, "module": "3 mm", "inertia_pinion": "0.001 kg*m^2",
        "inertia_gear": "0.01 kg*m^2",
    }  # fmt: skip
    speed = more.get("speed", 1000)
    error = {"column": "te", "unit": "um"} | {key: value for key, value in more.items() if key != "speed"}
    channels = {"sampling_rate": "20 kHz", "transmission_error": error}
    conditions = {"pinion_speed": f"{speed} rpm", "pinion_torque": f"{torque} N*m"}
    record = {"file": "a.csv", "channels": channels, "conditions": conditions}
    content = {"system": "gear_pair", "parameters": parameters, "records": [record]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    found = [one for one in gd.load(tmp_path / "measurement.yaml").findings if one.kind == "other_side"]
    severity = is_said if isinstance(is_said, str) else "data_problem"
    assert [one.severity for one in found] == [severity] * bool(is_said)
    assert all("write polarity: -1" in one.message for one in found)


OVER = np.arange(2000) / 100
HISS = np.random.default_rng(3).normal(0, 1, OVER.size)
MOTIONS = {
    "swings": (5 + 7 * np.exp(-0.1 * OVER) * np.cos(18 * OVER) + 0.02 * HISS, True),
    "still crosses zero": (0.5 + 7 * np.exp(-0.1 * OVER) * np.cos(18 * OVER) + 0.02 * HISS, False),
    "creeps": (5 * np.exp(-OVER / 8) + 0.05 * HISS, False),
    "creeps slowly": (5 * np.exp(-OVER / 20) + 0.02 * HISS, False),
    "sticks": (np.where(OVER < 6, 7 * np.exp(-0.6 * OVER) * np.cos(9 * OVER), 0.1) + 0.005 * HISS, False),
    "creeps and swings": (7 * np.exp(-OVER / 15) + 0.3 * np.exp(-0.05 * OVER) * np.cos(18 * OVER), False),
}


@pytest.mark.parametrize("datum", ["absolute", "arbitrary", None])
@pytest.mark.parametrize("name", MOTIONS)
def test_a_motion_that_swings_about_another_place_has_no_zero_there(tmp_path, name, datum):
    values, is_said = MOTIONS[name]
    np.savetxt(tmp_path / "a.csv", values, header="x", comments="")
    place = {"column": "x", "unit": "mm"} | ({"datum": datum} if datum else {})
    channels = {"sampling_rate": "100 Hz", "displacement": place}
    content = {"system": "oscillator", "records": [{"file": "a.csv", "channels": channels}]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    found = [one for one in gd.load(tmp_path / "measurement.yaml").findings if one.kind == "rests_elsewhere"]
    assert [one.severity for one in found] == ["note"] * (is_said and datum == "absolute")
