"""Rows of numbers behind an empty line below a table, and the rate beside a stamp that goes back."""

import numpy as np
import pytest

from gear_damping.measurement.formats.registry import read_table
from gear_damping.measurement.inspection import inspect_table
from tests.measurement.bare import inspected

N, RATE = 400, 100.0
TIME = np.arange(N) / RATE
WAVE = 12 * np.cos(20 * TIME)
ROWS = [f"{t:.2f},{x:.4f}" for t, x in zip(TIME, WAVE, strict=True)]
MEANS = "0.0036,2.4905"


def _csv(folder, *below, rows=ROWS, names="t (s),x (mm)"):
    (folder / "a.csv").write_text("\n".join([names, *rows, *below]) + "\n")
    return read_table(folder / "a.csv")


@pytest.mark.parametrize("below", [("", MEANS), ("", "", "1.995,0.1", "1.16,8.4", "# end"), (",", MEANS)])
def test_numbers_behind_an_empty_line_where_the_clock_goes_back_are_no_samples(below, tmp_path):
    table = _csv(tmp_path, *below)
    found = inspect_table(table)
    assert (found.length, found.faults, found.rate) == (N, (), pytest.approx(RATE))
    assert "behind an empty line, stand apart (line 40" in " ".join(table.notes)
    assert "empty row" not in " ".join(table.notes)


def test_a_mean_below_values_without_a_clock_is_no_sample(tmp_path):
    table = _csv(tmp_path, "", "0.0036", rows=[f"{x:.4f}" for x in WAVE], names="x (mm)")
    assert table.lengths == (N,)


@pytest.mark.parametrize(
    "rows",
    [
        [*ROWS[:-1], "", ROWS[-1]],  # the clock goes on: a sample was lost, and none of these
        [*ROWS[:40], "", *ROWS[40:-1], "", MEANS],  # lines are empty elsewhere too
        [*ROWS, MEANS],
    ],
)
def test_rows_that_do_not_stand_apart_stay(rows, tmp_path):
    assert _csv(tmp_path, rows=rows).lengths[0] == len([row for row in rows if row])


def test_numbers_behind_an_empty_row_of_a_sheet_are_no_samples(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in [("t (s)", "x (mm)"), *zip(TIME.tolist(), WAVE.tolist(), strict=True), (None, None), (0.0036, 2.4905)]:
        book.active.append(row)
    book.save(tmp_path / "a.xlsx")
    table = read_table(tmp_path / "a.xlsx")
    assert table.lengths == (N, N)
    assert "stand apart (line 403)" in " ".join(table.notes)


def test_beside_a_stamp_that_goes_back_the_rate_is_that_of_the_usual_step(tmp_path):
    found = inspected(tmp_path, time=np.r_[TIME, 0.0036], x=np.r_[WAVE, 2.4905])
    assert "1 backward" in found.faults[0]
    assert found.rate == pytest.approx(RATE)
