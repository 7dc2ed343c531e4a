"""Text tables: comma, semicolon, tab, bar or blanks, decimal point or comma, with or without a header, also in gzip."""

import csv
import gzip
import io
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any

from gear_damping.errors import InputError, Problem, reading
from gear_damping.measurement.formats.cells import SHOWN, Cells, CellTable, decimal_commas, without_footer
from gear_damping.measurement.formats.header import Header, filled, find_header
from gear_damping.measurement.formats.number_texts import (
    are_decimals_alone,
    is_absent,
    is_number,
    is_written,
    parts_thousands,
)  # fmt: skip
from gear_damping.measurement.formats.stated_rate import stated_rate
from gear_damping.measurement.formats.table import Table, is_real, refuse_size, unreadable

SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm", ".log", ".prn", ".gz")

_DELIMITERS = (";", "\t", "|", ",")  # in the order in which they are taken for it; blanks where none stands
_HEAD = 100  # rows among which the header is looked for
_ALONE = 80  # last lines that are asked whether they hold a number each
_SAMPLE = 2000  # rows by which it is seen whether a column's numbers have signs between thousands
_PREAMBLE, _BELOW = 20, 20  # rows that may be settings; rows of the table below them, at least
_NAN = ("nan", "NaN", "NAN", "Nan", "-nan", "+nan")
_NUMBER, _IS_COMMENT = re.compile(r"\d"), re.compile(r"\s*(#|%|//)")
_PLACE = "X_Value"  # LabVIEW's name of what the values are over,
_PLAIN = {"pounds": "lbf", "newtons": "N", "amps": "A", "meters": "m"}  # ... and its words for units
_SETTING, _DEFINED = re.compile(r"[A-Za-z]\w*="), "DEF="
_SCOPE, _COUNTED = ("Start", "Increment"), "Sequence"  # behind the names of an oscilloscope; no unit
_END_OF_HEADER = re.compile(r"^\*+ ?end[_ ]of[_ ]header", re.IGNORECASE)
_VALUES = re.compile(rb"^[\s;,|\"]*[+-]?\.?\d")  # a line that begins with a number
_COMMENT = re.compile(rb"^[ \t]*(#|%|//)", re.MULTILINE)


def read(path: Path, max_bytes: int) -> Table:
    """The columns of a text table; of a file in gzip after it is unpacked.

    Raises:
        InputError: not text, too large, no rows of numbers, or rows of different length.
    """
    text = _Text(path, _bytes(path, max_bytes))
    header, first_line = _header(text)
    scope = _of_oscilloscope([row for _, row in islice(text.rows(), 2)])
    header = header if scope is None else replace(header, names=scope[0], units=scope[1], skipped=0)
    blocks = _without_other_headers(text, first_line)
    parted = _parted(text, first_line)
    decimal = "," if _decimal_comma(text, first_line, parted) else "."
    frame = _frame(text, header, first_line, decimal, parted)
    width = frame.shape[1] - 1
    if any(not is_real(frame[k].dtype) for k in range(width)) or not (frame[width] == "").all():
        _refuse_ragged(text, header.names or ("",) * width, first_line)
        if all(frame[k].dtype == frame[width].dtype for k in range(width)):
            frame = frame[~(frame == "").all(axis=1)]  # rows of delimiters alone
    lines = _Lines(path, max_bytes, first_line)
    columns = [Cells(header.name(k), header.unit(k), frame[k].to_numpy(), lines, header.also(k)) for k in range(width)]
    columns, below = without_footer(columns)
    # Decimal commas may always stand in quotes.
    table = CellTable(path, columns, decimal_commas=True, all_commas=decimal == ",")
    above = [row for line, row in islice(text.rows(), _HEAD) if line < first_line]
    table.stated_rate = stated_rate(above if scope is None else [*above, *scope[2]])
    if header.skipped:
        table.notes += (f"{path.name}: {header.skipped} line(s) before the header are left out",)
    if header.says:
        table.notes += (f"{path.name}: {header.says}",)
    if blocks:
        table.notes += (f"{path.name}: {blocks} more block(s) with a header of their own follow the first",)
    if text.cut:
        table.notes += (f"{path.name}: {text.cut}",)
    if below:
        table.notes += (f"{path.name}: {below}",)
    if decimal == ",":
        table.notes += (decimal_commas(path, _with_commas(text, first_line, parted, table)),)
    return table


class _Text:
    """The content of a file as UTF-8, and the sign between its cells."""

    def __init__(self, path: Path, raw: bytes) -> None:
        self.path = path
        self.utf8, self.cut = _whole_lines(_utf8(path, raw))
        if b"\n" not in self.utf8:
            self.utf8 = self.utf8.replace(b"\r", b"\n")  # as computers of the nineties end lines
        ending = self.utf8[-(2**16) :].decode("utf-8", "replace").splitlines()
        kept = [line for line in ending if line.strip(" \r" + "".join(_DELIMITERS)) and not _IS_COMMENT.match(line)]
        last = next((line for line in reversed(kept) if _NUMBER.search(line)), kept[-1] if kept else "")
        if ends := _line_end(last):
            self.utf8, last = (
                re.sub(rb"%s[ \t]*(?=\r?\n|$)" % re.escape(ends).encode(), b"", self.utf8),
                last.rstrip().rstrip(ends),
            )
        # Headers hold all kinds of signs, numbers only one.
        self.delimiter = next((sign for sign in _DELIMITERS if sign in last), " ")
        if self.delimiter == ",":
            self.delimiter = _beside_decimal_commas(kept[-_HEAD:], last)
        self.width = max((k + 1 for k, cell in enumerate(next(self._cells([last]), [])) if cell.strip()), default=0)

    def open(self) -> io.TextIOWrapper:
        """A handle at the begin of the text."""
        return io.TextIOWrapper(io.BytesIO(self.utf8), "utf-8", newline="")

    def _cells(self, lines: Any) -> Iterator[list[str]]:
        return csv.reader(lines, delimiter=self.delimiter, skipinitialspace=True)

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Every row that is not blank, comments too, with its line number."""
        reader = self._cells(self.open())
        try:
            for row in reader:
                if any(cell.strip() for cell in row):
                    yield reader.line_num, [cell for cell in row if cell] if self.delimiter == " " else row
        except csv.Error as error:
            rule = f"line {reader.line_num} is no row of a table ({error})"
            raise InputError(Problem("file", rule, str(self.path), "export it again")) from None


def _beside_decimal_commas(lines: list[str], last: str) -> str:
    """What parts the cells of a text whose lines hold commas and no other sign: blanks, where each number has one."""
    numbers = last.split()
    if len(numbers) > 1 and all("," in one and is_written(one) for one in numbers):
        return " "
    return ";" if are_decimals_alone(lines[-_ALONE:]) else ","  # a sign that is in no line: one column


def _line_end(line: str) -> str:
    """The sign that stands behind the last cell of a row and between no two of them; else ""."""
    body, last = line.rstrip()[:-1], line.rstrip()[-1:]
    others = [sign for sign in _DELIMITERS if sign in body]
    is_decimal = others == [","] and body.count(",") == 1 and "." not in body
    return last if last in _DELIMITERS and others and last not in others and not is_decimal else ""


class _Lines:
    """The line of the file that a row of values stands in; looked up only where a fault is to be named."""

    def __init__(self, path: Path, max_bytes: int, first_line: int) -> None:
        self._path, self._max_bytes, self._first = path, max_bytes, first_line

    @cached_property
    def _numbers(self) -> list[int]:
        text = _Text(self._path, _bytes(self._path, self._max_bytes))
        return [line for line, row in _values(text, self._first)]

    def __call__(self, row: int) -> int:
        return self._numbers[row]


def _bytes(path: Path, max_bytes: int) -> bytes:
    if path.suffix.lower() != ".gz":
        with reading(path):
            return path.read_bytes()
    with unreadable(path, "not a readable gzip file", "pack it again, or unpack it"), gzip.open(path) as file:
        raw = file.read(max_bytes + 1)
        refuse_size(path, len(raw), max_bytes)
    return raw


def _utf8(path: Path, raw: bytes) -> bytes:
    """The text in UTF-8; older programs write µ, ° and ² in Latin-1."""
    wide = raw.startswith((b"\xff\xfe", b"\xfe\xff"))
    if b"\0" in raw.rstrip(b"\0")[:4096] and not wide:
        packed = path.suffix.lower() == ".gz"
        remedy = "unpack it: of what gzip packs only text is read" if packed else "export it as CSV"
        raise InputError(Problem("file", "not a text file", str(path), remedy))
    try:
        return raw.decode("utf-16").encode() if wide else raw.removeprefix(b"\xef\xbb\xbf").decode().encode()
    except UnicodeDecodeError:
        return raw.decode("latin-1").encode()


def _whole_lines(text: bytes) -> tuple[bytes, str]:
    """A text without the zeros that a recorder which lost its power left, nor a line that they cut; what is noted."""
    whole = text.rstrip(b"\0\r\n ")
    if b"\0" not in text[len(whole) :]:
        return text, ""
    is_cut = not text[len(whole) :].startswith((b"\n", b"\r"))
    kept = whole[: whole.rfind(b"\n") + 1] if is_cut else whole
    line = " and the line before them" if is_cut else ""
    return kept, f"{text.count(0)} bytes of zero at its end{line} are left out"


def _header(text: _Text) -> tuple[Header, int]:
    """The header, from a row of texts or the last comment before the values, and the line of the first values."""
    lines, rows, comment = [], [], []
    for line, row in islice(text.rows(), _HEAD):
        if row[0].startswith("#"):
            comment = comment if rows else row
            continue
        lines.append(line)
        rows.append(row)
    if not rows:
        raise InputError(Problem("file", "no rows", str(text.path), "export it again"))
    start = _behind_marks(rows) or _behind_settings(rows)
    settings, lines, rows = rows[:start], lines[start:], rows[start:]
    # LabVIEW writes channels of one sample a block into the first row of each alone.
    width = filled(rows[0]) if start and rows[0][0] == _PLACE else text.width
    header = _below_preamble(rows, width) or find_header(rows, width)
    header = _of_labview(header, settings) if start else header
    header = _of_cassy(header, settings) if start and not any(header.names) else header
    is_title = (
        len(header.names) == 1 < text.width
        or _is_setting(header.names, text.width)
        or (text.delimiter == " " and len(header.names) > text.width > 0)
    )
    if is_title:  # names in words would be as many as the columns
        header = Header(("",) * text.width, (), header.first, header.first)
    if header.first == len(rows):
        raise InputError(Problem("file", "a header and no rows of numbers", str(text.path), "export it again"))
    if not header.names:
        names = [name.strip() for name in text.delimiter.join(comment).lstrip("# ").split(text.delimiter)]
        width = len(rows[header.first])
        names = names if len(names) == width else [""] * width
        header = Header(tuple(names), (), header.first, header.skipped)
    return header, lines[header.first]


def _is_setting(names: tuple[str, ...], width: int) -> bool:
    """Whether a row of fewer cells than the table sets something down, `Trigger:` and what it is."""
    return 0 < len(names) < width and names[0].endswith((":", "="))


def _without_other_headers(text: _Text, first_line: int) -> int:
    """Make comments of the headers of further blocks, and return how many there are.

    The last line above the values comes again in each; what stands before it up to the numbers or a blank line is its
    header too.
    """
    above = text.utf8.split(b"\n", first_line)[: first_line - 1]
    named = next((line.strip() for line in reversed(above) if line.strip()), b"")
    if not named or _VALUES.match(named) or text.utf8.count(named) == 1:  # as in nearly every file
        return 0
    lines = text.utf8.split(b"\n")
    again = [k for k in range(first_line, len(lines)) if lines[k].strip() == named]
    for last in again:
        for k in range(last, first_line, -1):
            if not lines[k].strip() or _VALUES.match(lines[k]):
                break
            lines[k] = b"#" + lines[k]
    text.utf8 = b"\n".join(lines)
    return len(again)


def _behind_marks(rows: list[list[str]]) -> int:
    """The row behind the last line that says that a header ends (LabVIEW: `***End_of_Header***`), 0 without one."""
    ends = [k for k, row in enumerate(rows) if _END_OF_HEADER.match(row[0])]
    return ends[-1] + 1 if ends and ends[-1] + 1 < len(rows) else 0


def _behind_settings(rows: list[list[str]]) -> int:
    """The row behind lines that set something down, `MIN=0`, at the head of a file; 0 without them."""
    above = next((k for k, row in enumerate(rows) if not _SETTING.match(row[0])), 0)
    return above if above < len(rows) else 0


def _of_cassy(header: Header, settings: list[list[str]]) -> Header:
    """The header with the names that a line `DEF=` defines (CASSY Lab: `DEF="Zeit" t / s`, a cell for each column)."""
    defined = next((row for row in settings if row[0].startswith(_DEFINED)), [])
    names = tuple(cell.removeprefix(_DEFINED).replace('"', "").strip() for cell in defined if cell.strip())
    return replace(header, names=names or header.names)


def _of_labview(header: Header, settings: list[list[str]]) -> Header:
    """The header below the lines of settings, with the units that they say.

    The column of comments, whose cells are not written, is none. Time counts in seconds.
    """
    kept = len(header.names) - (header.names[-1:] == ("Comment",))
    said = {row[0].strip(): [cell.strip() for cell in row[1:]] for row in settings}
    names, units = header.names[:kept], header.units[:kept]
    labels = [_PLAIN.get(label.lower(), label) for label in said.get("Y_Unit_Label", ())]
    if not units and names[:1] == (_PLACE,) and len(labels) >= kept - 1:
        is_time = "Time" in said.get("X_Dimension", ("Time",))[:1]
        units = ("s" if is_time else "", *labels[: kept - 1])
    return replace(header, names=names, units=units, skipped=header.skipped + len(settings))


def _of_oscilloscope(rows: list[list[str]]) -> tuple[tuple[str, ...], tuple[str, ...], list[list[str]]] | None:
    """Names and units of columns, and settings, where the first row names both (Rigol: `X,CH1,Start,Increment,`).

    The second row holds the units of the columns and the values of the settings.
    """
    names, below = [[cell.strip() for cell in row] for row in rows] if len(rows) == 2 else ([], [])
    kept = names.index(_SCOPE[0]) if _SCOPE[0] in names else 0
    settings = [[f"X {name}", *below[k : k + 1]] for k, name in enumerate(names) if k >= kept and name]
    if not kept or [name for name in names[kept:] if name] != list(_SCOPE):
        return None
    if not all(is_number(value) for _, *values in settings for value in values or [""]) or is_number(below[0]):
        return None
    units = tuple("" if unit == _COUNTED else unit for unit in below[:kept])
    return tuple(names[:kept]), units, settings


def _below_preamble(rows: list[list[str]], width: int) -> Header | None:
    """The header of a table below lines of settings, some of which have more cells than it; None without such lines."""
    wide = [k for k, row in enumerate(rows) if filled(row) > width]
    set_down = any(is_number(cell) for k in wide for cell in rows[k])  # a header alone has none
    start = wide[-1] + 1 if set_down and wide[-1] < _PREAMBLE else len(rows)
    texts = next((k for k, row in enumerate(rows[start:]) if _is_body(row, width)), 0)
    body = rows[start + texts :]
    if len(body) < _BELOW or not all(_is_body(row, width) for row in body):
        return None
    if any(filled(row) == width and _is_body(row, width) for row in rows[:start]):
        return None  # the table itself, a row of which has too many cells
    if any(k and _is_named(rows[k - 1], width) and _is_body(rows[k][:width], width) for k in wide):
        return None  # its first row, behind whose last column a sheet left a figure of its own
    if not texts:
        return Header(("",) * width, (), start, start)
    header = find_header(rows[start:], width)
    return replace(header, first=header.first + start, skipped=header.skipped + start)


def _is_named(row: list[str], width: int) -> bool:
    """Whether a row names every column of a table, and nothing else."""
    names = [cell.strip() for cell in row[:width]]
    return filled(row) == width and all(names) and not any(is_written(name) for name in names)


def _is_body(row: list[str], width: int) -> bool:
    """Whether a row holds numbers, or says that there is none, and nothing else."""
    said = [cell.strip() for cell in row]
    numbers = [is_written(cell) for cell in said]
    empty = [is_absent(cell) for cell in said]
    return filled(row) <= width and any(numbers) and all(a or b for a, b in zip(numbers, empty, strict=True))


def _parted(text: _Text, first_line: int) -> set[int]:
    """The columns in which a sign parts thousands, by their first cells."""
    rows = [row for _, row in islice(_values(text, first_line), _SAMPLE)]
    columns = list(zip(*(row for row in rows if len(row) >= text.width), strict=False))
    parted = {k for k, cells in enumerate(columns) for sign in ".," if parts_thousands(cells, sign)}
    others = [cells for k, cells in enumerate(columns) if k not in parted]
    if not _has_decimal_commas(text, others):
        return parted
    return parted | {k for k, cells in enumerate(columns) if parts_thousands(cells, ".", other_is_decimal=True)}


def _decimal_comma(text: _Text, first_line: int, parted: set[int]) -> bool:
    """Whether numbers among the first values have a comma; columns that have points are read by themselves."""
    rows = (row for _, row in islice(_values(text, first_line), _HEAD))
    return _has_decimal_commas(text, [[cell for k, cell in enumerate(row) if k not in parted] for row in rows])


def _with_commas(text: _Text, first_line: int, parted: set[int], table: Table) -> list[str]:
    """The columns with decimal commas where others have decimal points; none where all have commas."""
    rows = [row for _, row in islice(_values(text, first_line), _HEAD)]
    held = {
        sign: [k for k in range(len(table.names)) if any(sign in row[k] for row in rows if k < len(row))]
        for sign in ",."
    }
    points = [k for k in held["."] if k not in parted]
    return [table.names[k] or str(k) for k in held[","] if k not in parted] if points else []


def _has_decimal_commas(text: _Text, lists: Sequence[Sequence[str]]) -> bool:
    return text.delimiter != "," and any("," in cell and is_written(cell) for cells in lists for cell in cells)


def _frame(text: _Text, header: Header, first_line: int, decimal: str, parted: set[int]) -> Any:
    """The values by pandas, with one column more than the header has: it takes what is too much in a row."""
    import pandas as pd  # here, since it takes long to import and most of the program does not need it

    width = len(header.names)
    has_comments = _COMMENT.search(text.utf8)
    handle = io.BytesIO(_COMMENT.sub(b"#", text.utf8) if has_comments else text.utf8)
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
                comment="#" if has_comments else None,
            )  # fmt: skip
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        _refuse_ragged(text, header.names, first_line)
        rule = f"not a readable table ({' '.join(str(error).split())})"
        raise InputError(Problem("file", rule, str(text.path), "export it again")) from None


def _values(text: _Text, first_line: int) -> Iterator[tuple[int, list[str]]]:
    return ((line, row) for line, row in text.rows() if line >= first_line and not _IS_COMMENT.match(row[0]))


def _refuse_ragged(text: _Text, names: tuple[str, ...], first_line: int) -> None:
    """Refuse rows of another length than the header's; unnamed columns at its end may be missing."""
    width = len(names)
    least = max((k + 1 for k, name in enumerate(names) if name), default=width)
    problems, found, commas = [], 0, text.delimiter == ","
    for k, (line, row) in enumerate(_values(text, first_line)):
        if least <= len(row) <= width or (len(row) > width and not any(row[width:])):
            continue
        found, commas = found + 1, commas and len(row) == 2 * width
        if found <= SHOWN:
            key = f"{text.path.name}, row {k} (line {line})"
            rule = f"{len(row)} cells where the first line has {width}"
            problems.append(Problem(key, rule, None, "complete the row, or leave it out", str(text.path)))
    if found > SHOWN:
        rule = f"{found - SHOWN} more rows have another number of cells"
        remedy = "export the file again" + (", with decimal points: a comma also parts its columns" if commas else "")
        problems.append(Problem(text.path.name, rule, None, remedy))
    if problems:
        raise InputError(problems)
