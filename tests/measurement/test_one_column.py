"""A table of one column: its header is one name however many words it has, and every number below is a sample."""

import numpy as np
import pytest

from gear_damping.measurement.formats.registry import read_table

MOTION = np.exp(-0.01 * np.arange(300)) * np.cos(0.3 * np.arange(300))


def table(folder, above, cells=None, ending=""):
    lines = cells or [f"{value:.6f}" for value in MOTION]
    (folder / "a.csv").write_text(above + "\n".join(lines) + "\n" + ending)
    return read_table(folder / "a.csv")


HEADS = {  # the header, its unit
    "Weg [mm]": "mm", "Weg in mm": "mm", "TE [um rms]": "um", "Kanal 1 [mm]": "mm", "C1 in V": "V", "x": None,
    "Disp (mm, LP 1kHz)": "mm", "Disp (mm; LP 1kHz)": "mm", "my first run": None, "# Weg in mm": "mm",
}  # fmt: skip


@pytest.mark.parametrize("first", ["0", "1", "0.955336"])
@pytest.mark.parametrize("head", HEADS)
def test_a_header_of_several_words_names_the_column(head, first, tmp_path):
    cells = [first, *(f"{value:.6f}" for value in MOTION[1:])]
    found = table(tmp_path, f"{head}\n", cells)
    assert found.names == (head.removeprefix("# "),)
    assert found.unit(0) == HEADS[head]
    np.testing.assert_allclose(found.values(0), [float(cell) for cell in cells])
    assert found.notes == ()


@pytest.mark.parametrize("cell", ["  {:.6f}  ", '"{:.6f}"', "{:.6f} mm", "{:.6f}mm", "{:.6e}"])
def test_numbers_may_stand_between_blanks_quotes_or_before_a_unit(cell, tmp_path):
    found = table(tmp_path, "Weg in mm\n", [cell.format(value) for value in MOTION])
    assert (found.names, found.unit(0)) == (("Weg in mm",), "mm")
    np.testing.assert_allclose(found.values(0), MOTION, atol=1e-6)


@pytest.mark.parametrize("head", ["Weg in mm", "Disp (mm; LP 1kHz)"])
def test_decimal_commas_need_no_sign_between_cells(head, tmp_path):
    found = table(tmp_path, f"{head}\n", [f"{value:.6f}".replace(".", ",") for value in MOTION])
    assert (found.names, found.unit(0)) == ((head,), "mm")
    np.testing.assert_allclose(found.values(0), MOTION, atol=1e-6)


@pytest.mark.parametrize("head", ["Weg [mm]", "Weg in mm", "x (mm)"])
@pytest.mark.parametrize("setting", ["Sample rate: 1000 Hz", "fs = 1000", "a run of today", "Trigger, 5, 3"])
def test_lines_above_the_name_are_left_out(setting, head, tmp_path):
    found = table(tmp_path, f"{setting}\n{head}\n")
    assert (found.names, found.unit(0)) == ((head,), "mm")
    np.testing.assert_allclose(found.values(0), MOTION, atol=1e-6)
    assert found.notes == ("a.csv: 1 line(s) above the values are left out",)
    assert found.stated_rate == ((setting.split(" =")[0].split(":")[0], 1000.0) if "1000" in setting else None)


def test_a_setting_alone_is_no_name(tmp_path):
    found = table(tmp_path, "fs = 1000 Hz\n")
    assert found.names == ("",)
    assert found.stated_rate == ("fs", 1000.0)
    np.testing.assert_allclose(found.values(0), MOTION, atol=1e-6)


def test_a_row_of_words_below_one_column_is_left_out(tmp_path):
    found = table(tmp_path, "Weg in mm\n", ending="Mean value 3\n")
    np.testing.assert_allclose(found.values(0), MOTION, atol=1e-6)
