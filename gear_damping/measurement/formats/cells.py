"""Tables of cells, as texts and spreadsheets hold them; a cell that is no number is named with its row."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.moments import is_moment, is_told, moments_of
from gear_damping.measurement.formats.number_texts import is_absent, is_number, is_written, parts_thousands, plain
from gear_damping.measurement.formats.table import Table, is_real
from gear_damping.units import parse_unit

MOMENT = "a date or a clock in a form that is not read"
MOST_WORDS = 0.5  # of the cells of a column of numbers: with more than half words it is one of words
MOST_EMPTY = 0.3  # of the rows: where every other or third one is empty, none of them was a sample
FEWEST_BEHIND = 8  # empty cells at the end of a column, as many as a record needs: fewer are cells that were lost
SHOWN = 3  # faults of one kind that are listed one by one
MOST_BELOW = 20  # rows that may lie below a table, and more of its own
_NUMERAL = r"\s*[+-]?\.?\d[\d.,]*([eE][+-]?\d+)?"
# A unit behind a blank, or at once where it is no letter that may say milli or mega.
_WITH_UNIT = re.compile(rf"{_NUMERAL}(\s+(?P<apart>[A-Za-zµμ°%][^\s\d]*)|(?P<close>[A-Za-zµμ°][^\s\d]+|[VNs%°]))\s*")
_WITH_LETTER = re.compile(rf"{_NUMERAL}(?P<apart>\s*)(?P<behind>[^\d\s.,;+\-]\S*)\s*$")
_HEXADECIMAL = re.compile(r"\s*0[xX][\da-fA-F]+\s*$")
LISTED = 8  # columns that a message lists


def _not_a_number(cell: str) -> str:
    """What is said of a cell; a date or a clock, which many tables have for their time, is no number of seconds."""
    return MOMENT if is_told(cell) else "not a number"


def decimal_commas(path: Path, columns: Sequence[str] = ()) -> str:
    """What is noted where decimal commas were read: of a file, or of some columns beside others with points."""
    of_some = f" in {', '.join(columns[:LISTED])}, beside decimal points in others" if columns else ""
    return f"{path.name}: read with decimal commas{of_some}"


def said_of_empty_rows(empty: Sequence[int], rows: int) -> str:
    """What is noted of lines without a value among so many rows; nothing where they are how the file is printed."""
    if not empty or len(empty) > MOST_EMPTY * rows:
        return ""
    said = f"{len(empty)} empty row(s) among its values, the first in line {empty[0]}, are left out"
    return f"{said}: where each stands for a sample that was lost, cut the record there"


@dataclass(frozen=True, eq=False)
class Cells:
    """A column: (n,) numbers, or (n,) texts where not every cell is a number.

    Args:
        name: Its name in the header, "" for none.
        unit: The unit that the header gives.
        values: The cells.
        line: The line of the file that a row stands in.
        also: Other names of it, in further rows of the header.
        begins: When the first was, of a column of moments, as `Moments` has it.
    """

    name: str
    unit: str | None
    values: NDArray
    line: Callable[[int], int]
    also: tuple[str, ...] = ()
    begins: float | None = None


def without_footer(columns: Sequence[Cells]) -> tuple[list[Cells], str]:
    """Columns without the rows below a table that begin to hold words (`Min`, `Mean`), and what is noted of these."""
    rows = max((len(one.values) for one in columns), default=0)
    begins = [_first_word(one.values) for one in columns if not is_real(one.values.dtype)]
    first = min((row for row in begins if row is not None), default=rows)
    if not 0 < rows - first <= MOST_BELOW < first:
        return list(columns), ""
    below = [[str(one.values[k]) for one in columns if k < len(one.values)] for k in range(first, rows)]
    if not all(any(is_word(cell) for cell in row) for row in below):
        return list(columns), ""
    said = next(cell for cell in below[0] if is_word(cell))
    note = f"the last {rows - first} row(s), from '{said}' on (line {columns[0].line(first)}), lie below the table and "
    return [replace(one, values=one.values[:first]) for one in columns], note + "are left out"


def lone_rows(lines: Sequence[int]) -> int:
    """How many rows at the end of a table its only empty lines part from all others; 0 where they are many, or lines
    are empty elsewhere too.

    Args:
        lines: The line of each row.
    """
    apart = [k for k, (line, behind) in enumerate(pairwise(lines), 1) if behind > line + 1]
    return len(lines) - apart[0] if len(apart) == 1 and len(lines) - apart[0] < FEWEST_BEHIND else 0


def without_lone_rows(columns: Sequence[Cells], lone: int) -> tuple[list[Cells], str]:
    """Columns without the `lone` last rows, where a clock goes back at them, and what is noted of these.

    One row beside no column that rises all through is left out too: what a program puts there is a mean as well.
    """
    rows = max((len(one.values) for one in columns), default=0)
    above = rows - lone
    if not 0 < lone < FEWEST_BEHIND <= above:
        return list(columns), ""
    rising = [one.values for one in columns if _rises(one.values[:above])]
    goes_back = any(np.any(values[above:].astype(float) < values[above - 1]) for values in rising)
    if not goes_back and (rising or lone > 1):
        return list(columns), ""
    why = "where a column that rises above goes back" if goes_back else "as a mean does"
    note = f"the last {lone} row(s), behind an empty line, stand apart (line {columns[0].line(above)}), {why}, and are "
    return [replace(one, values=one.values[:above]) for one in columns], note + "left out"


def _rises(values: NDArray) -> bool:
    """Whether numbers rise from each row to the next, as a clock does, or stand where it is rounded."""
    if not is_real(values.dtype):
        return False
    steps = np.diff(values.astype(float))
    return bool(np.all(steps >= 0) and np.any(steps > 0))


def _first_word(cells: NDArray) -> int | None:
    """The row of the first of the words that a column of numbers ends in; None where it does in none, or has more."""
    words = [is_word(str(cell)) for cell in cells]
    if 2 * sum(is_written(str(cell)) for cell in cells) < len(cells):
        return None  # a column of remarks, which may stand beside the last rows alone
    count = next((k for k, is_word in enumerate(reversed(words)) if not is_word), len(words))
    return len(words) - count if 0 < count == sum(words) < len(words) else None


def _unit_of_cells(cells: NDArray) -> str:
    """The unit that stands behind the number of each of a column's texts (MATLAB: `0.005 sec`); "" without one."""
    if is_real(cells.dtype) or not cells.size or not (unit := unit_in(str(cells[0]))):
        return ""
    return unit if all(unit_in(str(cell)) == unit for cell in cells) else ""


def unit_in(cell: str) -> str:
    """The unit that stands behind a number in a cell, `0.005 sec`, `12mm` or `3 %`; "" in any other cell."""
    found = _WITH_UNIT.fullmatch(cell)
    unit = (found["apart"] or found["close"]) if found else ""
    try:
        return unit if unit and parse_unit(unit) else ""
    except InputError:
        return ""


def _with_letters(cells: Sequence[str]) -> tuple[str, str] | None:
    """What is said of cells that are no plain numbers, but hexadecimal or with something behind them; else None."""
    told = [cell for cell in cells if not is_absent(cell)]
    if told and all(map(_HEXADECIMAL.match, told)):
        rule = f"a hexadecimal number, and so are all of its {len(cells)} cells"
        return rule, f"write them as decimal ones: {int(told[0], 16)} for {told[0].strip()}"
    found = [_WITH_LETTER.match(cell) for cell in told]
    if not told or found[0] is None:
        return None
    first = {one["behind"]: cell.strip() for one, cell in reversed([*zip(found, told, strict=True)]) if one}
    if (len(first) == 1 or None in found) and found[0]["apart"]:
        return None
    if len(first) == 1 or None in found:
        rule = f"a number with '{found[0]['behind']}' behind it, and none of its {len(cells)} cells is a plain one"
        return rule, "write plain numbers in the file, and what stands behind them as the unit of the channel"
    shown = [f"'{behind}' ({first[behind]})" for behind in list(dict.fromkeys(one["behind"] for one in found))[:SHOWN]]
    more = " and more" if len(first) > SHOWN else ""
    rule = f"its {len(cells)} cells change what stands behind their numbers: {', '.join(shown)}{more}"
    return rule, "write all of them as plain numbers of one unit, converted where it is another one"


def is_word(cell: str) -> bool:
    """Whether a cell is neither empty nor a number, a date or a clock."""
    return not is_absent(cell) and not is_written(cell) and not is_told(cell)


class CellTable(Table):
    """Columns of cells that become numbers when they are asked for.

    `decimal_commas` may be in their texts; `decimal` is the decimal sign of the file, "" where that is not known.
    """

    def __init__(self, path: Path, columns: Sequence[Cells], decimal_commas: bool, decimal: str = "") -> None:
        super().__init__(path, [(one.name, (len(one.values),)) for one in columns])
        self._columns, self._commas, self._decimal = list(columns), decimal_commas, decimal
        self._read: dict[int, NDArray[np.float64]] = {}
        self._bad: dict[int, tuple[list[str], list[int]]] = {}
        self._begins = {k: one.begins for k, one in enumerate(columns) if one.begins is not None}

    def cells(self, index: int) -> NDArray:
        """(n,) the cells of a column as they stand."""
        return self._columns[index].values

    def also(self, index: int) -> tuple[str, ...]:
        """What further rows of the header say above a column."""
        return self._columns[index].also

    def unit(self, index: int) -> str | None:
        """The unit in the header of a column, or None; of dates and clocks s."""
        column = self._columns[index]
        if column.unit is None and (unit := _unit_of_cells(column.values)):
            return unit
        if is_real(column.values.dtype):
            return column.unit
        first = next((cell for cell in map(str, column.values) if not is_absent(cell)), "")
        return "s" if is_moment(first) else column.unit

    def begins(self, index: int) -> float | None:
        """When the first moment of a column of dates or clocks was."""
        self.values(index)
        return self._begins.get(index)

    def values(self, index: int) -> NDArray[np.float64]:
        """(n,) float64: a column, nan where a cell is no number; `bad_cells` tells of these.

        Raises:
            InputError: too many cells are neither numbers nor say that there is none, or none of them is a number.
        """
        if index not in self._read:
            values = self._columns[index].values
            self._read[index] = values.astype(np.float64) if is_real(values.dtype) else self._numbers(index)
        return self._read[index]

    def _numbers(self, index: int) -> NDArray[np.float64]:
        column = self._columns[index]
        texts = [str(cell) for cell in column.values]
        if (seconds := self._moments(index, texts)) is not None:
            return seconds
        unit = _unit_of_cells(column.values)
        if unit and column.unit in (None, unit):  # another than the header's is a contradiction
            texts = [cell.strip().removesuffix(unit) for cell in texts]
        cells = [plain(cell) for cell in self._decimal_points(texts, index)]
        try:
            return np.array(cells, dtype=np.float64)
        except ValueError:
            bad = [k for k, cell in enumerate(cells) if not is_number(cell)]
            told = [k for k in bad if not is_absent(cells[k])]
            if len(bad) == len(cells) or len(told) > MOST_WORDS * len(cells):
                raise InputError(self._problems(index, cells, bad)) from None
            self._bad[index] = cells, bad
            missing = set(bad)
            return np.array([np.nan if k in missing else float(cell) for k, cell in enumerate(cells)])

    def _moments(self, index: int, texts: list[str]) -> NDArray[np.float64] | None:
        """(n,) s from the first of dates or clocks, nan where a cell is empty; None of anything else."""
        told = [k for k, text in enumerate(texts) if not is_absent(text)]
        if not told or not is_moment(texts[told[0]]):
            return None
        found = moments_of([texts[k] for k in told])
        if found is None:
            return None
        self._begins[index] = found.begins
        self._bad[index] = texts, [k for k, text in enumerate(texts) if is_absent(text)]
        seconds = np.full(len(texts), np.nan)
        seconds[told] = found.seconds
        return seconds

    def bad_cells(self, index: int, first: int, stop: int) -> list[Problem]:
        """The cells of a column that are no numbers in some rows, with their lines."""
        cells, bad = self._bad.get(index, ([], []))
        return self._problems(index, cells, [k for k in bad if first <= k < stop])

    def empty_cells(self, index: int) -> list[int]:
        """The rows in which a column has a cell with nothing in it."""
        cells, bad = self._bad.get(index, ([], []))
        return [k for k in bad if not cells[k].strip()]

    def _decimal_points(self, cells: list[str], index: int) -> list[str]:
        """Cells with decimal points and thousands in one piece; points and commas of another use stay, and fail."""
        for sign in ".,":
            if parts_thousands(cells, sign, self._decimal not in ("", sign)):
                cells = self._in_one_piece(cells, sign, index)
        if not self._commas or not any("," in cell for cell in cells) or any("." in cell for cell in cells):
            return cells
        self._note(decimal_commas(self.path))
        return [cell.replace(",", ".") for cell in cells]

    def _in_one_piece(self, cells: list[str], sign: str, index: int) -> list[str]:
        first = next(cell for cell in cells if sign in cell and not is_absent(cell)).strip()
        said = f"'{self.names[index]}'" if self.names[index] else str(index)
        whole = first.replace(sign, "")
        self._note(f"{self.path.name}: in column {said} '{sign}' parts thousands, {first} is read as {whole}")
        return [cell.replace(sign, "") for cell in cells]

    def _note(self, note: str) -> None:
        self.notes = self.notes if note in self.notes else (*self.notes, note)

    def _with_numbers(self) -> str:
        """The columns that begin with numbers, as a list in a message."""
        held = [
            self.names[k] or str(k)
            for k, column in enumerate(self._columns)
            if is_real(column.values.dtype) or any(is_number(str(cell)) for cell in column.values[:SHOWN])
        ]
        return ", ".join(held[:LISTED])

    def _is_header(self, row: int) -> bool:
        """Whether all cells of a row are words, and several."""
        cells = [str(one.values[row]) for one in self._columns if row < len(one.values)]
        return len(cells) > 1 and all(is_word(cell) for cell in cells)

    def _ends_early(self, cells: list[str], bad: list[int]) -> tuple[str, None, str] | None:
        """What is said of a column whose cells are empty from some row on; None of any other."""
        first = bad[0] if bad else 0
        if len(bad) < FEWEST_BEHIND or first + len(bad) != len(cells) or any(cells[k].strip() for k in bad):
            return None
        rule = f"its cells end behind row {first - 1} of {len(cells)}"
        remedy = (
            "where it was sampled at another rate, give the channel its own time or sampling_rate; where the others "
            f"went on without it, slice: [0, {first}]"
        )
        return rule, None, remedy

    def _problems(self, index: int, cells: list[str], bad: list[int]) -> list[Problem]:
        title = f"column {index}" + (f" '{self.names[index]}'" if self.names[index] else "")
        if cells and len(bad) == len(cells) and not any(cell.strip() for cell in cells):
            rule, held = "all of its cells are empty", self._with_numbers()
            remedy = f"name another column: {held}" if held else "name another column"
            return [Problem(f"{self.path.name}, {title}", rule, None, remedy, str(self.path))]
        if len(cells) > 1 and len(bad) == len(cells) and not is_told(cells[0]):
            rule, held = f"not a number, and no other of its {len(cells)} cells is one", self._with_numbers()
            remedy = f"name another column: {held}" if held else "name another column"
            rule, remedy = _with_letters(cells) or (rule, remedy)
            return [Problem(f"{self.path.name}, {title}", rule, cells[0], remedy, str(self.path))]
        if ends := self._ends_early(cells, bad):
            return [Problem(f"{self.path.name}, {title}", *ends, str(self.path))]
        problems = []
        for k in bad[:SHOWN]:
            rule = "an empty cell" if not cells[k].strip() else _not_a_number(cells[k])
            key = f"{self.path.name}, row {k} (line {self._columns[index].line(k)}), {title}"
            remedy = "correct the cell, or leave its row out"
            if rule == MOMENT and 2 * len(bad) > len(cells):
                remedy = "give sampling_rate"
            elif rule == MOMENT:
                remedy = f"where a spreadsheet made a date of a number, {remedy}"
            if self._is_header(k):
                rule = "a row of names among the values: from here on columns may hold something else"
                remedy = "make what stands below it a file and a record of its own"
            problems.append(Problem(key, rule, cells[k], remedy, str(self.path)))
        if len(bad) > SHOWN:
            rule = f"{len(bad) - SHOWN} more cells are no numbers"
            problems.append(Problem(f"{self.path.name}, {title}", rule, None, "export the file again"))
        return problems
