"""Cell arrays of MATLAB that hold a table, one number to a cell."""

import numpy as np
import pytest
from scipy.io import savemat

from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.guessing import guessed

N, RATE = 300, 500.0
TIME = np.arange(N) / RATE
WAVE = 12 * np.cos(40 * TIME)
NUMBERS = np.column_stack([TIME, WAVE]).astype(object)


def _table(folder, cells):
    savemat(folder / "a.mat", {"raw": cells})
    return read_table(folder / "a.mat")


def _below(*rows):
    return np.array([*rows, *NUMBERS.tolist()], dtype=object)


def test_cells_of_numbers_are_the_columns_of_a_matrix(tmp_path):
    table = _table(tmp_path, NUMBERS)
    assert table.names == ("raw[0]", "raw[1]")
    np.testing.assert_array_equal(table.values(1), WAVE)
    assert guessed(table)[0].rate == pytest.approx(RATE)


@pytest.mark.parametrize("above", [[["t [s]", "x [mm]"]], [["t", "x"], ["s", "mm"]]])
def test_names_and_units_above_the_numbers_are_those_of_the_columns(above, tmp_path):
    table = _table(tmp_path, _below(*above))
    assert table.names == ("raw.t [s]", "raw.x [mm]")
    assert [table.unit(k) for k in (0, 1)] == ["s", "mm"]
    np.testing.assert_array_equal(table.values(table.index("raw.x [mm]", "")), WAVE)


def test_an_empty_cell_is_no_value(tmp_path):
    cells = _below(["t", "x"])
    cells[8, 1] = np.empty((0, 0))
    assert np.flatnonzero(np.isnan(_table(tmp_path, cells).values(1))).tolist() == [7]


def test_many_cells_that_are_no_table_are_told_once(tmp_path):
    cells = _below(["t", "x"])
    cells[50, 1] = "fault"
    savemat(tmp_path / "a.mat", {"raw": cells, "y": WAVE})
    table = read_table(tmp_path / "a.mat")
    assert table.names == ("y",)
    assert len(table.left_out) == 1
    assert "raw (cells of numbers and texts; in MATLAB save its columns" in table.left_out[0]
