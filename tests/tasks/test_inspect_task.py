"""task=inspect on a file of every format, on a measurement.yaml, and on what cannot be read."""

import gzip
import json
import re
from pathlib import Path

import h5py
import numpy as np
import openpyxl
import pytest
import pyuff
import yaml
from nptdms import ChannelObject, RootObject, TdmsWriter
from scipy.io import savemat, wavfile

from gear_damping.errors import InputError
from gear_damping.measurement.load import check_declaration, load_measurement
from gear_damping.tasks.command import main

RATE = 500.0
TIME = np.arange(1000) / RATE
ANGLE = 0.4 * np.exp(-0.3 * TIME) * np.cos(2 * np.pi * 3 * TIME) + 0.1
TORQUE = 2.0 * np.sin(2 * np.pi * 7 * TIME)


def _csv(path, opener=open):
    with opener(path, "wt", encoding="utf-8") as file:
        file.write("time (s),angle (rad),torque (N*m)\n")
        np.savetxt(file, np.column_stack([TIME, ANGLE, TORQUE]), delimiter=",", fmt="%.9g")


def _xlsx(path):
    book = openpyxl.Workbook()
    book.active.append(["time (s)", "angle (rad)", "torque (N*m)"])
    for row in zip(TIME.tolist(), ANGLE.tolist(), TORQUE.tolist(), strict=True):
        book.active.append(row)
    book.save(path)


def _hdf5(path):
    with h5py.File(path, "w") as file:
        for name, values, unit in (("time", TIME, "s"), ("angle", ANGLE, "rad"), ("torque", TORQUE, "N*m")):
            file[f"run/{name}"] = values
            file[f"run/{name}"].attrs["unit"] = unit


def _tdms(path):
    with TdmsWriter(path) as file:
        waveform = {"wf_increment": 1 / RATE, "wf_samples": len(TIME), "wf_start_offset": 0.0}
        channels = [
            ChannelObject("run", name, values, {**waveform, "unit_string": unit})
            for name, values, unit in (("angle", ANGLE, "rad"), ("torque", TORQUE, "N*m"))
        ]
        file.write_segment([RootObject(), *channels])


def _uff(path):
    sets = [
        pyuff.prepare_58(
            func_type=1, rsp_node=1, rsp_dir=1, ref_node=1, ref_dir=1, abscissa_spec_data_type=17,
            ordinate_spec_data_type=12, orddenom_spec_data_type=0, id1=name, binary=0, abscissa_spacing=1,
            data=values, x=TIME, ordinate_axis_units_lab=unit, abscissa_axis_units_lab="s",
        )
        for name, values, unit in (("angle", ANGLE, "rad"), ("torque", TORQUE, "N*m"))
    ]  # fmt: skip
    pyuff.UFF(str(path)).write_sets(sets, "add")


def _wav(path):
    wavfile.write(path, int(RATE), np.column_stack([ANGLE, TORQUE / 3]).astype(np.float32))


WRITERS = {
    "run.csv": _csv,
    "run.csv.gz": lambda path: _csv(path, gzip.open),
    "run.xlsx": _xlsx,
    "run.h5": _hdf5,
    "run.tdms": _tdms,
    "run.uff": _uff,
    "run.wav": _wav,
    "run.mat": lambda path: savemat(path, {"time": TIME, "angle": ANGLE, "torque": TORQUE, "gain": 2.5}),
    "run.npz": lambda path: np.savez(path, time=TIME, angle=ANGLE, torque=TORQUE),
}


def inspected(path, folder):
    """The exit code and what the run left."""
    code = main(["task=inspect", f"measurement.path={path}", f"hydra.run.dir={folder}"])
    return code, json.loads((folder / "run.json").read_text())


@pytest.mark.parametrize("name", WRITERS)
def test_a_bare_file_of_every_format_is_told_drawn_and_declared(name, tmp_path):
    WRITERS[name](tmp_path / name)
    code, left = inspected(tmp_path / name, tmp_path / "out")
    assert code == 0
    assert left["status"] == "finished"
    assert str(tmp_path / name) in left["inputs"]
    assert left["metrics"]["sampling_rate"] == pytest.approx(RATE, rel=1e-6)
    assert (tmp_path / "out" / "inspection.png").stat().st_size > 10_000
    text = (tmp_path / "out" / "inspection.txt").read_text()
    assert "500 Hz" in text
    assert "strongest at 3" in text
    start = tmp_path / "out" / "measurement.yaml"
    filled = start.read_text().replace('unit: "???"', "unit: rad")
    if name == "run.wav":  # which has neither names nor units
        start.write_text(filled)
    assert '"???"' not in start.read_text()  # everything else was guessed, or stood in the file
    record = load_measurement(start).records[0]
    assert record.sampling_rate == pytest.approx(RATE, rel=1e-6)
    np.testing.assert_allclose(record.channels["displacement"].values, ANGLE, atol=1e-6)
    if name != "run.wav":
        assert set(record.channels) == {"displacement", "force"}
        assert record.channels["force"].declared_unit == "N*m"
        assert record.channels["displacement"].declared_unit == "rad"


def test_of_what_coasts_down_no_strongest_frequency_is_told(tmp_path):
    speed = 300 * np.exp(-TIME) + 0.1 * np.random.default_rng(2).normal(size=TIME.size)
    np.savetxt(
        tmp_path / "coast.csv", np.column_stack([TIME, speed]), delimiter=",", header="t [s],n [rpm]", comments=""
    )
    assert inspected(tmp_path / "coast.csv", tmp_path / "out")[0] == 0
    text = (tmp_path / "out" / "inspection.txt").read_text()
    assert "(floor of the spectrum)" in text
    assert "strongest" not in text


def test_the_start_of_a_file_that_says_nothing_asks_for_what_is_missing(tmp_path):
    np.savetxt(tmp_path / "bare.txt", np.column_stack([ANGLE, TORQUE]))
    code, left = inspected(tmp_path / "bare.txt", tmp_path / "out")
    assert (code, left["metrics"]["sampling_rate"], left["metrics"]["open"]) == (0, None, 3)
    start = tmp_path / "out" / "measurement.yaml"
    text = start.read_text()
    assert "# nothing in the file says it" in text
    with pytest.raises(InputError, match=r"sampling_rate\.value: .* not filled in yet") as error:
        load_measurement(start)
    assert len(error.value.problems) == 3
    start.write_text(text.replace('{value: "???", unit: Hz}', "{value: 500, unit: Hz}").replace('"???"', "V"))
    record = load_measurement(start).records[0]
    assert record.sampling_rate == RATE
    np.testing.assert_allclose(record.channels["displacement"].values, ANGLE)
    np.testing.assert_allclose(record.channels["force"].values, TORQUE)


def test_a_yaml_that_was_begun_is_not_written_over(tmp_path, caplog, capsys):
    _csv(tmp_path / "run.csv")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "measurement.yaml").write_text("mine\n")
    assert main(["task=inspect", f"measurement.path={tmp_path / 'run.csv'}", f"hydra.run.dir={tmp_path / 'out'}"]) == 1
    assert not (tmp_path / "out" / "run.json").exists()
    assert "holds a measurement.yaml already; remedy: " in caplog.text + capsys.readouterr().err
    assert (tmp_path / "out" / "measurement.yaml").read_text() == "mine\n"
    assert not (tmp_path / "out" / "inspection.png").exists()


def test_a_yaml_is_told_with_roles_channels_rates_conditions_findings_and_segments(tmp_path):
    _csv(tmp_path / "run.csv")
    channels = {
        "time": {"column": "time (s)"},
        "displacement": {"column": "angle (rad)", "range": {"value": 0.2, "unit": "rad"}},
    }
    records = [
        {"name": "a", "file": "run.csv", "role": "fit", "slice": [0, 600], "channels": channels,
         "conditions": {"force": {"value": 3, "unit": "N*m"}}},
        {"name": "b", "file": "run.csv", "role": "holdout", "slice": [600, 1000], "channels": channels,
         "conditions": {"force": {"value": 4, "unit": "N*m"}}},
    ]  # fmt: skip
    content = {"system": "oscillator", "segments": {"value": 0.5, "unit": "s"}, "records": records}
    content["parameters"] = {"stiffness": {"value": 355, "unit": "1/s^2", "uncertainty": 0.02}}
    path = tmp_path / "measurement.yaml"
    path.write_text(yaml.safe_dump(content))
    before = path.read_bytes()
    code, left = inspected(path, tmp_path / "out")
    assert (code, left["metrics"]) == (0, {"system": "oscillator", "records": 2, "data_problems": 2})
    assert str(tmp_path / "run.csv") in left["inputs"]
    text = (tmp_path / "out" / "inspection.txt").read_text()
    for words in (
        "measurement.yaml: oscillator, 2 records", "stiffness: 355 1/s^2 ± 2 %", "fitted: a", "held out: b",
        "segments of exactly 0.5 s", "record 'a', fit: run.csv, 600 samples, 500 Hz, 1.198 s from 0 s on",
        "force: constant, 3 N*m", "displacement: ", "rad, offset (mean)", "datum arbitrary", "data problem: clipped: ",
        "natural frequency, by these: 2.999 Hz",
    ):  # fmt: skip
        assert words in text
    assert path.read_bytes() == before
    assert (tmp_path / "out" / "inspection.png").exists()
    assert not (tmp_path / "out" / "measurement.yaml").exists()


def test_what_has_no_unit_is_told_without_one(tmp_path):
    _csv(tmp_path / "run.csv")
    channels = {"displacement": {"column": "angle (rad)"}, "force": {"column": "torque (N*m)", "unit": "1"}}
    records = [{"file": "run.csv", "channels": {"time": {"column": "time (s)"}, **channels}}]
    (tmp_path / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    inspected(tmp_path / "m.yaml", tmp_path / "out")
    assert "force: -2 to 2, offset (mean)" in (tmp_path / "out" / "inspection.txt").read_text()


@pytest.mark.parametrize(
    ("stiffness", "channel", "drifts"),
    [(0, "displacement", True), (0, "velocity", False), (350, "displacement", False)],
)
def test_a_displacement_that_no_spring_holds_is_advised_to_be_cut(tmp_path, stiffness, channel, drifts):
    _csv(tmp_path / "run.csv")
    channels = {"time": {"column": "time (s)"}, channel: {"column": "angle (rad)", "unit": "rad"}}
    content = {"system": "oscillator", "records": [{"file": "run.csv", "channels": channels}]}
    content["parameters"] = {"stiffness": {"value": stiffness, "unit": "1/s^2"}}
    (tmp_path / "m.yaml").write_text(yaml.safe_dump(content))
    inspected(tmp_path / "m.yaml", tmp_path / "out")
    text = (tmp_path / "out" / "inspection.txt").read_text()
    assert ("without a spring a displacement drifts away from any simulation: segments: {value" in text) == drifts


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("run.mat", b"MATLAB 5.0 and nothing else", "run.mat"),
        ("run.h5", b"\x89HDF\r\n\x1a\n and nothing else", "run.h5"),
        ("run.csv", b"", "the file is empty"),
        ("run.csv", b"a,b\nx,y\n", "a header and no rows of numbers"),
        ("run.bin", b"123", "unknown format '.bin'"),
        ("measurement.yaml", b"", "must be a mapping with keys among"),
        ("measurement.yaml", b"system: oscillator\nrecords:\n- {file: no.csv, channels: {displacement: {column: x}}}\n",
         "no such file"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_ends_in_one_message(name, content, words, tmp_path, caplog, capsys):
    (tmp_path / name).write_bytes(content)
    assert main(["task=inspect", f"measurement.path={tmp_path / name}", f"hydra.run.dir={tmp_path / 'out'}"]) == 1
    said = caplog.text + capsys.readouterr().err
    assert said.count("This cannot run") == 1
    assert words in said
    assert "remedy: " in said
    assert "Traceback" not in said


def test_no_such_file_and_a_wrong_simulator_are_said(tmp_path, caplog, capsys):
    missing = f"measurement.path={tmp_path / 'no.csv'}"
    assert main(["task=inspect", missing]) == 1
    assert "no such file; remedy: give the path of a measurement.yaml or of a file of data" in caplog.text
    _csv(tmp_path / "run.csv")
    place = [f"measurement.path={tmp_path / 'run.csv'}", f"hydra.run.dir={tmp_path / 'out'}"]
    assert main(["task=inspect", *place, "simulator.stifness=3"]) == 1
    assert "simulator.stifness = '3': has no effect in task=inspect" in caplog.text
    assert main(["task=inspect", *place, "simulator=oscillator"]) == 1
    assert "simulator = 'oscillator': has no effect in task=inspect" in caplog.text + capsys.readouterr().err


@pytest.mark.parametrize(
    ("turns", "said"),
    [(12 * TIME, "23.97 turns, on average 719.9"), (3 * TIME**2, " rpm, its tenths between 36")],
)
def test_the_guess_of_a_gear_file_passes_the_check_where_the_blanks_are_filled(turns, said, tmp_path):
    shaft = np.unwrap(2 * np.pi * turns + 0.01 * np.sin(40 * TIME))
    rng = np.random.default_rng(3)
    columns = {
        "t": TIME,
        "theta1 (rad)": np.mod(shaft, 2 * np.pi),
        "dte (um)": 8 + np.sin(300 * TIME) + 0.01 * rng.normal(size=TIME.size),
        "T1 (N*m)": 150 + np.sin(40 * TIME),
    }
    np.savetxt(
        tmp_path / "g.csv", np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns),
        comments="", fmt="%.12g",
    )  # fmt: skip
    code, left = inspected(tmp_path / "g.csv", tmp_path / "out")
    assert (code, left["metrics"]["system"], left["metrics"]["open"]) == (0, "gear_pair", 0)
    record = load_measurement(tmp_path / "out" / "measurement.yaml").records[0]
    assert set(record.channels) == {"pinion_angle", "transmission_error", "pinion_torque"}
    assert record.gear_torque_mode == "balanced"
    assert record.findings == ()
    inspected(tmp_path / "out" / "measurement.yaml", tmp_path / "checked")
    found = json.loads((tmp_path / "checked" / "inspection.json").read_text())
    told = dict(found["records"][0]["channels"])["pinion_angle"]
    assert said in told
    assert ("tenths" in said) == ("tenths" in told)


def test_two_counters_a_tacho_and_a_casing_are_declared(tmp_path):
    turns = 12 * TIME
    columns = {
        "time": TIME,
        "enc_pinion": np.floor(2048 * turns),
        "enc_gear": np.floor(2048 * turns / 2),
        "case_mps2": np.random.default_rng(1).normal(size=TIME.size),
    }
    for name, kept in (("counts.csv", list(columns)), ("casing.csv", ["time", "tacho", "case_mps2"])):
        columns["tacho"] = 5.0 * (np.mod(turns, 1) < 0.3)
        table = np.column_stack([columns[key] for key in kept])
        np.savetxt(tmp_path / name, table, delimiter=",", header=",".join(kept), comments="", fmt="%.9g")
        code, _ = inspected(tmp_path / name, tmp_path / name.split(".")[0])
        assert code == 0
    blanks = {
        r'(_per_revolution: )"\?\?\?"': r"\g<1>2048", r'(n_teeth_\w+: {value: )"\?\?\?"': r"\g<1>20",
        r'(module: {value: )"\?\?\?"': r"\g<1>3", r'(pressure_angle: {value: )"\?\?\?"': r"\g<1>20",
        r'({value: )"\?\?\?"(, unit: N)': r"\g<1>100\2",
    }  # fmt: skip
    for name, expected in (("counts", {"pinion", "gear"}), ("casing", {"tacho"})):
        path = tmp_path / name / "measurement.yaml"
        text = path.read_text()
        for blank, value in blanks.items():
            text = re.sub(blank, value, text)
        path.write_text(text)
        plan = check_declaration(path)
        assert {encoder.name for encoder in plan.records[0].encoders} == expected
    assert [channel.name for channel in plan.records[0].channels] == ["acceleration"]
    assert isinstance(load_measurement(path).source, Path)


def test_what_the_steps_of_two_encoders_divide_by_is_told_as_no_step(tmp_path):
    counts = np.column_stack([np.floor(2048 * 12 * TIME), np.floor(1024 * 6 * TIME)])
    np.savetxt(tmp_path / "run.csv", counts, delimiter=",", header="p,g", comments="", fmt="%d")
    encoders = {"pinion": {"column": "p", "counts_per_revolution": 2048}}
    encoders["gear"] = {"column": "g", "counts_per_revolution": 1024}
    conditions = {"pinion_torque": "100 Nm", "gear_torque": "balanced"}
    record = {"name": "run", "file": "run.csv", "encoders": encoders, "conditions": conditions}
    record["channels"] = {"sampling_rate": f"{RATE} Hz"}
    parameters = {"n_teeth_pinion": 20, "n_teeth_gear": 40, "module": "3 mm", "pressure_angle": "20 deg"}
    parameters |= {"inertia_pinion": "1e-3 kg*m^2", "inertia_gear": "5e-3 kg*m^2"}
    declared = {"system": "gear_pair", "parameters": parameters, "records": [record]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(declared))
    code, _ = inspected(tmp_path / "measurement.yaml", tmp_path / "out")
    assert code == 0
    said = dict(json.loads((tmp_path / "out" / "inspection.json").read_text())["records"][0]["channels"])
    assert "noise" in said["transmission_error"]
    assert "rounding" not in said["transmission_error"]
    assert "n_teeth_pinion: 20\n" in (tmp_path / "out" / "inspection.txt").read_text()


@pytest.mark.parametrize(("roles", "is_said"), [(["fit", "fit"], True), (["fit", "holdout"], False)])
def test_that_a_part_of_each_is_held_out_is_said_where_none_is(tmp_path, roles, is_said):
    random, channels, records = np.random.default_rng(1), {"displacement": {"column": "x", "unit": "mm"}}, []
    for number, role in enumerate(roles):
        noisy = np.exp(-3 * TIME) * np.cos(200 * TIME) + random.normal(0, 1e-3, TIME.size)
        np.savetxt(tmp_path / f"{number}.csv", noisy, header="x", comments="", fmt="%.6g")
        records.append({"role": role, "file": f"{number}.csv", "sampling_rate": f"{RATE} Hz", "channels": channels})
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    code, _ = inspected(tmp_path / "measurement.yaml", tmp_path / "out")
    assert code == 0
    text = (tmp_path / "out" / "inspection.txt").read_text()
    assert ("none is held out: task=explain holds out a part of each by itself" in text) == is_said


def test_of_a_casing_no_holding_out_is_promised(tmp_path):
    columns = np.column_stack([np.random.default_rng(1).normal(size=TIME.size), np.mod(12 * TIME, 1) < 0.3])
    np.savetxt(tmp_path / "run.csv", columns, delimiter=",", header="a,tacho", comments="", fmt="%.6g")
    tacho = {"tacho": {"column": "tacho", "pulses_per_revolution": 1}}
    record = {"file": "run.csv", "sampling_rate": f"{RATE} Hz", "encoders": tacho}
    record["channels"] = {"acceleration": {"column": "a", "unit": "g"}}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump({"system": "gear_pair", "records": [record]}))
    code, _ = inspected(tmp_path / "measurement.yaml", tmp_path / "out")
    assert code == 0
    text = (tmp_path / "out" / "inspection.txt").read_text()
    assert "role not said: run; task=explain looks into all of them" in text
    assert "holds out" not in text


def told(path, out):
    assert main(["task=inspect", f"measurement.path={path}", f"hydra.run.dir={out}"]) == 0
    return (out / "inspection.txt").read_text()


@pytest.mark.parametrize(
    ("above", "said"),
    [
        ("", "no column looks like time stamps, and no rate is read from the file"),
        ("Sample rate: 2 kfoo", "and what the file says, 'Sample rate: 2 kfoo', is not read: write what it means, "
         "sampling_rate: 2 kHz"),
    ],
)  # fmt: skip
def test_a_rate_that_the_file_says_and_is_not_read_is_told(above, said, tmp_path):
    rows = "\n".join(f"{one:.5f},{two:.5f}" for one, two in zip(ANGLE, TORQUE, strict=True))
    (tmp_path / "run.csv").write_text(f"{above}\n\nangle [rad],torque [N*m]\n{rows}\n".lstrip())
    assert said in told(tmp_path / "run.csv", tmp_path / "out")


def test_a_command_that_switches_has_levels_and_no_rounding(tmp_path):
    np.savez(tmp_path / "a.npz", t=TIME, u=6.0 * (TIME < 1), x=np.round(np.cos(20 * TIME), 1))
    said = told(tmp_path / "a.npz", tmp_path / "out")
    assert "switches between 2 levels" in said
    assert "steps of 6" not in said
    assert "steps of 0.1, whose rounding makes 0.029" in said


def test_of_arrays_of_other_lengths_the_shortest_and_the_longest_are_said(tmp_path):
    np.savez(tmp_path / "a.npz", x=TIME**2, y=TIME[:300] ** 3, z=np.array([4.0]))
    assert told(tmp_path / "a.npz", tmp_path / "out").startswith("a.npz: 3 columns in 3 arrays, 1 to 1000 rows")


def test_what_belongs_to_further_records_counts_for_no_length(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for group in ("run1", "run2"):
            file[f"{group}/pos"] = TIME**2
    assert told(tmp_path / "a.h5", tmp_path / "out").startswith("a.h5: 2 columns in 2 arrays, 1000 rows")


def test_of_much_that_is_no_number_some_is_named(tmp_path):
    np.savez(tmp_path / "a.npz", x=TIME**2, **{f"word{k}": np.array(["a", "b"]) for k in range(30)})
    said = told(tmp_path / "a.npz", tmp_path / "out")
    assert "word19 (text), and 10 more" in said
    assert "word20" not in said


def test_a_mean_that_was_taken_out_is_no_number_of_rounding(tmp_path):
    values = 3.0 + np.sin(0.37 * np.arange(4000))
    np.savez(tmp_path / "run.npz", t=np.arange(4000) / 1e3, x=values - values.mean())
    inspected(tmp_path / "run.npz", tmp_path / "out")
    assert "offset (mean) 0\n" in (tmp_path / "out" / "inspection.txt").read_text()
