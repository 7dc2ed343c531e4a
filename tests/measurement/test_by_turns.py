"""Tables in which signals speak by turns: rows that hold nothing of a record are left out, where stamps tell when."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table
from gear_damping.measurement.load import load_measurement

TIME = np.arange(300) * 0.02
MOTION = np.exp(-0.2 * TIME) * np.cos(5.6 * TIME)


def declared(folder, blanks, channels, cell=""):
    """A file in which a torque speaks between the positions, at other times."""
    rows = [(t, f"{t:.4f},{x:.6f},") for t, x in zip(TIME, MOTION, strict=True)]
    rows += [(t, f"{t:.4f},{cell},3.0") for t in 0.003 + 0.033 * np.arange(blanks)]
    text = "t,x,torque\n" + "\n".join(row for _, row in sorted(rows)) + "\n"
    (folder / "can.csv").write_text(text)
    (folder / "m.yaml").write_text(f"system: oscillator\nrecords:\n  - file: can.csv\n    channels: {channels}\n")
    return folder / "m.yaml"


STAMPED = "{time: {column: t, unit: s}, displacement: {column: x, unit: mm}}"


def test_rows_of_other_signals_are_left_out(tmp_path):
    record = load_measurement(declared(tmp_path, 150, STAMPED)).records[0]
    np.testing.assert_allclose(record.time, TIME, atol=1e-9)
    np.testing.assert_allclose(record.channels["displacement"].values, MOTION, atol=1e-6)
    assert [f.message.partition(" hold")[0] for f in record.findings if f.kind == "foreign_rows"] == ["150 rows"]


def test_without_stamps_nothing_tells_when_the_others_were(tmp_path):
    with pytest.raises(InputError, match="an empty cell"):
        load_measurement(declared(tmp_path, 150, "{sampling_rate: 50 Hz, displacement: {column: x, unit: mm}}"))


def test_a_cell_that_is_no_number_is_a_fault_all_the_same(tmp_path):
    with pytest.raises(InputError, match=r"'fault'"):
        load_measurement(declared(tmp_path, 150, STAMPED, cell="fault"))


def test_a_row_in_which_one_channel_of_two_is_blank_is_a_fault(tmp_path):
    both = "{time: {column: t, unit: s}, displacement: {column: x, unit: mm}, force: {column: torque, unit: N}}"
    with pytest.raises(InputError, match="an empty cell"):
        load_measurement(declared(tmp_path, 150, both))


def by_turns(folder, names, label="id", lag=0.0, each=(1.0, 0.3, 5.0), channels=STAMPED, noise=0.0):
    """A long table: each sensor has a row at each time, or `lag` s later than the one before."""
    rng, rows = np.random.default_rng(1), []
    for t, x in zip(TIME, MOTION, strict=True):
        for k, name in enumerate(names):
            rows.append(f"{t + k * lag:.4f},{name},{each[k] * x + noise * rng.standard_normal():.6f}")
    (folder / "long.csv").write_text(f"t,{label},x\n" + "\n".join(rows) + "\n")
    (folder / "m.yaml").write_text(f"system: oscillator\nrecords:\n  - file: long.csv\n    channels: {channels}\n")
    return folder / "m.yaml"


@pytest.mark.parametrize("lag", [0.0, 0.01])
@pytest.mark.parametrize(("names", "label"), [((1, 2), "id"), ("AB", "id"), ((7, 8), "sensor"), ("AB", "what")])
def test_sensors_that_speak_by_turns_in_one_column_are_refused(names, label, lag, tmp_path):
    with pytest.raises(InputError, match=f"2 signals by turns .*column '{label}' says; remedy: give each a column of"):
        load_measurement(by_turns(tmp_path, names, label, lag))
    faults = inspect_table(read_table(tmp_path / "long.csv")).faults
    assert any(f"2 signals by turns ({names[0]}, {names[1]}), as column '{label}' says" in one for one in faults)


def test_three_sensors_at_a_declared_rate_are_refused(tmp_path):
    rate = "{sampling_rate: 150 Hz, displacement: {column: x, unit: mm}}"
    with pytest.raises(InputError, match=r"3 signals by turns \(1, 2, 3\), as column 'sensor' says"):
        load_measurement(by_turns(tmp_path, (1, 2, 3), "sensor", channels=rate))


def test_sensors_of_the_same_noise_are_told_by_their_stamps(tmp_path):
    with pytest.raises(InputError, match="2 signals by turns"):
        load_measurement(by_turns(tmp_path, (1, 2), each=(1.0, 1.0), noise=3.0))


@pytest.mark.parametrize("label", ["idx", "slot"])
def test_samples_that_are_counted_in_packets_that_share_a_stamp_are_one_signal(label, tmp_path):
    fine = np.arange(2000) * 0.01
    motion = np.exp(-0.2 * fine) * np.cos(5.6 * fine)
    rows = [f"{k // 10 * 0.1:.1f},{k % 10},{x:.6f}" for k, x in enumerate(motion)]
    (tmp_path / "a.csv").write_text(f"t,{label},x\n" + "\n".join(rows) + "\n")
    (tmp_path / "m.yaml").write_text(f"system: oscillator\nrecords:\n  - file: a.csv\n    channels: {STAMPED}\n")
    assert load_measurement(tmp_path / "m.yaml").records[0].sampling_rate == pytest.approx(100)


@pytest.mark.parametrize("label", ["slot", "toggle"])
def test_numbers_that_come_again_with_a_revolution_are_no_sensors(label, tmp_path):
    time = np.arange(400) * 0.01
    rows = [f"{t:.2f},{k % 16},{np.cos(2 * np.pi * k / 16):.6f}" for k, t in enumerate(time)]
    (tmp_path / "a.csv").write_text(f"t,{label},x\n" + "\n".join(rows) + "\n")
    (tmp_path / "m.yaml").write_text(f"system: oscillator\nrecords:\n  - file: a.csv\n    channels: {STAMPED}\n")
    assert load_measurement(tmp_path / "m.yaml").records[0].sampling_rate == pytest.approx(100)


def test_a_sensor_of_a_file_of_its_own_is_read(tmp_path):
    path = by_turns(tmp_path, (1,))
    assert inspect_table(read_table(tmp_path / "long.csv")).faults == ()
    assert load_measurement(path).records[0].sampling_rate == pytest.approx(50)
