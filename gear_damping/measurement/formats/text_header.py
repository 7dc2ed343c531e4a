"""The header of a text table: below the settings of a program, marks that end it, and again above further blocks."""

import re
from dataclasses import replace
from itertools import islice

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.cells import unit_in
from gear_damping.measurement.formats.header import (
    Header,
    filled,
    find_header,
    is_units,
    known_header,
    parted_otherwise,
)
from gear_damping.measurement.formats.moments import is_told
from gear_damping.measurement.formats.number_texts import is_absent, is_number, is_written
from gear_damping.measurement.formats.text_lines import HEAD, ONE_COLUMN, Text

_PREAMBLE, _BELOW = 20, 20  # rows that may be settings; rows of the table below them, at least
_PLACE = "X_Value"  # LabVIEW's name of what the values are over,
_PLAIN = {"pounds": "lbf", "newtons": "N", "amps": "A", "meters": "m"}  # ... and its words for units
_SETTING, _DEFINED = re.compile(r"[A-Za-z]\w*="), "DEF="
_SCOPE, _COUNTED = ("Start", "Increment"), "Sequence"  # behind the names of an oscilloscope; no unit
_LABELLED = re.compile(r"[A-Za-z_]\w*\s*[:=]\s*[-+]?\.?\d")  # a value behind its name
_END_OF_HEADER = re.compile(r"^\*+ ?end[_ ]of[_ ]header", re.IGNORECASE)
_VALUES = re.compile(rb"^[\s;,|\"]*[+-]?\.?\d")  # a line that begins with a number


def text_header(text: Text) -> tuple[Header, int]:
    """The header, from a row of texts or the last comment before the values, and the line of the first values."""
    lines, rows, comments = [], [], []
    for line, row in islice(text.rows(), HEAD):
        if row[0].startswith("#"):
            comments += [] if rows else [row]
            continue
        lines.append(line)
        rows.append(row)
    if not rows:
        raise InputError(Problem("file", "no rows", str(text.path), "export it again"))
    rows = _without_units(rows)
    start = _behind_marks(rows) or _behind_settings(rows)
    settings, lines, rows = rows[:start], lines[start:], rows[start:]
    # LabVIEW writes channels of one sample a block into the first row of each alone.
    width = filled(rows[0]) if start and rows[0][0] == _PLACE else text.width
    header = known_header(rows, width) or _below_preamble(rows, width) or find_header(rows, width)
    header = _of_labview(header, settings) if start else header
    header = _of_cassy(header, settings) if start and not any(header.names) else header
    is_title = (
        len(header.names) == 1 < text.width
        or _is_setting(header.names, text.width)
        or (text.delimiter == " " and len(header.names) > text.width > 0)
        or (text.delimiter == ONE_COLUMN and _sets_down(header))
    )
    if is_title:  # names in words would be as many as the columns
        first, says = _behind_a_note(rows, header.first, text.width)
        header = Header(("",) * text.width, (), first, first, says)
    if len(header.names) == text.width - 1 and _are_rows_numbered(rows[header.first :], text.width):
        header = replace(header, names=("", *header.names))
    if header.first == len(rows):
        rule, remedy = "a header and no rows of numbers", "export it again"
        if labelled := next(filter(None, map(_labelled, reversed(rows))), None):
            rule, remedy = (
                f"a name stands before every value, as in '{labelled}'",
                "leave the names out of the rows, and write them once into a line above",
            )
        elif any("[" in cell for row in rows for cell in row):
            remedy = "take out the brackets and what stands before them, so that each line is a row"
        raise InputError(Problem("file", rule, str(text.path), remedy))
    if not header.names:
        names, units = _of_comments(comments, text.delimiter, len(rows[header.first]))
        header = Header(names, units, header.first, header.skipped)
    return header, lines[header.first]


def _without_units(rows: list[list[str]]) -> list[list[str]]:
    """Rows as numbers alone, where in the last one each cell is a number and a unit, `12 mm`; else as they are."""
    if not all(unit_in(cell) for cell in rows[-1] if cell.strip()):
        return rows
    return [
        [cell.strip().removesuffix(unit_in(cell)).strip() for cell in row] if any(map(unit_in, row)) else row
        for row in rows
    ]


def _behind_a_note(rows: list[list[str]], first: int, width: int) -> tuple[int, str]:
    """The first row of a table behind a line of one number, which stands below a title, and what is noted of it."""
    table = rows[first + 1 : first + 1 + _BELOW]
    if width == 1 or filled(rows[first]) != 1 or len(table) < _BELOW or not all(_is_body(row, width) for row in table):
        return first, ""
    if any(filled(row) != width for row in table):
        return first, ""
    return first + 1, f"'{rows[first][0].strip()}' alone in a line below the title is taken for no value"


def _of_comments(rows: list[list[str]], sign: str, width: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names in the last comment before the values, or above it where that holds their units; else empty ones."""
    told = [sign.join(row).lstrip("# \t") for row in rows]
    said = [[cell.strip() for cell in line.split(sign)] for line in told if line.strip(f" \t{sign}")][-2:]
    said = [row if len(row) == width else parted_otherwise(sign.join(row), width) or row for row in said]
    *above, last = said or [[]]
    if above and len(above[0]) == len(last) == width and is_units(last):
        return tuple(above[0]), tuple(last)
    return tuple(last if len(last) == width else [""] * width), ()


def _labelled(row: list[str]) -> str | None:
    """The first cell of a row that holds a name and its value, `pot:612`, as a serial plotter is sent them."""
    return next((cell.strip() for cell in row if _LABELLED.search(cell) and not is_told(cell)), None)


def _are_rows_numbered(rows: list[list[str]], width: int) -> bool:
    """Whether the first cells of rows as wide as the values count them: a column that R writes and does not name."""
    counted, wanted = [row[0].strip() for row in rows], [str(k) for k in range(1, 1 + len(rows))]
    return len(rows) > 1 and all(filled(row) == width for row in rows) and counted == wanted


def _is_setting(names: tuple[str, ...], width: int) -> bool:
    """Whether a row of fewer cells than the table sets something down, `Trigger:` and what it is."""
    return 0 < len(names) < width and names[0].endswith((":", "="))


def _sets_down(header: Header) -> bool:
    """Whether what stands above one column is a setting, `fs = 1000 Hz`, and no name with a unit."""
    return any(map(_LABELLED.search, header.names)) and header.unit(0) is None


def without_other_headers(text: Text, first_line: int) -> list[tuple[int, list[list[str]]]]:
    """Make comments of the headers of further blocks, and return the last line and the cells of each.

    The last line above the values comes again in each; what stands before it up to the numbers or a blank line is its
    header too.
    """
    above = text.utf8.split(b"\n", first_line)[: first_line - 1]
    named = next((line.strip() for line in reversed(above) if line.strip()), b"")
    if not named or _VALUES.match(named) or text.utf8.count(named) == 1:  # as in nearly every file
        return []
    lines = text.utf8.split(b"\n")
    again = [k for k in range(first_line, len(lines)) if lines[k].strip() == named]
    headers = []
    for last in again:
        rows: list[list[str]] = []
        for k in range(last, first_line, -1):
            if not lines[k].strip() or _VALUES.match(lines[k]):
                break
            rows.insert(0, lines[k].decode("utf-8", "replace").split(text.delimiter))
            lines[k] = b"#" + lines[k]
        headers.append((last + 1, rows))
    text.utf8 = b"\n".join(lines)
    return headers


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


def of_oscilloscope(rows: list[list[str]]) -> tuple[tuple[str, ...], tuple[str, ...], list[list[str]]] | None:
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
    if _begins_wide(rows[:start], width) and len(body[0]) == len(rows[start - 1]):
        return None
    if not texts:
        return Header(("",) * width, (), start, start)
    header = find_header(rows[start:], width)
    return replace(header, first=header.first + start, skipped=header.skipped + start)


def _begins_wide(rows: list[list[str]], width: int) -> bool:
    """Whether rows end in names and the first values of a table, whose last columns have cells in these alone."""
    first = next((k for k, row in enumerate(rows) if _is_body(row[:width], width)), 0)
    if not first or not all(_is_body(row[:width], width) for row in rows[first:]):
        return False
    return _is_named(rows[first - 1], filled(rows[first - 1])) and filled(rows[first - 1]) >= max(map(filled, rows))


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
