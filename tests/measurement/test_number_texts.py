"""Numbers and marks as programs write them, and what lies below a table."""

import numpy as np
import pytest

from gear_damping.measurement.formats.number_texts import are_decimals_alone, is_absent, parts_thousands, plain
from gear_damping.measurement.formats.registry import read_table

RNG = np.random.default_rng(5)
COUNTS = RNG.integers(-9000, 9000, 400).tolist()


def _table(tmp_path, text, name="a.csv"):
    (tmp_path / name).write_text(text)
    return read_table(tmp_path / name)


@pytest.mark.parametrize(
    "cell",
    ["", " - ", "---", "OVL", "OL", "O.L", "+OL", "OVER", "Overflow", "OVR", "ovld", "overrange", "***", "∞", "-∞",
     "#NV", "#DIV/0!", "#NUM!", "n.a.", "n/a", "No Data", "1.#QNAN", "-1.#IND", "<NA>", "null", "error"],
)  # fmt: skip
def test_marks_say_that_there_is_no_value(cell):
    assert is_absent(cell)


@pytest.mark.parametrize("cell", ["0", "-1.5", "volt", "old", "oval", "one", "x", "1.5e3", "nano", "Min"])
def test_other_texts_do_not(cell):
    assert not is_absent(cell)


@pytest.mark.parametrize(
    ("cell", "value"),
    [
        ("1.0D-05", 1e-5),
        ("2d3", 2000),
        ("\u22123.5", -3.5),
        ("1 234.5", 1234.5),
        ("1'234.5", 1234.5),
        ("7.", 7),
        ("9.935568+00", 9.935568),
        ("-1.5-03", -1.5e-3),
        ("(0.3043)", -0.3043),
        ("0.3043-", -0.3043),
        ("- 0.3043", -0.3043),
        ("- 5", -5),
    ],
)
def test_other_writings_of_a_number_are_plain(cell, value):
    assert float(plain(cell)) == value


@pytest.mark.parametrize("sign", [".", ","])
@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_signs_that_part_thousands_are_no_decimal_signs_and_it_is_said(tmp_path, sign, delimiter):
    texts = [f"{count:,}".replace(",", sign) for count in COUNTS]
    other = {".": ",", ",": "."}[sign]
    rows = [delimiter.join([f"{k / 200:.3f}".replace(".", other), text]) for k, text in enumerate(texts)]
    table = _table(tmp_path, "\n".join([delimiter.join(["t [s]", "N"]), *rows]))
    assert table.values(1).tolist() == COUNTS
    np.testing.assert_allclose(table.values(0), np.arange(len(COUNTS)) / 200)
    assert any(f"'{sign}' parts thousands" in note for note in table.notes)


@pytest.mark.parametrize(
    "cells",
    [
        [f"{value:.3f}" for value in RNG.normal(size=300)],  # all with a decimal sign
        [f"{value:g}" for value in np.round(RNG.normal(size=300) * 5, 3)],  # zeros at their end are not written
        [f"{value:.4g}" for value in RNG.normal(size=300) * 100],
        ["0.125", "3"] * 20,  # below one
        ["1.125", "4000"] * 20,  # a thousand without the sign
    ],
)
def test_decimals_are_never_taken_for_thousands(cells):
    assert not parts_thousands(cells, ".")
    assert not parts_thousands([cell.replace(".", ",") for cell in cells], ",")


def test_a_column_of_decimal_commas_alone_is_one_column(tmp_path):
    values = np.round(RNG.normal(size=300) * 9, 4)
    text = "\n".join(f"{value:.4f}".replace(".", ",") for value in values)
    for head in ("", "Kanal 1\nmm\n", "Weg [mm]\n"):
        table = _table(tmp_path, head + text)
        assert len(table.names) == 1
        assert table.values(0).tolist() == values.tolist()
    assert table.index("Weg", "column") == 0


def test_two_columns_of_whole_numbers_stay_two():
    assert not are_decimals_alone([f"{k},{v}" for k, v in enumerate(RNG.integers(0, 1023, 300))])


def test_blanks_part_numbers_that_have_decimal_commas(tmp_path):
    table = _table(tmp_path, "\n".join(f"0,{k:03d} {k},5" for k in range(50)), "a.txt")
    assert table.values(1).tolist() == [k + 0.5 for k in range(50)]


def test_quoted_decimal_commas_are_read_between_commas(tmp_path):
    table = _table(tmp_path, "t,x\n" + "\n".join(f'"0,{k:03d}","{k},5"' for k in range(50)))
    assert table.values(1).tolist() == [k + 0.5 for k in range(50)]


@pytest.mark.parametrize("sign", ["%", "//", "#"])
def test_comments_may_stand_anywhere_and_before_the_names(tmp_path, sign):
    rows = "\n".join(f"{k}\t{2 * k}" for k in range(40))
    table = _table(tmp_path, f"{sign} t[s]\tx[mm]\n{rows}\n{sign} paused, 3 times\n40\t80\n{sign} the end\n", "a.txt")
    assert table.values(1).tolist() == [2 * k for k in range(41)]
    assert table.names == ("t[s]", "x[mm]")


def test_what_lies_below_a_table_is_no_part_of_it_and_it_is_said(tmp_path):
    rows = "\n".join(f"{k};{k},5" for k in range(50))
    table = _table(tmp_path, f"Nr;Weg\n{rows}\n\nMin;0,5\nMax;49,5\n")
    assert table.values(1).tolist() == [k + 0.5 for k in range(50)]
    assert any("the last 2 row(s), from 'Min' on (line 53)" in note for note in table.notes)
    table = _table(tmp_path, f"Nr;Weg\n{rows}\n50;OVL\n51;-\n")  # no words, but no values
    assert table.values(1).size == 52


def test_a_sheet_with_figures_below_its_table_ends_before_them(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in [("t", "x", "note"), (0, 5, "begin"), *((k, k / 2) for k in range(1, 50)), (), ("Mean", 3.5)]:
        book.active.append(row)
    book.save(tmp_path / "a.xlsx")
    table = read_table(tmp_path / "a.xlsx")
    assert table.values(1).size == 50


def test_a_fault_outside_the_rows_of_a_record_is_none(bench):
    rows = [f"{k / 100},{k % 7}" for k in range(100)]
    rows[3] = "0.03,broken"
    (bench.folder / "run.csv").write_text("t,x\n" + "\n".join(rows))
    channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "mm"}}
    bench.content = {"system": "oscillator", "records": [{"file": "run.csv", "channels": channels}]}
    assert "row 3 (line 5), column 1 'x' = 'broken': not a number" in bench.only_problem()
    bench.content["records"][0]["slice"] = [4, 100]
    assert bench.load_as_it_is().records[0].channels["displacement"].values.size == 96


@pytest.mark.parametrize("above", [["t x"], ["# run", "t x", "s mm"], ["Rate 10", "t x"]])
def test_blocks_with_a_header_each_are_one_table(tmp_path, above):
    blocks = ["\n".join([*above, *(f"{k / 10} {k + 100 * run}" for k in range(30))]) for run in range(3)]
    table = _table(tmp_path, "\n\n".join(blocks), "a.txt")
    assert table.values(1).tolist() == [k + 100 * run for run in range(3) for k in range(30)]
    assert any("2 more block(s) with a header" in note for note in table.notes)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_may_end_in_any_way(tmp_path, end):
    rows = ["t,x", *(f"{k},{2 * k}" for k in range(40)), "# the end"]
    (tmp_path / "a.csv").write_bytes(end.join(rows).encode())
    assert read_table(tmp_path / "a.csv").values(1).tolist() == [2 * k for k in range(40)]


def test_in_a_file_of_decimal_commas_a_point_before_three_digits_parts_thousands(tmp_path):
    cells = [f"{k}.{7 * k:03d}" for k in range(1, 41)]
    assert not parts_thousands(cells, ".")
    assert parts_thousands(cells, ".", other_is_decimal=True)
    assert not parts_thousands(["0.125", *cells], ".", other_is_decimal=True)
    rows = [f"{0.005 * k:.3f}".replace(".", ",") + f";{cell}" for k, cell in enumerate(cells)]
    (tmp_path / "run.csv").write_text("\n".join(["t;x", *rows]))
    table = read_table(tmp_path / "run.csv")
    assert table.values(1).tolist() == [1000 * k + 7 * k for k in range(1, 41)]
    assert any("'.' parts thousands, 1.007 is read as 1007" in note for note in table.notes)


@pytest.mark.parametrize(("delimiter", "quote"), [(",", '"'), (";", ""), ("\t", "")])
def test_in_a_file_of_decimal_points_a_comma_before_three_digits_parts_thousands(tmp_path, delimiter, quote):
    """Every value has one group; in the third column a point before three digits is a decimal one."""
    rows = [f"{0.005 * k:.3f}|{quote}{k},{7 * k:03d}{quote}|{k}.{7 * k:03d}" for k in range(1, 41)]
    (tmp_path / "run.csv").write_text("\n".join(["t|F|x", *rows]).replace("|", delimiter))
    table = read_table(tmp_path / "run.csv")
    assert table.values(1).tolist() == [1000 * k + 7 * k for k in range(1, 41)]
    assert table.values(2).tolist() == [float(f"{k}.{7 * k:03d}") for k in range(1, 41)]
    assert table.notes == ("run.csv: in column 'F' ',' parts thousands, 1,007 is read as 1007",)


def test_a_column_of_fractions_has_decimal_commas_beside_decimal_points_too(tmp_path):
    rows = [f"{0.005 * k:.3f};{k % 3},{7 * k:03d}" for k in range(1, 41)]
    (tmp_path / "run.csv").write_text("\n".join(["t;F", *rows]))
    assert read_table(tmp_path / "run.csv").values(1).tolist() == [k % 3 + 0.007 * k for k in range(1, 41)]
