"""Segments of LabVIEW's files that were sampled at different rates."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.guessing import guessed
from gear_damping.measurement.inspection import inspect_table, of_columns
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.starting_yaml import starting_yaml

ROWS, STEPS = (300, 500), (0.005, 0.01)
HEAD = "LabVIEW Measurement\t\nMulti_Headings\tYes\nX_Columns\tNo\n***End_of_Header***\t\n\t\n"


def motion(steps):
    return [
        np.exp(-0.1 * step * np.arange(n)) * np.cos(9 * step * np.arange(n))
        for n, step in zip(ROWS, steps, strict=True)
    ]


def lvm(folder, steps=STEPS, second=None):
    text = HEAD
    for k, (step, values) in enumerate(zip(steps, motion(steps), strict=True)):
        own = f"Delta_X\t{step:.6f}" if second is None or not k else second
        text += f"Channels\t1\nSamples\t{values.size}\nY_Unit_Label\tmm\n{own}\n***End_of_Header***\t\n"
        text += "X_Value\tPos\tComment\n" + "".join(f"\t{x:.6f}\t\n" for x in values)
    (folder / "a.lvm").write_text(text)
    return read_table(folder / "a.lvm")


def declared(folder, channels, rows=None):
    cut = f"  slice: {list(rows)}\n" if rows else ""
    said = (
        f"system: oscillator\nrecords:\n- file: a.lvm\n{cut}  channels:\n    displacement: {{column: Pos}}\n{channels}"
    )
    (folder / "a.yaml").write_text(said)
    return load_measurement(folder / "a.yaml")


def conflicts(measurement):
    return [one.message for one in measurement.findings if one.kind == "rate_conflict"]


def test_blocks_of_other_rates_are_told_with_their_rows(tmp_path):
    table = lvm(tmp_path)
    assert [(one.first, one.stop, one.rate) for one in table.blocks] == [(0, 300, 200.0), (300, 800, 100.0)]
    assert "of other rates: rows [0, 300] (200 Hz), [300, 800] (100 Hz)" in table.notes[-1]


@pytest.mark.parametrize("second", ["Delta_X\t0.005", "Operator\tx"])
def test_blocks_of_one_rate_stay_one_table(tmp_path, second):
    table = lvm(tmp_path, second=second)
    assert (table.blocks, table.stated_rate) == ((), ("Delta_X", 200.0))


def test_a_block_whose_rate_is_not_read_is_another_one(tmp_path):
    assert [one.rate for one in lvm(tmp_path, second="Delta_X\t2 foo").blocks] == [200.0, None]


def test_a_slice_has_the_rate_of_its_own_block(tmp_path):
    lvm(tmp_path)
    assert conflicts(declared(tmp_path, "    sampling_rate: 100 Hz\n", (300, 800))) == []
    assert conflicts(declared(tmp_path, "    sampling_rate: 200 Hz\n", (0, 300))) == []
    (said,) = conflicts(declared(tmp_path, "    sampling_rate: 200 Hz\n", (300, 800)))
    assert said.startswith("'Delta_X above row 300' beside the table says 100 Hz and sampling_rate says 200 Hz")
    with pytest.raises(InputError, match="write sampling_rate: 100 Hz, as 'Delta_X above row 300' in the file says"):
        declared(tmp_path, "", (300, 800))


@pytest.mark.parametrize("channels", ["    sampling_rate: 200 Hz\n", ""])
def test_rows_of_blocks_of_other_rates_are_no_record(tmp_path, channels):
    lvm(tmp_path)
    with pytest.raises(InputError, match=r"rows 0 to 799 lie in 2 blocks.*\n?.*\[0, 300\] \(200 Hz\), \[300, 800\]"):
        declared(tmp_path, channels)


def test_the_longest_block_is_inspected_at_its_rate(tmp_path):
    found = inspect_table(lvm(tmp_path))
    assert (found.rows, found.rate) == ((300, 800), 100.0)
    assert found.taken.startswith("the longest of 2 blocks, of other rates: rows [0, 300] (200 Hz)")
    assert of_columns(found, list(found.measured)).rows == (300, 800)


def test_the_longest_block_may_have_a_rate_that_is_not_read(tmp_path):
    """It ended with an error of the program."""
    found, system, listed = guessed(lvm(tmp_path, second="Delta_X\t2 kfoo"))
    assert (found.rows, found.rate, found.unread_rate) == ((300, 800), None, "Delta_X 2 kfoo")
    assert "# the file says 'Delta_X 2 kfoo', which is not read" in starting_yaml(found, system, listed)
