"""What a sound measurement.yaml becomes: SI, signs, slices, time bases, units of an oscillator."""

import hashlib
from math import pi
from pathlib import Path

import numpy as np
import pytest
import yaml

from gear_damping.measurement.files import data_root
from gear_damping.measurement.load import load_measurement


def test_a_sound_gear_record_is_read_in_si(bench):
    measurement = bench.load()
    record = measurement.records[0]
    assert (measurement.system, record.name, record.role) == ("gear_pair", "run_1", "fit")
    assert record.gear_torque_mode == "balanced"
    assert measurement.findings == ()
    assert record.notes == ()
    error = record.channels["transmission_error"]
    np.testing.assert_allclose(error.values, bench.columns["dte"] * 1e-6, rtol=1e-15)
    assert (error.unit, error.declared_unit, error.declared_factor) == ("m", "um", 1e-6)
    np.testing.assert_array_equal(record.channels["pinion_torque"].values, bench.columns["T1"])
    np.testing.assert_array_equal(record.time, bench.columns["t"])
    assert record.sampling_rate == pytest.approx(20000, rel=1e-12)
    assert record.sha256 == hashlib.sha256((bench.folder / "run_1.csv").read_bytes()).hexdigest()


def test_parameters_are_converted_and_keep_their_uncertainty(bench):
    bench.content["parameters"] = {
        "module": {"value": 3, "unit": "mm"},
        "torque_gain": {"value": 1.02, "uncertainty": 0.05},
        "n_teeth_pinion": 20,
        "pressure_angle": {"value": 20, "unit": "deg"},
    }
    parameters = bench.load().parameters
    assert parameters["module"].value == pytest.approx(0.003, rel=1e-15)
    assert (parameters["torque_gain"].value, parameters["torque_gain"].uncertainty) == (1.02, 0.05)
    assert parameters["n_teeth_pinion"].value == 20
    assert parameters["pressure_angle"].value == pytest.approx(pi / 9, rel=1e-15)


def test_slice_takes_rows_a_to_b_minus_one(bench):
    bench.record["slice"] = [100, 250]
    record = bench.load().records[0]
    np.testing.assert_array_equal(record.time, bench.columns["t"][100:250])
    np.testing.assert_allclose(
        record.channels["transmission_error"].values, bench.columns["dte"][100:250] * 1e-6, rtol=1e-15
    )


def test_sampling_rate_replaces_the_time_column_and_counts_from_the_slice(bench):
    del bench.channels["time"]
    bench.channels["sampling_rate"] = {"value": 20, "unit": "kHz"}
    bench.record["slice"] = [100, 250]
    record = bench.load().records[0]
    assert record.sampling_rate == 20000
    np.testing.assert_array_equal(record.time, np.arange(100, 250) / 20000)


def test_polarity_turns_the_sign_and_sensor_keys_are_kept_in_si(bench):
    bench.channels["transmission_error"] |= {
        "polarity": -1, "lowpass": {"value": 8, "unit": "kHz"}, "highpass": {"value": 2, "unit": "Hz"},
        "coupling": "AC", "delay": {"value": 12, "unit": "us"}, "range": {"value": 0.2, "unit": "mm"},
        "noise": {"value": 50, "unit": "nm"}, "uncertainty": 0.01, "datum": "arbitrary",
    }  # fmt: skip
    channel = bench.load().records[0].channels["transmission_error"]
    np.testing.assert_allclose(channel.values, -bench.columns["dte"] * 1e-6, rtol=1e-15)
    assert (channel.lowpass, channel.highpass, channel.coupling) == (8000, 2, "AC")
    assert (channel.uncertainty, channel.polarity, channel.datum) == (0.01, -1, "arbitrary")
    assert [channel.delay, channel.range, channel.noise] == pytest.approx([12e-6, 2e-4, 5e-8], rel=1e-12)


def test_a_channel_beats_the_condition_of_its_name(bench):
    bench.record["conditions"] = {
        "pinion_speed": {"value": 1800, "unit": "rpm"},
        "pinion_torque": {"value": 149, "unit": "N*m"},
    }
    record = bench.load().records[0]
    assert set(record.conditions) == {"pinion_speed"}
    assert record.conditions["pinion_speed"].value == pytest.approx(60 * pi, rel=1e-15)
    said = [finding for finding in record.findings if finding.kind == "not_used"]
    assert [(finding.channel, finding.severity) for finding in said] == [("pinion_torque", "note")]
    assert "not the 149 N*m under conditions" in said[0].message


def test_a_wrapped_angle_is_unwrapped_and_said(bench):
    whole = bench.columns["theta1"] * 5
    bench.columns["theta1"] = np.mod(whole, 2 * pi)
    record = bench.load().records[0]
    np.testing.assert_allclose(record.channels["pinion_angle"].values, whole, atol=1e-12)
    assert record.notes == ("pinion_angle: unwrapped",)


def test_small_jitter_is_resampled_to_the_grid_and_said(bench):
    time = bench.columns["t"]
    wobble = 0.002 / 20000 * np.sin(np.arange(time.size))
    wobble[[0, -1]] = 0
    bench.columns["t"] = time + wobble
    bench.columns["dte"] = np.sin(2 * pi * 300 * bench.columns["t"])
    record = bench.load().records[0]
    np.testing.assert_allclose(record.time, time, atol=1e-15)
    truth = 1e-6 * np.sin(2 * pi * 300 * time)
    moved = np.abs(record.channels["transmission_error"].values - truth).max()
    assert moved < 1e-12 < np.abs(1e-6 * bench.columns["dte"] - truth).max()
    assert "resampled" in record.notes[0]
    assert record.uniform
    assert record.findings == ()


def test_a_channel_with_its_own_time_base_comes_to_the_record_s_time(bench):
    fast = np.arange(400) / 20000
    slow = np.arange(110) / 5000
    np.savez(
        bench.folder / "run.npz",
        t=fast,
        dte=bench.columns["dte"],
        slow=150 + np.sin(2 * pi * 50 * slow),
        ts=slow,
    )
    bench.record["file"] = "run.npz"
    del bench.channels["pinion_angle"]
    bench.record["conditions"] = {"pinion_speed": {"value": 1800, "unit": "rpm"}}
    torque = {"column": "slow", "unit": "N*m"}
    truth = 150 + np.sin(2 * pi * 50 * fast)
    for base in ({"time": {"column": "ts", "unit": "s"}}, {"sampling_rate": {"value": 5, "unit": "kHz"}}):
        bench.channels["pinion_torque"] = torque | base
        record = bench.load_as_it_is().records[0]
        np.testing.assert_allclose(record.channels["pinion_torque"].values, truth, atol=1e-4)
        assert any("5000 Hz" in note for note in record.notes)


def test_records_of_one_file_get_names_of_their_own(bench):
    bench.record["slice"] = [0, 200]
    bench.add_record(slice=[200, 400], role="holdout")
    bench.add_record(name="again")
    measurement = bench.load()
    assert [record.name for record in measurement.records] == ["run_1_1", "run_1_2", "again"]
    assert [record.name for record in measurement.with_role("holdout")] == ["run_1_2"]


def _oscillator(folder: Path, header: str, rows: np.ndarray, content: dict):
    np.savetxt(folder / "ring.csv", rows, delimiter=",", header=header, comments="", fmt="%.17g")
    path = folder / "measurement.yaml"
    path.write_text(yaml.safe_dump({"system": "oscillator", **content}, sort_keys=False))
    return load_measurement(path)


def test_an_oscillator_stays_in_its_unit_and_its_derivatives_follow(tmp_path):
    time = np.arange(64) / 1000
    rows = np.column_stack([time, np.sin(90 * time), 0.09 * np.cos(90 * time), np.cos(7 * time)])
    channels = {
        "time": {"column": 0},
        "velocity": {"column": "v", "unit": "m/s"},
        "displacement": {"column": "x (mm)"},
        "force": {"column": 3, "unit": "mV"},
    }
    gain = {"value": 2.0, "unit": "m/s^2/mV"}
    content = {"records": [{"file": "ring.csv", "channels": channels}], "parameters": {"force_gain": gain}}
    measurement = _oscillator(tmp_path, '"t (s)",x (mm),v,"F"', rows, content)
    found = measurement.records[0].channels
    assert {name: channel.unit for name, channel in found.items()} == {
        "displacement": "mm", "velocity": "mm/s", "force": "mV",
    }  # fmt: skip
    np.testing.assert_array_equal(found["displacement"].values, rows[:, 1])
    np.testing.assert_allclose(found["velocity"].values, 1e3 * rows[:, 2], rtol=1e-15)
    np.testing.assert_array_equal(found["force"].values, rows[:, 3])
    assert measurement.parameters["force_gain"].value == pytest.approx(2000.0)
    assert measurement.parameters["force_gain"].unit == "mm/s^2/mV"


def test_the_units_of_the_first_record_hold_for_all(tmp_path):
    rows = np.column_stack([np.arange(64) / 100, np.cos(np.arange(64))])
    first = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "phi", "unit": "deg"}}
    second = {**first, "displacement": {"column": "phi", "unit": "rad"}}
    records = [
        {"file": "ring.csv", "channels": first, "conditions": {"force": {"value": 2, "unit": "V"}}},
        {"file": "ring.csv", "channels": second, "conditions": {"force": {"value": 30, "unit": "mV"}}},
    ]
    measurement = _oscillator(tmp_path, "t,phi", rows, {"records": records})
    assert [record.channels["displacement"].unit for record in measurement.records] == ["deg", "deg"]
    forces = [record.conditions["force"] for record in measurement.records]
    assert [(force.value, force.unit) for force in forces] == [(2, "V"), (0.03, "V")]
    np.testing.assert_allclose(
        measurement.records[1].channels["displacement"].values, np.degrees(rows[:, 1]), rtol=1e-14
    )


def test_numbers_with_an_exponent_and_no_point_are_numbers(tmp_path):
    rows = np.column_stack([np.arange(64) / 100, np.cos(np.arange(64))])
    np.savetxt(tmp_path / "ring.csv", rows, delimiter=",", header="t,x", comments="")
    (tmp_path / "m.yaml").write_text(
        "system: oscillator\nparameters: {stiffness: {value: 1e4, unit: 1/s^2}}\nrecords:\n"
        "  - file: ring.csv\n    channels:\n      time: {column: t, unit: s}\n"
        "      displacement: {column: x, unit: V, noise: {value: 2e-3, unit: V}}\n"
    )
    measurement = load_measurement(tmp_path / "m.yaml")
    assert measurement.parameters["stiffness"].value == 1e4
    assert measurement.records[0].channels["displacement"].noise == 2e-3


def test_the_data_folder_comes_from_the_environment_or_lies_beside_the_checkout(bench, monkeypatch):
    monkeypatch.setenv("GEAR_DAMPING_DATA", str(bench.folder))
    assert data_root() == bench.folder
    bench.write_csv()
    bench.record["file"] = "${GEAR_DAMPING_DATA}/run_1.csv"
    assert bench.load_as_it_is().records[0].time.size == 400
    monkeypatch.delenv("GEAR_DAMPING_DATA")
    checkout = Path(__file__).resolve().parents[2]
    assert data_root() == checkout.parent / "shared" / "data"


def test_a_gear_torque_that_is_held_balances_the_mean_of_the_pinions(bench):
    bench.content["parameters"] |= {"n_teeth_pinion": 23, "n_teeth_gear": 41}
    bench.content["parameters"]["torque_offset"] = {"value": 2, "unit": "Nm"}
    bench.channels["gear_torque"] = "held"
    record = bench.load().records[0]
    wanted = (bench.columns["T1"].mean() + 2) * 41 / 23
    assert record.conditions["gear_torque"].value == pytest.approx(wanted, rel=1e-12)
    assert record.gear_torque_mode is None
    assert any("gear_torque: held at" in note for note in record.notes)


def test_a_gear_torque_that_is_held_needs_the_teeth(bench):
    bench.channels["gear_torque"] = "held"
    said = bench.only_problem()
    for word in ("records[0]", "gear_torque", "needs the teeth", "n_teeth_pinion, n_teeth_gear"):
        assert word in said


TURNING = """system: oscillator
records:
  - file: run.csv
    channels: {time: {column: t, unit: s}, displacement: {column: angle, unit: UNIT}}
"""


def turning(folder, degrees, unit="deg"):
    rows = "\n".join(f"{k / 1000:.3f},{angle:.6f}" for k, angle in enumerate(degrees))
    (folder / "run.csv").write_text(f"t,angle\n{rows}\n")
    (folder / "measurement.yaml").write_text(TURNING.replace("UNIT", unit))
    return load_measurement(folder / "measurement.yaml").records[0]


def test_a_deflection_that_begins_again_with_each_turn_is_unwrapped_and_said(tmp_path):
    """A scale that is a little too long, as of an encoder whose counts a turn are not those that were assumed."""
    whole = 100 + 20.0 * np.arange(200)
    record = turning(tmp_path, np.mod(whole, 360) * 1.001)
    found = record.channels["displacement"].values
    np.testing.assert_allclose(np.diff(found), 20.0, atol=0.4)
    assert record.notes == ("displacement: unwrapped",)


@pytest.mark.parametrize(("count", "unit"), [(4096, "rev, gain: 4096"), (360, "deg")])
def test_counts_that_are_declared_as_those_of_a_turn_ran_over_no_register(tmp_path, count, unit):
    """A pendulum about the zero of its encoder; the finding says what to declare, and is gone where that is done."""
    time = np.arange(2000) / 1000
    swing = np.round(0.1 * count * np.exp(-time) * np.cos(20 * time))
    assert [found.kind for found in turning(tmp_path, np.mod(swing, count), "'1'").findings if found.severity != "note"]
    record = turning(tmp_path, np.mod(swing, count), unit)
    assert "displacement: unwrapped" in record.notes
    assert not [found for found in record.findings if found.kind == "run_over"]
    one = np.ptp(swing) / np.ptp(record.channels["displacement"].values)
    assert one == pytest.approx(4096 if "rev" in unit else 1)


@pytest.mark.parametrize(
    ("degrees", "unit"),
    [
        (np.mod(100 + 20.0 * np.arange(200), 360), "mm"),  # no angle
        (200.0 * np.arange(200), "deg"),  # counted on through all turns, few samples in each
        (170.0 * np.sin(2 * np.pi * 40 * np.arange(200) / 1000), "deg"),  # a wide swing
    ],
    ids=["length", "counted on", "swing"],
)
def test_what_does_not_begin_again_stays(tmp_path, degrees, unit):
    assert not turning(tmp_path, degrees, unit).notes


def test_single_wrong_samples_of_an_angle_are_no_turns(tmp_path):
    time = np.arange(600) / 50
    angle = 0.3 * np.sin(6 * time)
    angle[[100, 250, 251, 400]] = [-0.54, 0.49, 0.45, -0.5]  # within a turn, and some more than half a turn away
    np.savez(tmp_path / "a.npz", t=time, a=angle)
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "a", "unit": "rev"}}
    content = {"system": "oscillator", "records": [{"file": "a.npz", "channels": channels}]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    (record,) = load_measurement(tmp_path / "measurement.yaml").records
    assert np.ptp(record.channels["displacement"].values) < 1.1
    assert not record.notes


def test_single_wrong_samples_are_told_and_a_blow_or_a_coarse_step_is_none(tmp_path):
    time = np.arange(3000) / 100
    swing = np.exp(-0.2 * time) * np.sin(9 * time)
    coarse = np.round(swing, 1) + 1e-6 * np.random.default_rng(0).normal(size=time.size)
    struck = np.where(time > 10, np.exp(10 - time) * np.sin(9 * (time - 10)), 0.0) + 1e-4 * swing
    wrong, flickers = swing.copy(), swing.copy()
    wrong[[700, 1500]] += 0.4
    flickers[700:706] = swing[700] + 0.4 * np.array([0, 1, 0, 1, 1, 1])  # a converter between two of its levels
    named = {
        "a": (swing, False),
        "b": (coarse, False),
        "c": (struck, False),
        "d": (wrong, True),
        "e": (flickers, False),
    }
    for name, (values, said) in named.items():
        np.savez(tmp_path / f"{name}.npz", t=time, a=values)
        channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "a", "unit": "mm"}}
        content = {"system": "oscillator", "records": [{"file": f"{name}.npz", "channels": channels}]}
        (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
        (record,) = load_measurement(tmp_path / "measurement.yaml").records
        strays = [finding for finding in record.findings if finding.kind == "stray_samples"]
        assert [finding.sample for finding in strays] == [700] * said
        assert all("at 700, 1500 (the first" in finding.message for finding in strays)


def test_single_wrong_samples_are_left_out_with_their_rows(tmp_path):
    """What the note says: the others count at their stamps."""
    time = np.arange(3000) / 100
    swing = np.exp(-0.02 * time) * np.sin(9 * time) + 1e-4 * np.random.default_rng(2).normal(size=time.size)
    kept = np.delete(np.column_stack([time, swing]), [700, 1500, 1900], axis=0)
    np.savez(tmp_path / "a.npz", t=kept[:, 0], a=kept[:, 1])
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "a", "unit": "mm"}}
    content = {"system": "oscillator", "records": [{"file": "a.npz", "channels": channels}]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    (record,) = load_measurement(tmp_path / "measurement.yaml").records
    assert [(finding.kind, finding.severity) for finding in record.findings] == [("dropped_samples", "note")]


@pytest.mark.parametrize(
    ("at", "to", "is_said"), [([700, 1500], [0, 0], True), ([700], [0], True), ([700, 1500], [40, 90], False)]
)
def test_a_speed_that_drops_out_is_told_and_one_that_a_shock_breaks_is_not(tmp_path, at, to, is_said):
    time = np.arange(3000) / 100
    speed = 900 * np.exp(-0.02 * time) + np.random.default_rng(1).normal(0, 0.2, time.size)
    speed[at] = to
    np.savez(tmp_path / "a.npz", t=time, v=speed)
    channels = {"time": {"column": "t", "unit": "s"}, "velocity": {"column": "v", "unit": "rpm"}}
    content = {"system": "oscillator", "records": [{"file": "a.npz", "channels": channels}]}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    (record,) = load_measurement(tmp_path / "measurement.yaml").records
    assert [finding.sample for finding in record.findings if finding.kind == "stray_samples"] == [700] * is_said


@pytest.mark.parametrize(
    ("first", "second", "is_said"),
    [
        ({}, {}, True),
        ({"slice": [0, 300]}, {"slice": [200, 400]}, True),
        ({"slice": [0, 200]}, {"slice": [200, 400]}, False),
        ({}, {"channel": "other"}, False),
    ],
)
def test_samples_that_are_fitted_twice_are_said(tmp_path, first, second, is_said):
    """An interval by the same samples twice is too narrow by a factor of the root of two."""
    values = np.random.default_rng(0).normal(size=(400, 2))
    rows = (f"{k / 100:g},{a:.6f},{b:.6f}" for k, (a, b) in enumerate(values))
    (tmp_path / "data.csv").write_text("t,x,other\n" + "\n".join(rows))
    records = []
    for name, said in (("a", first), ("b", second)):
        rows_of = {key: value for key, value in said.items() if key == "slice"}
        column = {"column": said.get("channel", "x"), "unit": "m"}
        channels = {"time": {"column": "t", "unit": "s"}, "displacement": column}
        records.append({"name": name, "file": "data.csv", "channels": channels, **rows_of})
    (tmp_path / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    found = load_measurement(tmp_path / "m.yaml").records[1].findings
    assert any(one.kind == "fitted_twice" for one in found) == is_said


@pytest.mark.parametrize(
    ("roles", "kinds"),
    [
        (("fit", "holdout"), ["fitted_and_held_out"]),
        (("holdout", "fit"), ["fitted_and_held_out"]),
        (("holdout", "holdout"), []),  # nothing is fitted to them
        (("fit", "fit"), ["fitted_twice"]),
    ],
)
def test_a_copy_that_judges_what_was_fitted_to_it_is_said(tmp_path, roles, kinds):
    records = []
    for name, role in zip("ab", roles, strict=True):
        values = np.random.default_rng(0).normal(size=400)  # two files of one run
        (tmp_path / f"{name}.csv").write_text("x\n" + "\n".join(f"{value:.6f}" for value in values))
        channels = {"sampling_rate": "100 Hz", "displacement": {"column": "x", "unit": "m"}}
        records.append({"name": name, "file": f"{name}.csv", "role": role, "channels": channels})
    (tmp_path / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    found = [
        one.kind
        for record in load_measurement(tmp_path / "m.yaml").records
        for one in record.findings
        if one.kind.startswith("fitted_")
    ]
    assert found == kinds


def test_a_measurement_prints_what_was_read(bench):
    text = str(bench.load()).splitlines()
    assert text[0].startswith("gear_pair, ")
    assert str(bench.folder) in text[0]
    ends = f"{bench.columns['dte'].min():.6g} to {bench.columns['dte'].max():.6g} um"
    assert f"  transmission_error: {ends}" in text
    assert any(line.startswith("run_1 (fit): ") and "at 20000 Hz" in line for line in text)
    assert max(map(len, text)) < 300
