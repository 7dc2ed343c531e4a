"""Tables in which signals speak by turns: rows that hold nothing of a record are left out, where stamps tell when."""

import numpy as np
import pytest

from gear_damping.errors import InputError
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
