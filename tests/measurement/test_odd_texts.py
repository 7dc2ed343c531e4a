"""Texts with a title and a note, in the brackets of MATLAB, and cells in which a unit stands behind the number."""

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table

TIME = np.arange(60) * 0.025
MOTION = 3 * np.exp(-0.2 * TIME) * np.cos(5.6 * TIME)


def table(folder, text):
    (folder / "a.txt").write_text(text)
    return read_table(folder / "a.txt")


def rows(cell="{:.3f} {:.6f} 0.5", between="\n"):
    return between.join(cell.format(t, x) for t, x in zip(TIME, MOTION, strict=True))


def test_a_title_and_a_number_of_its_own_stand_above_a_table(tmp_path):
    found = table(tmp_path, f"Schwebung\n29.2\n{rows()}\n")
    assert found.names == ("", "", "")
    np.testing.assert_allclose(found.values(0), TIME)
    assert found.notes == (
        "a.txt: 2 line(s) above the values are left out",
        "a.txt: '29.2' alone in a line below the title is taken for no value",
    )


def test_a_first_row_that_was_cut_without_a_title_is_a_fault(tmp_path):
    with pytest.raises(InputError, match="1 cells where the first line has 3"):
        table(tmp_path, f"t x y\n29.2\n{rows()}\n")


@pytest.mark.parametrize("between", [";\n", "; ", "\n", ";\r\n"])
@pytest.mark.parametrize("above", ["", "% a run of today\n\n"])
def test_numbers_in_the_brackets_of_matlab_are_a_table(above, between, tmp_path):
    found = table(tmp_path, f"{above}data =[  {rows(between=between)}];\n")
    np.testing.assert_allclose(found.values(0), TIME)
    np.testing.assert_allclose(found.values(1), MOTION, atol=1e-6)


def test_brackets_that_are_not_read_are_named(tmp_path):
    with pytest.raises(InputError, match="no rows of numbers; remedy: take out the brackets and what stands before"):
        table(tmp_path, "a = [one two\nthree four]\nb = [five six];\n")


@pytest.mark.parametrize("cell", ["{:.3f} s,{:.6f} mm", "{:.3f}s,{:.6f}mm", "{:.3f} sec;{:.6f}mm"])
@pytest.mark.parametrize("head", ["", "t{}x\n"])
def test_a_unit_behind_every_number_is_that_of_the_column(head, cell, tmp_path):
    found = table(tmp_path, head.format(";" if ";" in cell else ",") + rows(cell) + "\n")
    np.testing.assert_allclose(found.values(0), TIME)
    np.testing.assert_allclose(found.values(1), MOTION, atol=1e-6)
    assert found.unit(0) in ("s", "sec")
    assert found.unit(1) == "mm"


def test_per_cent_behind_every_number_are_a_unit(tmp_path):
    found = table(tmp_path, "t,x [%]\n" + rows("{:.3f},{:.4f}%") + "\n")
    np.testing.assert_allclose(found.values(1), MOTION, atol=1e-4)
    assert found.unit(1) == "%"


def test_a_letter_that_may_be_milli_or_metres_is_not_guessed(tmp_path):
    found = table(tmp_path, "t,x\n" + rows("{:.3f},{:.4f}m") + "\n")
    with pytest.raises(
        InputError, match=r"a number with 'm' behind it, and none of its 60 cells .* write plain numbers"
    ):
        found.values(1)
