"""Text tables: comma, semicolon, tab, bar or blanks, decimal point or comma, with or without a header, also in gzip."""

import io
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.column_kinds import counts_rows
from gear_damping.measurement.formats.blocks import blocks_of, listed
from gear_damping.measurement.formats.cells import (
    FEWEST_BEHIND,
    MOST_BELOW,
    SHOWN,
    Cells,
    CellTable,
    decimal_commas,
    is_word,
    lone_rows,
    said_of_empty_rows,
    without_footer,
    without_lone_rows,
)
from gear_damping.measurement.formats.console_text import refuse_what_is_shown
from gear_damping.measurement.formats.frame_tables import refuse_several_tables
from gear_damping.measurement.formats.header import Header
from gear_damping.measurement.formats.not_applied import left_above
from gear_damping.measurement.formats.number_texts import is_number, is_written, parts_thousands
from gear_damping.measurement.formats.octave_text import octave_table
from gear_damping.measurement.formats.stated_rate import stated_rate, unread_rate
from gear_damping.measurement.formats.table import Table, is_real
from gear_damping.measurement.formats.text_header import of_oscilloscope, text_header, without_other_headers
from gear_damping.measurement.formats.text_lines import BEGINS, HEAD, IS_COMMENT, Text, bytes_of
from gear_damping.measurement.formats.timeseries_text import timeseries_table
from gear_damping.measurement.formats.units_above import axis_units, listed_names, units_of_names
from gear_damping.units import is_of_kind

SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm", ".log", ".prn", ".trc", ".gz")

_SEEN = 2**16  # bytes that hold its first lines
_SAMPLE = 2000  # rows by which it is seen whether a column's numbers have signs between thousands
_UNIT_COLUMN = re.compile(r"^(unit|units|einheit|unité|unidad)$", re.I)
_NAN = ("nan", "NaN", "NAN", "Nan", "-nan", "+nan")
_COMMENT = re.compile(rb"^[ \t]*(#|%|//).*$", re.MULTILINE)


def read(path: Path, max_bytes: int) -> Table:
    """The columns of a text table; of a file in gzip after it is unpacked.

    Raises:
        InputError: not text, too large, no rows of numbers, or rows of different length.
    """
    content = bytes_of(path, max_bytes)
    if (variables := octave_table(path, content)) is not None:
        return variables
    if (series := timeseries_table(path, content)) is not None:
        return series
    text = Text(path, content)
    refuse_what_is_shown(str(path), text.utf8[:_SEEN].decode("utf-8", "replace").splitlines()[:HEAD])
    refuse_several_tables(text)
    header, first_line = text_header(text)
    scope = of_oscilloscope([row for _, row in islice(text.rows(), 2)])
    header = header if scope is None else replace(header, names=scope[0], units=scope[1], skipped=0)
    blocks = without_other_headers(text, first_line)
    parted, has_points = _parted(text, first_line)
    decimal = "," if _decimal_comma(text, first_line, parted) else "."
    frame = _frame(text, header, first_line, decimal, parted)
    width = frame.shape[1] - 1
    _refuse_open_quote(text, frame, first_line)
    if any(not is_real(frame[k].dtype) for k in range(width)) or not (frame[width] == "").all():
        _refuse_ragged(text, header.names or ("",) * width, first_line)
        if all(frame[k].dtype == frame[width].dtype for k in range(width)):
            frame = frame[~(frame == "").all(axis=1)]  # rows of delimiters alone
    lines = _Lines(path, max_bytes, first_line)
    above = [row for line, row in islice(text.rows(), HEAD) if line < first_line]
    header = _as_listed(header, above, width, text.delimiter)
    numbered = not header.name(0) and is_real(frame[0].dtype) and counts_rows(frame[0].to_numpy())
    said = units_of_names(above, header.names) | axis_units(above, width, numbered)
    units = [header.unit(k) or said.get(k) for k in range(width)]
    columns = [Cells(header.name(k), units[k], frame[k].to_numpy(), lines, header.also(k)) for k in range(width)]
    columns, below = without_footer(columns)
    if not below and not blocks:
        columns, below = without_lone_rows(columns, _lone_rows(text, first_line))
    _refuse_long_form(path, columns)
    # Decimal commas may always stand in quotes.
    table = CellTable(path, columns, decimal_commas=True, decimal=decimal if decimal == "," or has_points else "")
    above += [] if scope is None else scope[2]
    table.stated_rate = stated_rate(above, decimal=decimal)
    table.unread_rate = "" if table.stated_rate else unread_rate(above, decimal)
    notes = [f"{header.skipped} line(s) above the values are left out"] if header.skipped else []
    notes += [*left_above(above), header.says]
    if blocks:
        lines_of = [line for line, _ in _values(text, first_line)]
        table.blocks = blocks_of(lines_of, blocks, table.stated_rate, decimal)
        rates = f", of other rates: rows {listed(table.blocks)}" if table.blocks else ""
        notes += [f"{len(blocks)} more block(s) with a header of their own follow the first{rates}"]
    elif not below:
        notes += [_empty_rows(text, first_line)]
    table.notes += tuple(f"{path.name}: {one}" for one in [*notes, text.cut, below] if one)
    if decimal == ",":
        table.notes += (decimal_commas(path, _with_commas(text, first_line, parted, table)),)
    return table


def _as_listed(header: Header, above: Sequence[Sequence[str]], width: int, sign: str) -> Header:
    """The header with the names that lines above it list by number, where no row holds names but such a line."""
    listed = listed_names(above, width, sign)
    last = " ".join(header.names)
    if not listed or (last.strip() and not last.endswith(listed[-1])):
        return header
    return replace(header, names=listed, units=(), skipped=max(header.skipped - width, 0))


def _refuse_long_form(path: Path, columns: Sequence[Cells]) -> None:
    """A table whose rows hold one signal after another in one column, as a column of their units tells."""
    for one in columns:
        if not _UNIT_COLUMN.match(one.name) or is_real(one.values.dtype):
            continue
        units = list(dict.fromkeys(str(cell).strip() for cell in one.values[:HEAD]))
        if len(units) > 1 and all(is_of_kind(unit, unit) for unit in units):
            rule = f"its rows hold {', '.join(units)} by turns, as column '{one.name}' says"
            remedy = "export a column for each signal, or a file for each"
            raise InputError(Problem("file", rule, str(path), remedy))


class _Lines:
    """The line of the file that a row of values stands in; looked up only where a fault is to be named."""

    def __init__(self, path: Path, max_bytes: int, first_line: int) -> None:
        self._path, self._max_bytes, self._first = path, max_bytes, first_line

    @cached_property
    def _numbers(self) -> list[int]:
        text = Text(self._path, bytes_of(self._path, self._max_bytes))
        return [line for line, row in _values(text, self._first)]

    def __call__(self, row: int) -> int:
        return self._numbers[row]


def _parted(text: Text, first_line: int) -> tuple[set[int], bool]:
    """The columns in which a sign parts thousands, by their first cells, and whether others have decimal points.

    Beside `0.01` a column of `6,096` has thousands, and beside `0,01` one of `6.096`.
    """
    rows = [row for _, row in islice(_values(text, first_line), _SAMPLE)]
    columns = list(zip(*(row for row in rows if len(row) >= text.width), strict=False))
    parted = {k for k, cells in enumerate(columns) for sign in ".," if parts_thousands(cells, sign)}
    others = [cells for k, cells in enumerate(columns) if k not in parted]
    has_points = any(map(_has_decimal_points, others))
    sign = "," if has_points else "." if _has_decimal_commas(text, others) else ""
    if sign:
        parted |= {k for k, cells in enumerate(columns) if parts_thousands(cells, sign, other_is_decimal=True)}
    return parted, has_points


def _decimal_comma(text: Text, first_line: int, parted: set[int]) -> bool:
    """Whether numbers among the first values have a comma; columns that have points are read by themselves."""
    rows = (row for _, row in islice(_values(text, first_line), HEAD))
    return _has_decimal_commas(text, [[cell for k, cell in enumerate(row) if k not in parted] for row in rows])


def _with_commas(text: Text, first_line: int, parted: set[int], table: Table) -> list[str]:
    """The columns with decimal commas where others have decimal points; none where all have commas."""
    rows = [row for _, row in islice(_values(text, first_line), HEAD)]
    held = {
        sign: [k for k in range(len(table.names)) if any(sign in row[k] for row in rows if k < len(row))]
        for sign in ",."
    }
    points = [k for k in held["."] if k not in parted]
    return [table.names[k] or str(k) for k in held[","] if k not in parted] if points else []


def _has_decimal_points(cells: Sequence[str]) -> bool:
    """Whether a column's numbers have a point that parts no thousands."""
    has_one = any("." in cell and is_number(cell) for cell in cells)
    return has_one and not parts_thousands(cells, ".", other_is_decimal=True)


def _has_decimal_commas(text: Text, lists: Sequence[Sequence[str]]) -> bool:
    return text.delimiter != "," and any("," in cell and is_written(cell) for cells in lists for cell in cells)


def _frame(text: Text, header: Header, first_line: int, decimal: str, parted: set[int]) -> Any:
    """The values by pandas, with one column more than the header has: it takes what is too much in a row."""
    import pandas as pd  # here, since it takes long to import and most of the program does not need it

    width = len(header.names)
    handle = io.BytesIO(_COMMENT.sub(b"", text.utf8))
    for _ in range(first_line - 1):
        handle.readline()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pd.errors.ParserWarning)  # rows too long, which are named below
            return pd.read_csv(
                handle, sep=r"\s+" if text.delimiter == " " else text.delimiter, header=None,
                names=range(width + 1), index_col=False, skipinitialspace=True, keep_default_na=False,
                na_values=list(_NAN), low_memory=False, decimal=decimal,
                dtype=dict.fromkeys(parted, str),
            )  # fmt: skip
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        _refuse_ragged(text, header.names, first_line)
        rule = f"not a readable table ({' '.join(str(error).split())})"
        raise InputError(Problem("file", rule, str(text.path), "export it again")) from None


def _refuse_open_quote(text: Text, frame: Any, first_line: int) -> None:
    """Refuse a cell that holds lines of values: a quotation mark that is not closed has swallowed rows."""
    for k in frame.columns if b'"' in text.utf8 else ():
        cells = [] if is_real(frame[k].dtype) else frame[k].tolist()
        row = next((row for row, cell in enumerate(cells) if _holds_rows(cell, text.delimiter)), None)
        if row is None:
            continue
        line = next((line for number, (line, _) in enumerate(_values(text, first_line)) if number == row), None)
        rule = f"a cell of row {row} goes on over {cells[row].count(chr(10))} lines, up to line {line}"
        remedy = "close or take out its quotation mark"
        raise InputError(Problem(text.path.name, rule, None, remedy, str(text.path)))


def _holds_rows(cell: Any, delimiter: str) -> bool:
    """Whether lines of a cell are rows of a table; a remark may have lines too."""
    lines = cell.split("\n")[1:] if isinstance(cell, str) else []
    return any(BEGINS.match(line) and delimiter in line for line in lines)


def _empty_rows(text: Text, first_line: int) -> str:
    """What is noted of rows without a value among the others; of one behind every other, as a printer does, nothing."""
    lines = text.utf8.rstrip(b'\n\r\t ;,|"').split(b"\n")[first_line:]
    while lines and (not lines[-1].strip(b' \t;,|"') or _COMMENT.match(lines[-1])):
        lines.pop()  # below the last values a comment may stand
    empty = [k for k, line in enumerate(lines, first_line + 1) if not line.strip(b' \t;,|"')]
    return said_of_empty_rows(empty, len(lines))


def _lone_rows(text: Text, first_line: int) -> int:
    """How many rows at its end the only empty lines of a table part from all others."""
    whole = text.utf8.rstrip(b'\n\r\t ;,|"')
    if all(line.strip(b' \t;,|"') for line in whole.rsplit(b"\n", FEWEST_BEHIND)[-FEWEST_BEHIND:]):
        return 0
    lines = whole.split(b"\n")[first_line - 1 :]
    told = [k for k, line in enumerate(lines) if line.strip(b' \t;,|"')]
    return sum(not _COMMENT.match(lines[k]) for k in told[len(told) - lone_rows(told) :])


def _values(text: Text, first_line: int) -> Iterator[tuple[int, list[str]]]:
    return ((line, row) for line, row in text.rows() if line >= first_line and not IS_COMMENT.match(row[0]))


def _above_footer(rows: list[tuple[int, list[str]]], least: int) -> list[tuple[int, list[str]]]:
    """Rows without the few below a table that have fewer cells than it and begin with words."""
    below = next((k for k, (_, row) in enumerate(reversed(rows)) if len(row) >= least), 0)
    footer = rows[len(rows) - below :]
    is_footer = below <= MOST_BELOW and all(is_word(row[0]) for _, row in footer)
    return rows[: len(rows) - below] if is_footer else rows


def _refuse_ragged(text: Text, names: tuple[str, ...], first_line: int) -> None:
    """Refuse rows of another length than the header's; unnamed columns at its end may be missing."""
    width = len(names)
    least = max((k + 1 for k, name in enumerate(names) if name), default=width)
    problems, found, commas = [], 0, text.delimiter == ","
    rows, sizes = _above_footer(list(_values(text, first_line)), least), set()
    count = len(rows)
    for k, (line, row) in enumerate(rows):
        if least <= len(row) <= width or (len(row) > width and not any(row[width:])):
            continue
        found, commas = found + 1, commas and len(row) == 2 * width
        sizes.add(len(row))
        if found <= SHOWN:
            key = f"{text.path.name}, row {k} (line {line})"
            rule = f"{len(row)} cells where the first line has {width}"
            problems.append(Problem(key, rule, None, "complete the row, or leave it out", str(text.path)))
    if found == count and len(sizes) > 1:
        rule = f"no row has as many cells as the first line, {width}, and rows differ ({min(sizes)} to {max(sizes)})"
        remedy = "export it as a table, one column a signal; a log of messages by turns, as of a CAN bus, is none"
        raise InputError(Problem(text.path.name, rule, None, remedy, str(text.path)))
    if found > SHOWN:
        rule = f"{found - SHOWN} more rows have another number of cells"
        remedy = "export the file again" + (", with decimal points: a comma also parts its columns" if commas else "")
        problems.append(Problem(text.path.name, rule, None, remedy))
    if problems:
        raise InputError(problems)
