"""Files and declarations as the users of a test bench write them: what was read wrongly, or answered with no cure."""

import numpy as np
import pytest
from pandas import DataFrame
from scipy.io import savemat

from gear_damping.errors import InputError
from gear_damping.interface.arguments import refuse_other
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement
from gear_damping.units import parse_unit

SECONDS = np.arange(400) * 0.002
MOTION = np.exp(-1.5 * SECONDS) * np.cos(75 * SECONDS)


def loaded(folder, header: str, channel: str, more: str = ""):
    """The record of a table of a clock and a motion under a header, declared as `channel` says."""
    rows = "\n".join(f"{t:.3f};{x:.6f}" for t, x in zip(SECONDS, MOTION, strict=True))
    (folder / "a.csv").write_text(f"t;{header}\n{rows}\n", encoding="utf-8")
    (folder / "m.yaml").write_text(
        f"system: oscillator\nrecords:\n  - file: a.csv\n    channels:\n      time: {{column: t, unit: s}}\n"
        f"      displacement: {{column: 1, {channel}}}\n{more}",
        encoding="utf-8",
    )
    return load_measurement(folder / "m.yaml").records[0]


def conflicts(record) -> list[str]:
    return [one.message for one in record.findings if one.kind == "unit_conflict"]


@pytest.mark.parametrize("declared", ["1/min", "min^-1", "min⁻¹"])
@pytest.mark.parametrize("header", ["Drehzahl [U/min]", "n_rpm"])
def test_turns_by_the_minute_contradict_no_speed_of_a_shaft_by_the_minute(bench, header, declared):
    bench.columns[header] = np.full(400, 1800.0) + np.sin(SECONDS)
    bench.channels["pinion_speed"] = {"column": header, "unit": declared}
    record = bench.load().records[0]
    assert conflicts(record) == []
    assert np.mean(record.channels["pinion_speed"].values) == pytest.approx(188.5, rel=1e-3)


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("Voltage [V] (125 mm/s/V)", "mm/s"), ("Acc (100 mV/g)", "g"), ("Acc (100 mV/g)", "m/s^2"),
        ("a [10.2 mV/m/s^2]", "m/s^2"), ("Kraft (50 N/V)", "N"), ("F (5 pC/N)", "N"),
    ],
)  # fmt: skip
def test_the_sensitivity_of_a_sensor_in_a_header_is_no_unit_of_its_column(tmp_path, header, unit):
    (said,) = conflicts(loaded(tmp_path, header, f"unit: {unit}"))
    assert "the sensitivity of a sensor" in said
    assert f"write gain: what the column holds for one {unit}, or gain: 1" in said
    assert not conflicts(loaded(tmp_path, header, f"unit: {unit}, gain: 0.1"))


@pytest.mark.parametrize(("header", "unit"), [("x [mm] (8 V/mm)", "mm"), ("U/V", "V")])
def test_what_is_no_sensitivity_or_stands_beside_the_unit_contradicts_nothing(tmp_path, header, unit):
    assert not [one for one in conflicts(loaded(tmp_path, header, f"unit: {unit}")) if "sensitivity" in one]


@pytest.mark.parametrize(
    ("unit", "quantity"), [("100 mV/g", "g"), ("mV/g", "g"), ("125 mm/s/V", "mm/s"), ("16384 LSB/g", "g")]
)
def test_a_sensitivity_that_is_given_as_unit_is_answered_with_unit_and_gain(unit, quantity):
    with pytest.raises(InputError, match="is the sensitivity of a sensor") as caught:
        parse_unit(unit)
    remedy = caught.value.problems[0].remedy
    assert remedy.startswith(f"write unit: {quantity}, and gain: what the column holds for one {quantity}")
    assert parse_unit(quantity)


@pytest.mark.parametrize(
    ("asked", "held"), [("runs(1).te", "runs[0].te"), ("runs(2).te", "runs[1].te"), ("data(:,2)", "data[1]")]
)
def test_places_of_matlab_are_answered_with_those_that_count_from_nought(tmp_path, asked, held):
    """The nearest name of runs(1).te is runs.te[1], another record."""
    runs = np.zeros(2, dtype=[("te", "O")])
    runs[:] = [(MOTION,), (2 * MOTION,)]
    savemat(tmp_path / "a.mat", {"runs": runs, "data": np.stack([SECONDS, MOTION], 1)})
    table = read_table(tmp_path / "a.mat")
    with pytest.raises(InputError) as caught:
        table.index(asked, "column")
    assert caught.value.problems[0].remedy == f"write {held}: here it counts from 0"
    factor = 2 if held == "runs[1].te" else 1
    np.testing.assert_array_equal(table.values(table.index(held, "column")), factor * MOTION)


def test_a_column_in_other_capitals_is_offered(tmp_path):
    with pytest.raises(InputError, match="did you mean 'x_mm'"):
        loaded(tmp_path, "x_mm", "unit: mm, gain: 1", "      acceleration: {column: X_MM, unit: mm/s^2}\n")


@pytest.mark.parametrize("window", [["0.1 s", "0.5 s"], ["100 ms", "500 ms"], [0.1, 0.5], ["0.1", "0.5"]])
def test_the_remedy_for_a_window_that_is_a_list_is_one(tmp_path, window):
    """Two times that have units of their own need no unit beside them, which is refused there."""
    with pytest.raises(InputError) as caught:
        loaded(tmp_path, "x", "unit: mm", f"    window: {window}\n")
    remedy = caught.value.problems[0].remedy.removeprefix("write ").partition(", or")[0]
    assert len(loaded(tmp_path, "x", "unit: mm", f"    {remedy}\n").time) == 200


def remedies(bench) -> list[str]:
    with pytest.raises(InputError) as caught:
        bench.load()
    return [one.remedy for one in caught.value.problems]


@pytest.mark.parametrize(
    ("place", "word", "remedy"),
    [
        ("parameters", "helix_angle", "leave it out, and write module and pressure_angle of the transverse plane"),
        ("parameters", "z1", "write n_teeth_pinion and n_teeth_gear"),
        ("conditions", "gear_speed", "write pinion_speed: that of the gear times n_teeth_gear over n_teeth_pinion"),
        ("conditions", "torque", "write pinion_torque, or gear_torque of the load"),
        ("channels", "te", "write transmission_error"),
        ("channels", "pinion_encoder", "write encoders beside channels"),
        ("channels", "fs", "write sampling_rate"),
        ("record", "encoding", "leave it out"),
        ("record", "rows", "write slice"),
        ("record", "date", "leave it out, or write it as a comment"),
    ],
)
def test_words_for_a_key_are_answered_with_what_they_mean(bench, place, word, remedy):
    """The nearest keys are pressure_angle, gear_torque, time, pinion_speed, conditions, role and name."""
    held = {"parameters": bench.content["parameters"], "channels": bench.channels, "record": bench.record}
    held |= {"conditions": bench.record.setdefault("conditions", {})}
    held[place][word] = 3
    (said,) = remedies(bench)
    assert said.startswith(remedy)


@pytest.mark.parametrize(("word", "role"), [("train", "fit"), ("Test", "holdout"), ("validation", "holdout")])
def test_roles_of_machine_learning_are_answered_with_those_here(bench, word, role):
    bench.record["role"] = word
    assert remedies(bench) == [f"write {role}"]


@pytest.mark.parametrize(("word", "remedy"), [("measurements", "write records"), ("name", "it is a key of records")])
def test_an_unknown_key_of_the_file_is_told_once(bench, word, remedy):
    bench.content[word] = "x"
    (said,) = remedies(bench)
    assert said.startswith(remedy)


def test_a_channel_that_is_wrong_leaves_no_demand_for_a_time_column(bench):
    """Followed, it is refused: a rate is given."""
    bench.record["channels"] = {"sampling_rate": "20 kHz", "dte": {"column": "dte", "unit": "um"}}
    assert remedies(bench) == ["write transmission_error"]


def test_a_column_or_a_value_without_its_mapping_is_answered_with_one(bench):
    bench.channels.update(time="t", transmission_error="dte", pinion_speed="1800 rpm")
    first, second, third = remedies(bench)
    assert first == "write time: {column: t, unit: s}, or its unit"
    assert second == "write transmission_error: {column: dte, unit: …}"
    assert third.startswith("write a value that was constant under conditions, and a column as pinion_speed: {column")


def test_a_column_in_the_place_of_a_value_is_answered_with_where_it_belongs(bench):
    del bench.channels["time"]
    bench.channels["sampling_rate"] = {"column": "fs", "unit": "Hz"}
    bench.record["conditions"] = {"pinion_speed": {"column": "n", "unit": "rpm"}}
    first, second = remedies(bench)
    assert "a column of stamps is time: {column" in first
    assert second.endswith("what a column holds is a channel")


@pytest.mark.parametrize(
    ("unit", "same"),
    [
        ("m s-2", "m/s^2"), ("mm.s-1", "mm/s"), ("m s^-2", "m/s^2"),
        ("IPS", "in/s"), ("CPM", "1/min"), ("millis", "ms"), ("micros", "us"), ("MSa/s", "MHz"),
    ],
)  # fmt: skip
def test_units_of_instruments_are_read(unit, same):
    assert parse_unit(unit) == parse_unit(same)


@pytest.mark.parametrize(
    ("unit", "right"),
    [
        ("KHz", "kHz"), ("Rpm", "rpm"), ("m/S2", "m/s2"), ("M/s2", "m/s2"), ("lbft", "lbf*ft"), ("ftlb", "ft*lbf"),
        ("lb*ft", "lbf*ft"), ("kgfcm", "kgf*cm"), ("mkp", "kgf*m"), ("mm pk-pk", "mm"), ("pk-pk mm", "mm"),
        ("g rms", "g"), ("um_pp", "um"), ("microstrain", "um/m"), ("giri/min", "rpm"),
        ("r.p.m.", "rpm"), ("Umdr/min", "rpm"), ("-", "1"),
    ],
)  # fmt: skip
def test_a_unit_in_other_words_is_offered_as_it_is_written_here(unit, right):
    """`g rms` was answered with gram, `mkp` with mph, `m/S2` with s, and `lbft` with lbf."""
    with pytest.raises(InputError) as caught:
        parse_unit(unit)
    assert f"'{right}'" in caught.value.problems[0].remedy
    assert parse_unit(right)


def test_of_capitals_that_say_two_units_both_are_offered():
    with pytest.raises(InputError, match="write 'nm' or 'Nm', whichever it is"):
        parse_unit("NM")


@pytest.mark.parametrize(
    "line",
    [
        "Sample Interval,1e-3,s", "Samples/s: 1000", "sps=1000", "ODR: 1000 Hz", "Messrate: 1 kHz",
        "Fréquence d'échantillonnage: 1000 Hz", "Frecuencia de muestreo: 1000 Hz", "Frequenza di campionamento: 1 kHz",
    ],
)  # fmt: skip
def test_a_rate_above_a_table_that_the_declared_one_contradicts_is_told(tmp_path, line):
    (tmp_path / "a.csv").write_text(f"{line}\nx;y\n" + "".join(f"{x:.6f};1.5\n" for x in MOTION), encoding="utf-8")
    assert read_table(tmp_path / "a.csv").stated_rate[1] == pytest.approx(1000)
    (tmp_path / "m.yaml").write_text(
        "system: oscillator\nrecords:\n  - file: a.csv\n    channels:\n      sampling_rate: 500 Hz\n"
        "      displacement: {column: x, unit: mm}\n"
    )
    (found,) = [one for one in load_measurement(tmp_path / "m.yaml").records[0].findings if "1000 Hz" in one.message]
    assert "and sampling_rate says 500 Hz" in found.message


@pytest.mark.parametrize(("gear", "told"), [(60.0, True), (-107.0, True), (107.0, False), (95.0, False)])
def test_torques_that_do_not_balance_are_told_without_inertias_too(bench, gear, told):
    bench.content["parameters"] |= {"n_teeth_pinion": 23, "n_teeth_gear": 41}
    for name in ("pinion_torque", "gear_torque", "pinion_angle"):
        del bench.channels[name]
    bench.record["conditions"] = {"pinion_speed": "300 rpm", "pinion_torque": "60 Nm", "gear_torque": f"{gear} Nm"}
    found = [one for one in bench.load().records[0].findings if one.kind == "torques_disagree"]
    assert [one.severity for one in found] == ["note"] * told


@pytest.mark.parametrize("held", [np.stack([SECONDS, MOTION], 1), {"t": SECONDS, "x": MOTION}, [SECONDS, MOTION]])
@pytest.mark.parametrize("reads", [load_measurement, refuse_other])
def test_values_in_memory_are_answered_with_how_they_become_a_file(tmp_path, reads, held):
    with pytest.raises(InputError, match=r"write values in memory to a file, np\.savez\('run\.npz'"):
        reads(held)


@pytest.mark.parametrize("reads", [load_measurement, refuse_other])
def test_a_table_of_pandas_is_answered_with_how_it_becomes_a_file(reads):
    with pytest.raises(InputError, match=r"write values in memory to a file, to_csv\('run\.csv'\)"):
        reads(DataFrame({"t": SECONDS, "x": MOTION}))


def test_one_row_in_two_is_said_so(tmp_path):
    table = enumerate(zip(SECONDS, MOTION, strict=True))
    rows = "\n".join(f"{t:.3f},{x:.6f},{x if k % 2 else ''}" for k, (t, x) in table)
    (tmp_path / "a.csv").write_text(f"t,x,y\n{rows}\n")
    taken = inspect_table(read_table(tmp_path / "a.csv")).taken
    assert taken == "one row in 2, those in which slower columns have values"


@pytest.mark.parametrize(
    ("channel", "unit", "motion"),
    [("velocity", "mm", "displacement"), ("acceleration", "mm/s", "velocity"), ("velocity", "g", "acceleration")],
)
def test_a_motion_in_a_unit_of_another_one_is_a_note(tmp_path, channel, unit, motion):
    loaded(tmp_path, "x", "unit: mm")
    text = (tmp_path / "m.yaml").read_text()
    other = f"{channel}: {{column: 1, unit: {unit}}}"
    (tmp_path / "m.yaml").write_text(text.replace("displacement: {column: 1, unit: mm}", other))
    (found,) = load_measurement(tmp_path / "m.yaml").records[0].findings
    assert (found.severity, found.channel) == ("note", channel)
    assert found.message.endswith(f"a unit of a {motion}; declare it as {motion} where it is one")


@pytest.mark.parametrize(
    ("channel", "unit"), [("velocity", "mm/s"), ("acceleration", "g"), ("velocity", "V"), ("displacement", "mm/s")]
)
def test_a_motion_in_a_unit_of_its_own_or_of_a_sensor_is_none(tmp_path, channel, unit):
    loaded(tmp_path, "x", "unit: mm")
    text = (tmp_path / "m.yaml").read_text()
    other = f"{channel}: {{column: 1, unit: {unit}}}"
    (tmp_path / "m.yaml").write_text(text.replace("displacement: {column: 1, unit: mm}", other))
    assert not load_measurement(tmp_path / "m.yaml").records[0].findings
