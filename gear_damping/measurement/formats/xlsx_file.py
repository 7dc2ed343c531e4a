"""Excel workbooks: the columns of one sheet by their header, of several as `sheet/header`."""

from datetime import datetime, time, timedelta
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.cells import Cells, CellTable, said_of_empty_rows, without_footer
from gear_damping.measurement.formats.header import find_header
from gear_damping.measurement.formats.moments import past_midnight
from gear_damping.measurement.formats.table import Table, extra_library, refuse_size, unreadable

SUFFIXES = (".xlsx",)

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
        sheets = {sheet.title: [list(row) for row in sheet.iter_rows(values_only=True)] for sheet in book.worksheets}
        book.close()
    several = sum(bool(rows) for rows in sheets.values()) > 1
    columns, notes = [], []
    for title, rows in sheets.items():
        notes += [f"{path.name}, {title}: {empty}"] if (empty := _empty_rows(rows)) else []
        own, below = without_footer(_columns(rows, f"{title}/" if several else ""))
        columns += own
        notes += [f"{path.name}, {title}: {below}"] if below else []
    if not columns:
        raise InputError(Problem("file", "no rows", str(path), "export it again"))
    table = CellTable(path, columns, decimal_commas=True)
    table.notes += tuple(notes)
    return table


def _columns(rows: list[list[Any]], prefix: str) -> list[Cells]:
    """The columns of a sheet with rows below its header; empty cells at the end of a column are not its own."""
    filled = [(number, row) for number, row in enumerate(rows, start=1) if any(cell is not None for cell in row)]
    texts = [["" if cell is None else str(cell).strip() for cell in row] for _, row in filled[:_HEAD]]
    if not texts:
        return []
    header = find_header(texts, max(sum(cell is not None for cell in row) for _, row in filled))
    body = filled[header.first :]
    columns = []
    for k in range(max(len(row) for _, row in filled)):
        cells = [(number, row[k] if k < len(row) else None) for number, row in body]
        while cells and cells[-1][1] is None:
            cells.pop()
        name, unit = header.name(k), header.unit(k)
        if cells:
            lines = [number for number, _ in cells]
            name = f"{prefix}{name}" if name else ""
            values, own_unit = _values([cell for _, cell in cells])
            columns.append(Cells(name, own_unit or unit, values, lines.__getitem__, header.also(k)))
    return columns


def _empty_rows(rows: list[list[Any]]) -> str:
    """What is noted of empty rows between rows of numbers."""
    values = [k for k, row in enumerate(rows, start=1) if any(isinstance(cell, int | float) for cell in row)]
    empty = [k for k, row in enumerate(rows, start=1) if all(cell is None for cell in row)]
    return said_of_empty_rows([k for k in empty if values and values[0] < k < values[-1]], len(values))


def _values(cells: list[Any]) -> tuple[NDArray, str | None]:
    """Numbers as float64, moments as seconds from the first; a column with anything else keeps its texts."""
    if all(isinstance(cell, int | float) for cell in cells):
        return np.array(cells, dtype=np.float64), None
    if all(isinstance(cell, datetime) for cell in cells):
        return np.array([(cell - cells[0]).total_seconds() for cell in cells]), "s"
    if all(isinstance(cell, time | timedelta) for cell in cells):
        seconds = past_midnight(np.array([_seconds(cell) for cell in cells]))
        return seconds - seconds[0], "s"
    return np.array(["" if cell is None else str(cell) for cell in cells], dtype=object), None


def _seconds(moment: time | timedelta) -> float:
    if isinstance(moment, timedelta):
        return moment.total_seconds()
    return 3600 * moment.hour + 60 * moment.minute + moment.second + 1e-6 * moment.microsecond
