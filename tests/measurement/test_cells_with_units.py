"""Columns none of whose cells is a plain number: units that change from cell to cell, and hexadecimal numbers."""

import pytest

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table


def said(folder, cells):
    (folder / "a.csv").write_text("t,x\n" + "".join(f"{0.01 * k:.2f},{cell}\n" for k, cell in enumerate(cells)))
    table = read_table(folder / "a.csv")
    with pytest.raises(InputError) as caught:
        table.values(1)
    return str(caught.value)


@pytest.mark.parametrize("sign", ["", " "])
@pytest.mark.parametrize(("large", "small"), [("V", "mV"), ("mm", "um"), ("left", "right")])
def test_units_that_change_are_told(tmp_path, sign, large, small):
    cells = [f"{1.5 + 0.01 * k:.2f}{sign}{large}" for k in range(40)]
    cells += [f"{987.3 - k:.1f}{sign}{small}" for k in range(40)]
    message = said(tmp_path, cells)
    rule = f"its 80 cells change what stands behind their numbers: '{large}' ({cells[0]}), '{small}' ({cells[40]})"
    assert rule in message
    assert "write all of them as plain numbers of one unit" in message


def test_one_word_behind_all_numbers_is_their_unit_as_before(tmp_path):
    message = said(tmp_path, [f"{1.5 + 0.01 * k:.2f}foo" for k in range(40)])
    assert "a number with 'foo' behind it, and none of its 40 cells is a plain one" in message


def test_a_list_of_many_is_cut(tmp_path):
    message = said(tmp_path, [f"{k} {'abcde'[k % 5]}x" for k in range(40)])
    assert "'ax' (0 ax), 'bx' (1 bx), 'cx' (2 cx) and more" in message


def test_hexadecimal_numbers_have_no_unit(tmp_path):
    message = said(tmp_path, [f"0x{10001 - 60 * k:04X}" for k in range(40)])
    assert "a hexadecimal number, and so are all of its 40 cells" in message
    assert "write them as decimal ones: 10001 for 0x2711" in message
