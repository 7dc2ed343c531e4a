"""Text tables: comma, semicolon, tab or blanks, decimal point or comma, with or without a header."""

import csv
import io
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.table import Table, refuse_size

_HEADER_UNIT = re.compile(r"[(\[]([^()\[\]]+)[)\]]\s*$")
MAX_TEXT_BYTES = 128 * 1024**2  # as cells in memory a text takes about ten times its size
_SHOWN = 3  # faults of one kind that are listed one by one


class CsvTable(Table):
    """A text table whose columns become numbers when they are asked for."""

    def __init__(
        self, path: Path, names: tuple[str, ...], rows: list[list[str]], lines: list[int], delimiter: str
    ) -> None:
        super().__init__(path, names)
        self._rows, self._lines, self._delimiter = rows, lines, delimiter
        self._read: dict[int, NDArray[np.float64]] = {}

    def unit(self, index: int) -> str | None:
        """The unit in brackets at the end of the header, as in `Acc DE (m/s^2)`."""
        found = _HEADER_UNIT.search(self.names[index])
        return found[1].strip() if found else None

    def values(self, index: int) -> NDArray[np.float64]:
        """(n,) float64: a column; raises InputError naming the row of each cell that is no number."""
        if index not in self._read:
            cells = self._decimal_points([row[index] for row in self._rows])
            try:
                self._read[index] = np.array(cells, dtype=np.float64)
            except ValueError:
                raise InputError(self._bad_cells(index, cells)) from None
        return self._read[index]

    def _decimal_points(self, cells: list[str]) -> list[str]:
        """Cells with decimal points; where a column has points and commas the commas stay, and fail."""
        commas = self._delimiter != "," and any("," in cell for cell in cells)
        if not commas or any("." in cell for cell in cells):
            return cells
        note = f"{self.path.name}: read with decimal commas"
        self.notes = self.notes if note in self.notes else (*self.notes, note)
        return [cell.replace(",", ".") for cell in cells]

    def _bad_cells(self, index: int, cells: list[str]) -> list[Problem]:
        bad = [k for k, cell in enumerate(cells) if not _is_number(cell)]
        title = f"column {index}" + (f" '{self.names[index]}'" if self.names[index] else "")
        problems = []
        for k in bad[:_SHOWN]:
            rule = "an empty cell" if not cells[k].strip() else "not a number"
            key = f"{self.path.name}, row {k} (line {self._lines[k]}), {title}"
            remedy = "correct the cell, or leave its row out"
            problems.append(Problem(key, rule, cells[k], remedy, str(self.path)))
        if len(bad) > _SHOWN:
            rule = f"{len(bad) - _SHOWN} more cells are no numbers"
            problems.append(Problem(f"{self.path.name}, {title}", rule, None, "export the file again"))
        return problems


def read_csv(path: Path, max_bytes: int) -> Table:
    """The columns of a text table.

    Raises:
        InputError: not text, too large, no rows of numbers, or rows of different length.
    """
    refuse_size(path, path.stat().st_size, min(max_bytes, MAX_TEXT_BYTES))
    text = _decode(path)
    delimiter = _delimiter(text)
    rows, lines, comment = _split(text, delimiter)
    if not rows:
        raise InputError(Problem("file", "no rows", str(path), "export it again"))
    header, rows, lines = _header(rows, lines, comment, delimiter)
    if not rows:
        raise InputError(Problem("file", "a header and no rows of numbers", str(path), "export it again"))
    names = header or [""] * len(rows[0])
    _refuse_ragged(path, rows, lines, names)
    return CsvTable(path, tuple(names), rows, lines, delimiter)


def _decode(path: Path) -> str:
    raw = path.read_bytes()
    if b"\0" in raw[:4096] and not raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise InputError(Problem("file", "not a text file", str(path), "export it as CSV"))
    encoding = "utf-16" if raw.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig"
    try:
        return raw.decode(encoding)
    except UnicodeDecodeError:
        return raw.decode("latin-1")  # where older programs write µ, ° and ²


def _delimiter(text: str) -> str:
    """The delimiter of the last full line: headers hold all kinds of signs, numbers only one."""
    last = next((line for line in reversed(text.splitlines()) if line.strip(" \t;,\r")), "")
    return next((sign for sign in (";", "\t", ",") if sign in last), " ")


def _split(text: str, delimiter: str) -> tuple[list[list[str]], list[int], str]:
    """Rows of cells with their line numbers, and the last comment line before them."""
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, skipinitialspace=True)
    rows, lines, comment = [], [], ""
    for row in reader:
        if not any(cell.strip() for cell in row):
            continue
        if row[0].startswith("#"):
            comment = comment if rows else delimiter.join(row)
            continue
        rows.append([cell for cell in row if cell] if delimiter == " " else row)
        lines.append(reader.line_num)
    return rows, lines, comment


def _header(
    rows: list[list[str]], lines: list[int], comment: str, delimiter: str
) -> tuple[list[str] | None, list[list[str]], list[int]]:
    if not any(_is_number(cell.replace(",", ".")) for cell in rows[0]):
        return [cell.strip() for cell in rows[0]], rows[1:], lines[1:]
    names = [name.strip() for name in comment.lstrip("# ").split(delimiter)]
    return (names if len(names) == len(rows[0]) else None), rows, lines


def _refuse_ragged(path: Path, rows: list[list[str]], lines: list[int], names: list[str]) -> None:
    """Refuse rows of another length than the header's; unnamed columns at its end may be missing."""
    width = len(names)
    least = max((k + 1 for k, name in enumerate(names) if name), default=width)
    problems = []
    for k, row in enumerate(rows):
        if len(row) > width and not any(row[width:]):
            del row[width:]
        if least <= len(row) <= width:
            row += [""] * (width - len(row))
            continue
        key = f"{path.name}, row {k} (line {lines[k]})"
        rule = f"{len(row)} cells where the first line has {width}"
        problems.append(Problem(key, rule, remedy="complete the row, or leave it out", source=str(path)))
    if len(problems) > _SHOWN:
        rule = f"{len(problems) - _SHOWN} more rows have another number of cells"
        problems = [*problems[:_SHOWN], Problem(path.name, rule, remedy="export the file again")]
    if problems:
        raise InputError(problems)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
