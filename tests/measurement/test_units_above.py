"""Units that lines above a table say are those of its columns, and contradict another unit."""

import numpy as np
import pytest

from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.load import load_measurement

TIME = np.arange(100) / 100
ROWS = "".join(f"{t:.2f},{np.cos(9 * t):.5f},{np.sin(9 * t):.5f}\n" for t in TIME)


def units_of(folder, head, rows=ROWS):
    (folder / "a.csv").write_text(head + rows, encoding="utf-8")
    table = read_table(folder / "a.csv")
    return [table.unit(k) for k in range(len(table.names))]


@pytest.mark.parametrize(
    "head",
    [
        "s,mm,g\nTime,Disp,Acc\n", "Units: s,mm,g\nTime,Disp,Acc\n", "# Units: s mm g\nTime,Disp,Acc\n",
        "# s, mm, g\nTime,Disp,Acc\n", "Einheiten: s,mm,g\nTime,Disp,Acc\n", "[s],[mm],[g]\nTime,Disp,Acc\n",
        "Time: s\nDisp: mm\nAcc: g\nTime,Disp,Acc\n", "# time [s]\n# disp [mm]\n# acc [g]\nTime,Disp,Acc\n",
        "Time in s\nTime: in s\nDisp: left sensor (mm)\nAcc: case in g\nTime,Disp,Acc\n",
        "Channel,Unit,Range\nTime,s,\nDisp,mm,10\nAcc,g,5\n\nTime,Disp,Acc\n",
    ],
)  # fmt: skip
def test_lines_above_the_names_give_units(tmp_path, head):
    assert units_of(tmp_path, head) == ["s", "mm", "g"]


def test_a_row_of_units_before_the_names_may_be_labelled(tmp_path):
    rows = "".join(f",{row}\n" for row in ROWS.splitlines())
    assert units_of(tmp_path, "Units,s,mm,g\nName,Time,Disp,Acc\n", rows) == [None, "s", "mm", "g"]


@pytest.mark.parametrize(
    "head",
    [
        "Mode: A\nDisp: A\nTime,Disp,Acc\n", "Operator: mm\nTime,Disp,Acc\n", "Acc: raw\nTime,Disp,Acc\n",
        "Time: 12:30\nDisp: sensor 3, mm\nTime,Disp,Acc\n", "s,mm\nTime,Disp,Acc\n", "left,mm,g\nTime,Disp,Acc\n",
        "V,V,V\nTime,Disp,Acc\n", "Disp: 12 (A)\nTime,Disp,Acc\n",
    ],
)  # fmt: skip
def test_lines_that_say_something_else_give_none(tmp_path, head):
    assert units_of(tmp_path, head) == [None, None, None]


def test_what_stands_beside_the_names_goes_before_it(tmp_path):
    assert units_of(tmp_path, "Disp: um\nTime (s),Disp,Acc (g)\n") == ["s", "um", "g"]
    assert units_of(tmp_path, "Disp: um\nTime,Disp,Acc\ns,mm,g\n") == ["s", "mm", "g"]


def test_names_that_look_like_units_are_names(tmp_path):
    assert units_of(tmp_path, "t,mm,g\n") == [None, None, None]


def test_the_unit_of_a_file_is_that_of_its_only_signal(tmp_path):
    rows = "".join(f"{t:.2f},{np.cos(9 * t):.5f}\n" for t in TIME)
    assert units_of(tmp_path, "# Unit: mm\ntime,Disp\n", rows) == [None, "mm"]
    assert units_of(tmp_path, "Unit: 7\ntime,Disp\n", rows) == [None, None]
    assert units_of(tmp_path, "Unit: mm\nTime,Disp,Acc\n") == [None, None, None]


def test_they_contradict_the_unit_of_a_declaration(tmp_path):
    (tmp_path / "a.csv").write_text("s,mm,g\nTime,Disp,Acc\n" + ROWS)
    (tmp_path / "a.yaml").write_text(
        "system: oscillator\nrecords:\n- file: a.csv\n  channels:\n    time: {column: Time, unit: s}\n"
        "    displacement: {column: Disp, unit: m}\n"
    )
    (found,) = [one for one in load_measurement(tmp_path / "a.yaml").findings if one.kind == "unit_conflict"]
    assert found.message.startswith("the header of column 'Disp' says 'mm' and the YAML 'm'")


@pytest.mark.parametrize(
    "head",
    [
        "Column 1: Time [ms]\nColumn 2: Disp [um]\nColumn 3: Acc [g]\n",
        "# col0: Time [ms]\n# col1: Disp [um]\n# col2: Acc [g]\n", "# 1: Time [ms]\n# 2: Disp [um]\n# 3: Acc [g]\n",
        "Rig 7\nKanal 1 = Time [ms]\nKanal 2 = Disp [um]\nKanal 3 = Acc [g]\n\n",
    ],
)  # fmt: skip
@pytest.mark.parametrize("sign", [",", "\t", " "])
def test_columns_that_are_listed_by_number_have_these_names_and_units(tmp_path, head, sign):
    assert units_of(tmp_path, head, ROWS.replace(",", sign)) == ["ms", "um", "g"]
    table = read_table(tmp_path / "a.csv")
    assert table.names == ("Time [ms]", "Disp [um]", "Acc [g]")
    assert len(table.values(0)) == TIME.size


@pytest.mark.parametrize(
    "head",
    [
        "Channel 1: Disp [um]\nChannel 2: Acc [g]\n",  # of three columns, one of which is the time
        "1: switch on\n2: wait\n3: go\n",
    ],
)
def test_a_list_of_something_else_names_no_columns(tmp_path, head):
    assert units_of(tmp_path, head) == [None, None, None]
    assert read_table(tmp_path / "a.csv").names == ("", "", "")


def test_beside_a_row_of_names_such_a_list_gives_units_alone(tmp_path):
    listed = "Channel 1: Time [ms]\nChannel 2: Disp [um]\nChannel 3: Acc\n"
    assert units_of(tmp_path, listed + "t,x,a\n") == ["ms", "um", None]
    assert read_table(tmp_path / "a.csv").names == ("t", "x", "a")
