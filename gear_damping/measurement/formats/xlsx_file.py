"""Excel workbooks: the columns of one sheet by their header, of several as `sheet/header`."""

import re
from dataclasses import dataclass, field
from datetime import datetime, time, timedelta
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.cells import (
    Cells,
    CellTable,
    lone_rows,
    said_of_empty_rows,
    without_footer,
    without_lone_rows,
)
from gear_damping.measurement.formats.header import find_header
from gear_damping.measurement.formats.moments import Moments, moment_since, past_midnight
from gear_damping.measurement.formats.not_applied import left_above
from gear_damping.measurement.formats.stated_rate import stated_rate, unread_rate
from gear_damping.measurement.formats.table import Table, extra_library, refuse_size, unreadable
from gear_damping.measurement.formats.units_above import units_of_names
from gear_damping.units import is_of_kind

SUFFIXES = (".xlsx",)

_COMMA = re.compile(r"\s*[+-]?\d+,\d+\s*")
_WRITTEN = re.compile(r'"[^"]*"|\\.|\[[^\]]*\]|_.|\*.')  # of a format: texts, colours, blanks
_THOUSANDTHS = re.compile(r"(?<=[0#?])(,+)(?=\.|[^0#?.,]*$)")
_BEHIND = re.compile(r'[0#?%,]\s*"([^"]+)"\s*$')
_GROUP = 3  # digits between signs of thousands
_CLEARLY = 10.0  # times as far from the numbers beside it: what the other reading of a comma must be to be none
NO_VALUES = "no values; if they are formulas, open the workbook and save it, which stores what they give"
_HEAD = 100  # rows among which the header is looked for


def read(path: Path, max_bytes: int) -> Table:
    """The columns of a workbook, formulas by the values that Excel stored; times are seconds from the first.

    Raises:
        InputError: not a workbook, too large when unpacked, no rows of numbers, or openpyxl is missing.
    """
    openpyxl = extra_library("openpyxl", path)
    with unreadable(path, "not a readable xlsx file", "save it again as an Excel workbook (.xlsx), or as CSV"):
        with ZipFile(path) as archive:
            refuse_size(path, sum(member.file_size for member in archive.infolist()), max_bytes)
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        sheets = {sheet.title: _cells(sheet) for sheet in book.worksheets}
        book.close()
    several = sum(bool(rows) for rows, _ in sheets.values()) > 1
    columns, notes, empty_columns, above = [], [], [], []
    for title, (rows, units) in sheets.items():
        found = _columns(rows, units, f"{title}/" if several else "")
        empty_columns += found.empty
        above += [found.above] if found.columns else []
        own, below = without_footer(found.columns)
        if not below:
            own, below = without_lone_rows(found.columns, lone_rows(_filled(rows)))
        columns += own
        empty = "" if below else _empty_rows(rows, found.first)
        notes += [f"{path.name}, {title}: {empty}"] if empty else []
        notes += [f"{path.name}, {title}: {one}" for one in found.notes]
        notes += [f"{path.name}, {title}: {below}"] if below else []
    if not columns:
        raise InputError(Problem("file", "no rows", str(path), "export it again"))
    table = CellTable(path, columns, decimal_commas=True)
    table.notes, table.has_groups = table.notes + tuple(notes), several
    rates = {stated_rate(one) for one in above}
    table.stated_rate = rates.pop() if len(rates) == 1 else None
    table.unread_rate = "" if table.stated_rate else next(filter(None, map(unread_rate, above)), "")
    table.left_out = tuple(f"{name} ({NO_VALUES})" for name in empty_columns)
    return table


def _cells(sheet: Any) -> tuple[list[list[Any]], dict[int, str]]:
    """The values of a sheet as they are shown, in per cent or in thousands, and units that their formats write."""
    rows = [list(row) for row in sheet.iter_rows(values_only=True)]
    formats = {
        k: cell.number_format or ""
        for row in sheet.iter_rows(max_row=_HEAD)
        for k, cell in enumerate(row)
        if isinstance(cell.value, int | float) and not isinstance(cell.value, bool)
    }
    for k, factor in ((k, _shown(one)) for k, one in formats.items()):
        for row in rows if factor != 1 else ():
            row[k] = factor * row[k] if k < len(row) and isinstance(row[k], int | float) else row[k]
    return rows, {k: unit for k, one in formats.items() if (unit := _unit_written(one))}


def _shown(number_format: str) -> float:
    """What is shown for a stored 1: `0.0%` shows 100, and every comma behind the last digit, `0.00,`, a thousandth."""
    digits = _WRITTEN.sub("", number_format.partition(";")[0])
    commas = sum(len(found) for found in _THOUSANDTHS.findall(digits))
    return 100.0 ** digits.count("%") / 1000.0**commas


def _unit_written(number_format: str) -> str:
    """The unit that a format writes behind each number, `0.00" mm"`; "" without one."""
    written = _BEHIND.search(number_format.partition(";")[0])
    return written[1].strip() if written and is_of_kind(written[1].strip(), written[1].strip()) else ""


@dataclass(frozen=True)
class _Sheet:
    """What a sheet holds.

    Args:
        columns: Those with rows below its header.
        notes: What is noted of them.
        empty: Names without a value below.
        above: The cells of the rows above the values, as texts.
        first: The line of the first values.
    """

    columns: list[Cells] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    empty: list[str] = field(default_factory=list)
    above: list[list[str]] = field(default_factory=list)
    first: int = 1


def _columns(rows: list[list[Any]], units: dict[int, str], prefix: str) -> _Sheet:
    """The columns of a sheet.

    Empty cells at the end of a column are not its own.
    """
    from openpyxl.utils import get_column_letter  # of the extra that `read` has asked for

    filled, kept = _without_blank_columns(
        [(number, row) for number, row in enumerate(rows, start=1) if any(cell is not None for cell in row)]
    )
    texts = [["" if cell is None else str(cell).strip() for cell in row] for _, row in filled[:_HEAD]]
    if not texts:
        return _Sheet()
    below = filled[_HEAD:] or filled  # settings above the names may be wider than the values
    header = find_header(texts, max(sum(cell is not None for cell in row) for _, row in below))
    body, above, width = filled[header.first :], texts[: header.first], max(len(row) for _, row in filled)
    columns, notes, empty = [], list(left_above(above)), []
    said = units_of_names(above, [header.name(k) for k in range(width)])
    for k in range(width):
        cells = [(number, row[k] if k < len(row) else None) for number, row in body]
        while cells and cells[-1][1] is None:
            cells.pop()
        name, unit = header.name(k), header.unit(k) or units.get(kept[k]) or said.get(k)
        empty += [f"{prefix}{name}"] if name and not cells else []
        if cells:
            lines = [number for number, _ in cells]
            name = f"{prefix}{name}" if name else ""
            own = _with_points([cell for _, cell in cells])
            if commas := sum(a is not b[1] for a, b in zip(own, cells, strict=True)):
                first = next(k for k, (a, b) in enumerate(zip(own, cells, strict=True)) if a is not b[1])
                said = f"the first '{cells[first][1]}' as {own[first]:g}"
                notes.append(f"{commas} texts with a comma among the numbers of '{name}' are read as numbers, {said}")
            values, begins = _values(own)
            unit = unit if begins is None else "s"
            columns.append(Cells(name, unit, values, lines.__getitem__, header.also(k), begins))
    blank = [get_column_letter(place + 1) for place in range(kept[-1]) if place not in kept]
    notes += [f"columns {', '.join(blank)} are empty, and numbers of columns do not count them"] if blank else []
    return _Sheet(columns, notes, empty, above, body[0][0] if body else 1)


def _with_points(cells: list[Any]) -> list[Any]:
    """Cells of a column of numbers with those that are texts with a comma, as `1,5` and `1,500`, as numbers too.

    Before three digits it may part thousands: the numbers beside such texts tell, and where they do not, they stay.
    """
    places = [k for k, cell in enumerate(cells) if isinstance(cell, str) and _COMMA.fullmatch(cell)]
    known = [k for k, cell in enumerate(cells) if isinstance(cell, int | float)]
    if not known or not places:
        return cells
    decimal = {k: float(cells[k].replace(",", ".")) for k in places}
    read = decimal
    if all(len(cells[k].strip().partition(",")[2]) == _GROUP for k in places):
        near = dict(zip(places, np.interp(places, known, [cells[k] for k in known]), strict=True))
        thousands = {k: float(cells[k].replace(",", "")) for k in places}
        away = [sum(abs(one[k] - near[k]) for k in places) for one in (decimal, thousands)]
        if max(away) < _CLEARLY * min(away):
            return cells
        read = decimal if away[0] < away[1] else thousands
    return [read.get(k, cell) for k, cell in enumerate(cells)]


def _without_blank_columns(rows: list[tuple[int, list[Any]]]) -> tuple[list[tuple[int, list[Any]]], list[int]]:
    """Numbered rows without the columns that hold nothing at all, which part the others on a sheet; and which stay."""
    width = max((len(row) for _, row in rows), default=0)
    wide = [[*row, *[None] * (width - len(row))] for _, row in rows]
    kept = [k for k, column in enumerate(zip(*wide, strict=True)) if any(cell is not None for cell in column)]
    return [(number, [row[k] for k in kept]) for (number, _), row in zip(rows, wide, strict=True)], kept


def _filled(rows: list[list[Any]]) -> list[int]:
    """The numbers of the rows of values, from the first that holds one on."""
    first = next((k for k, row in enumerate(rows) if any(isinstance(cell, int | float) for cell in row)), len(rows))
    return [k for k, row in enumerate(rows) if k >= first and any(cell is not None for cell in row)]


def _empty_rows(rows: list[list[Any]], first: int) -> str:
    """What is noted of empty rows between rows of numbers, from a line on."""
    values = [k for k, row in enumerate(rows, start=1) if any(isinstance(cell, int | float) for cell in row)]
    values = [k for k in values if k >= first]
    empty = [k for k, row in enumerate(rows, start=1) if all(cell is None for cell in row)]
    return said_of_empty_rows([k for k in empty if values and values[0] < k < values[-1]], len(values))


def _values(cells: list[Any]) -> tuple[NDArray, float | None]:
    """Numbers as float64, moments as s from the first and when that was; a column of anything else keeps its texts."""
    if all(isinstance(cell, int | float) for cell in cells):
        return np.array(cells, dtype=np.float64), None
    told = [k for k, cell in enumerate(cells) if cell is not None]
    seconds, own = np.full(len(cells), np.nan), [cells[k] for k in told]
    if all(isinstance(cell, datetime) for cell in own):
        seconds[told] = [(cell - own[0]).total_seconds() for cell in own]
        return seconds, moment_since(own[0])
    if all(isinstance(cell, time | timedelta) for cell in own):
        found = Moments.of(past_midnight(np.array([_seconds(cell) for cell in own])))
        seconds[told] = found.seconds
        return seconds, found.begins
    return np.array(["" if cell is None else str(cell) for cell in cells], dtype=object), None


def _seconds(moment: time | timedelta) -> float:
    if isinstance(moment, timedelta):
        return moment.total_seconds()
    return 3600 * moment.hour + 60 * moment.minute + moment.second + 1e-6 * moment.microsecond
