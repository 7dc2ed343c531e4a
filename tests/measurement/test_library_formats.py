"""Workbooks, compressed text and arrays of numpy."""

import gzip
from datetime import datetime, timedelta

import numpy as np
import openpyxl
import pytest
from scipy.io import savemat

from gear_damping.errors import InputError
from gear_damping.measurement.formats.registry import read_table
from tests.measurement.stored import TIME, WAVE, values_of

# xlsx


def _workbook(path, **sheets):
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def test_xlsx_columns_are_found_by_their_header(tmp_path):
    rows = [[time, 1000 * wave] for time, wave in zip(TIME.tolist(), WAVE.tolist(), strict=True)]
    rows[40:] = [[time, None] for time, _ in rows[40:]]  # a column that ends before the other
    titled = [["Rig 3, second run"], [], ["t [s]", "Acc (mm/s^2)"], *rows]
    table = read_table(_workbook(tmp_path / "a.xlsx", Data=titled, Empty=[]))
    assert table.names == ("t [s]", "Acc (mm/s^2)")
    assert [table.unit(k) for k in range(2)] == ["s", "mm/s^2"]
    assert table.lengths == (60, 40)
    np.testing.assert_allclose(table.values(1), 1000 * WAVE[:40], rtol=1e-15)


def test_xlsx_sheets_rows_of_units_and_times(tmp_path):
    begin = datetime(2026, 1, 5, 8)
    moments = [[begin + timedelta(milliseconds=k), float(k)] for k in range(10)]
    path = _workbook(tmp_path / "a.xlsx", A=[["when", "x"], ["-", "um"], *moments], B=[["x"], [1], [2]])
    table = read_table(path)
    assert table.names == ("A/when", "A/x", "B/x")
    assert [table.unit(k) for k in range(3)] == ["s", "um", None]
    np.testing.assert_allclose(values_of(table, "A/when"), np.arange(10) / 1000, atol=1e-6)
    np.testing.assert_array_equal(values_of(table, "B/x"), [1, 2])


@pytest.mark.parametrize(("blank", "said"), [(0, "A"), (2, "C"), (None, None)])
def test_empty_columns_of_xlsx_that_numbers_leave_out_are_said(tmp_path, blank, said):
    rows = [["t", "x", "F"], *([k / 10, np.cos(k), 3.0 * k] for k in range(20))]
    apart = rows if blank is None else [[*row[:blank], None, *row[blank:]] for row in rows]
    table = read_table(_workbook(tmp_path / "a.xlsx", S=apart))
    notes = [note for note in table.notes if "are empty, and numbers of columns do not count them" in note]
    assert notes == (
        [] if said is None else [f"a.xlsx, S: columns {said} are empty, and numbers of columns do not count them"]
    )


def test_rows_above_a_table_of_xlsx_state_what_lines_of_a_text_do(tmp_path):
    """A rate, units and a sensitivity; an empty row above the names is none among the values."""
    head = [["Sampling rate [Hz]", 200], ["x", "mm"], ["Sensitivity", "100 mV/g"], [], ["x", "a"]]
    table = read_table(_workbook(tmp_path / "a.xlsx", S=[*head, *([k / 7, k % 5] for k in range(60))]))
    assert table.names == ("x", "a")
    assert table.stated_rate == ("Sampling rate", pytest.approx(200.0))
    assert [table.unit(k) for k in range(2)] == ["mm", None]
    (note,) = table.notes
    assert note.startswith("a.xlsx, S: 'Sensitivity 100 mV/g' above the table is not applied")


def test_sheets_of_other_rates_state_none(tmp_path):
    rows = [["x", "a"], *([k / 7, k % 5] for k in range(60))]
    book = {"A": [["Sampling rate [Hz]", 200], *rows], "B": [["Sampling rate [Hz]", 100], *rows]}
    assert read_table(_workbook(tmp_path / "a.xlsx", **book)).stated_rate is None


def test_formulas_of_xlsx_without_stored_values_are_said(tmp_path):
    rows = [["t", "x"], *([k, f"=A{k + 2}*2"] for k in range(9))]
    table = read_table(_workbook(tmp_path / "a.xlsx", S=rows))
    assert table.names == ("t",)
    with pytest.raises(InputError, match=r"holds t \(9\); no real numbers: x \(no values; if they are formulas, open"):
        table.index("x", "column")


def test_a_cell_of_xlsx_that_is_no_number_is_named_with_its_row(tmp_path):
    table = read_table(_workbook(tmp_path / "a.xlsx", S=[["t", "x"], [0, 1], [1, "n/a"], [2, None], [3, 4]]))
    np.testing.assert_array_equal(table.values(0), [0, 1, 2, 3])
    assert np.isnan(table.values(1)).tolist() == [False, True, True, False]
    first, second = map(str, table.bad_cells(1, 0, 4))
    assert "row 1 (line 3), column 1 'x' = 'n/a': not a number" in first
    assert "row 2 (line 4), column 1 'x' = '': an empty cell" in second
    assert table.bad_cells(1, 3, 4) == []


def test_xlsx_without_rows_or_too_large_is_refused(tmp_path):
    with pytest.raises(InputError, match="no rows"):
        read_table(_workbook(tmp_path / "a.xlsx", S=[["t", "x"]]))
    path = _workbook(tmp_path / "b.xlsx", S=[[k, k] for k in range(3000)])
    with pytest.raises(InputError, match="MB are more than"):
        read_table(path, max_bytes=path.stat().st_size + 1000)


# text


@pytest.mark.parametrize("name", ["a.gz", "a.csv.gz", "a.TXT.GZ"])
def test_text_in_gzip_is_read(tmp_path, name):
    (tmp_path / name).write_bytes(gzip.compress(b"t (s);x\n0;1,5\n1;-2\n"))
    table = read_table(tmp_path / name)
    assert table.names == ("t (s)", "x")
    assert table.values(1).tolist() == [1.5, -2]


def test_gzip_that_unpacks_to_too_much_or_is_cut_off_is_refused(tmp_path):
    packed = gzip.compress(b"0,1\n" * 100_000)
    (tmp_path / "a.gz").write_bytes(packed)
    with pytest.raises(InputError, match="MB are more than"):
        read_table(tmp_path / "a.gz", max_bytes=10_000)
    (tmp_path / "a.gz").write_bytes(packed[:-40])
    with pytest.raises(InputError, match="not a readable gzip file"):
        read_table(tmp_path / "a.gz")


def test_titles_before_a_header_and_a_row_of_units_are_understood(tmp_path):
    (tmp_path / "a.txt").write_text("Logger 7\nRate: 1000\n\nt;x;T1\ns;um;N*m\n0;1,5;2\n1;2,5;3\n")
    table = read_table(tmp_path / "a.txt")
    assert table.names == ("t", "x", "T1")
    assert [table.unit(k) for k in range(3)] == ["s", "um", "N*m"]
    assert table.values(1).tolist() == [1.5, 2.5]
    assert table.notes[0] == "a.txt: 2 line(s) above the values are left out"


def test_faults_are_named_by_their_line_below_titles_comments_and_blank_lines(tmp_path):
    text = "Logger 7\n\nt,x\n0,1\n\n# paused\n1,oops\n,,\n2,3\n"
    (tmp_path / "a.csv").write_text(text)
    table = read_table(tmp_path / "a.csv")
    assert table.values(0).tolist() == [0, 1, 2]
    assert np.isfinite(table.values(1)).tolist() == [True, False, True]
    assert "row 1 (line 7), column 1 'x' = 'oops'" in str(table.bad_cells(1, 0, 3)[0])
    assert not table.bad_cells(1, 2, 3)
    (tmp_path / "a.csv").write_text(text.replace("2,3", "2,3,4"))
    with pytest.raises(InputError, match=r"row 2 .line 9.: 3 cells where the first line has 2"):
        read_table(tmp_path / "a.csv")


def test_text_is_read_to_the_last_digit(tmp_path):
    values = np.random.default_rng(0).normal(size=2000) * 10.0 ** np.random.default_rng(1).integers(-9, 9, 2000)
    (tmp_path / "a.csv").write_text("x,on\n" + "\n".join(f"{value!r},True" for value in values.tolist()))
    table = read_table(tmp_path / "a.csv")
    np.testing.assert_array_equal(table.values(0), values)
    assert table.values(1).sum() == 2000


def test_one_array_of_numpy_is_its_columns_and_a_structured_one_its_fields(tmp_path):
    np.save(tmp_path / "a.npy", np.column_stack([np.arange(9.0), np.arange(9.0) ** 2]))
    assert read_table(tmp_path / "a.npy").values(1).tolist() == [k * k for k in range(9)]
    np.save(tmp_path / "b.npy", np.array([(1.0, 2), (3.0, 4)], dtype=[("t", float), ("x", int)]))
    table = read_table(tmp_path / "b.npy")
    assert (table.names, table.values(1).tolist()) == (("t", "x"), [2, 4])
    np.save(tmp_path / "c.npy", np.array([{}], dtype=object), allow_pickle=True)
    with pytest.raises(InputError, match="not a readable NPY file"):
        read_table(tmp_path / "c.npy")


def test_columns_are_found_by_what_people_call_them(tmp_path):

    runs = np.array([(np.arange(9.0),), (np.arange(8.0),)], dtype=[("t", object)])
    savemat(tmp_path / "a.mat", {"runs": runs})
    table = read_table(tmp_path / "a.mat")
    assert table.index("runs[1].t", "column") == table.index("runs.t[1]", "column")
    np.save(tmp_path / "a.npy", np.zeros((9, 2)))
    assert read_table(tmp_path / "a.npy").index("1", "column") == 1
    (tmp_path / "a.csv").write_text("Weg [mm],Weg (2)\n1,2\n")
    assert read_table(tmp_path / "a.csv").index("Weg", "column") == 0


def test_settings_that_are_wider_than_the_values_leave_a_sheet_its_names(tmp_path):
    book = openpyxl.Workbook()
    rows = [["Speed", 1200, "rpm"], ["x", "F"], ["mm", "N"], *([k / 7, k % 5] for k in range(150))]
    for row in rows:
        book.active.append(row)
    book.save(tmp_path / "a.xlsx")
    table = read_table(tmp_path / "a.xlsx")
    assert table.names == ("x", "F")
    assert [table.unit(k) for k in range(2)] == ["mm", "N"]
