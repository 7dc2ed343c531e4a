"""Where the header of a table of cells lies: titles before it, units below it or in its brackets."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from gear_damping.errors import InputError
from gear_damping.measurement.formats.bracket_words import is_known, unit_said
from gear_damping.measurement.formats.factors import factor_in
from gear_damping.measurement.formats.marker_tables import of_markers
from gear_damping.measurement.formats.number_texts import is_absent, is_number, is_written
from gear_damping.measurement.formats.unit_words import as_ours
from gear_damping.measurement.named_units import compound_at_end
from gear_damping.measurement.time_column import NAMED, is_time
from gear_damping.units import multiple_of_a_unit, parse_unit, scaled_unit

_BRACKETS = re.compile(r"[(\[]([^()\[\]]+)[)\]]\s*(?:run\s*#?\s*\d+\s*)?$", re.I)  # `Angle (rad) Run #2`, too
_WITHIN = re.compile(  # `Position (cm) Monitor Run`, `x {mm}`, where that is a unit, and no index as in `F_{N}`
    r"(?:[(\[]|(?<![_^])[{<])([^()\[\]{}<>]+)[)\]}>]"
)
_SLASH = re.compile(r"^[^/]+/\s*([^\W\d_][^\s]*|[°%µ][^\s]*)$")  # `Weg/mm`, as DIN 461 has it
_ARGUMENT = re.compile(r"^\W*[^\W\d]\w?\s*\((t|k|n)\)\s*$")  # `x(t)`, `F_(t)`: what it is over, and no unit
_IN = re.compile(r"(?:^|\s)in\s+([^\W\d]\S*|[°%µ]\S*)\s*$")  # `C1 in V`, as oscilloscopes of Rohde & Schwarz have it
_COMMA = re.compile(r"^[^,]*[^\W\d_]{2}[^,]*,\s*(\S+)\s*$")  # `Время, с`, `Weg, mm`: behind a word
_INDEX = re.compile(r"\w\[\d+\]\s*$")  # `data[3]` is a name, no unit
_NO_UNIT = ("", "-", "#")
_IN_BRACKETS = re.compile(r"\[.*\]|\(.*\)")  # a cell as it stands below a name for its unit alone
_COMMENTED = re.compile(r"^(?:%+|//+)\s*(?=[\w\[])")  # names behind the sign of comments of MATLAB and of C
_COMMENTS = ("%", "%%", ";", "//", "!", "'", "*")  # that other programs write before a line of names
_GENERIC = re.compile(
    r"^(analog(ue)?|digital|channel|chan|ch|kanal|ai|ao|di|do|in(put)?|signal|sensor|col(umn)?)[ _.#-]*\d+$", re.I
)
_IN_PROSE = re.compile(r"[:,;!?]$|^[(\[]")  # of a word: no name of a column ends so, and its unit stands behind it
_IS_NAME = re.compile(r"\w")  # signs alone are none: `---` beside the words of a title
_COUNTED_FROM = {"0": -1, "1": 0, "2": 1}  # by the number of the second column, that of the first
_LABELS = {  # of a row, in a cell before the columns
    "names": re.compile(r"^(name|channel( name)?|kanal|signal)s?$", re.I),
    "units": re.compile(r"^(unit|einheit)(en|s)?$", re.I),
}
_BEGUN = re.compile(r"^timestamps?$", re.I)  # the label of when a channel began, which is over time
_CELL_SIGNS = (",", ";", "\t", "|")  # between names, where other signs stand between the values below
_LABEL = re.compile(r"^(?:unit|einheit)(?:en|s)?\b\s*[:=]?\s*", re.I)  # before the first of a row of units
_LOGGER = "TOA5"  # the first word in files of Campbell's loggers,
_OF_LOGGER = 4  # ... and rows of their head: the station, names, units, what was done with the values
_RECORDER = ("TraceName", "VUnit")  # before the names and the units in files of Yokogawa's recorders
_TABLE = 3  # rows that a table begins with, none of them of texts alone


@dataclass(frozen=True)
class Header:
    """The names and units of the columns, and the index of the first row of values.

    Args:
        names: One per column, () where the table has no header.
        units: The row of units below the names, () where there is none.
        first: The index of the first row of values among the rows that were looked at.
        skipped: The rows above the values that are no names and no units.
        says: What is to be noted of it.
        others: Rows of texts beside that of names, a cell for each column: by these a column may be asked for too.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    first: int
    skipped: int = 0
    says: str = ""
    others: tuple[tuple[str, ...], ...] = ()

    def name(self, k: int) -> str:
        """The name of column `k`, or ""."""
        return self.names[k] if k < len(self.names) else ""

    def also(self, k: int) -> tuple[str, ...]:
        """What else is written above column `k`."""
        return tuple(row[k] for row in self.others if k < len(row) and row[k])

    def unit(self, k: int) -> str | None:
        """The unit below the name of column `k`, or in brackets at its end, as in `Acc DE (m/s^2)`."""
        if k < len(self.units):
            return as_ours(self.units[k].strip("[]() ")) or None
        return bracket_unit(self.name(k))


def find_header(rows: Sequence[Sequence[str]], width: int) -> Header:
    """The header of a table.

    Args:
        rows: The first rows of cells.
        width: The number of filled cells that a row of values has.

    Returns:
        The row of texts as wide as the values with the most different ones, of those before the first row of values,
        the last of several, one above a row of units before any other; else a wider one, else the last one. Without a
        row of texts the values begin at the first row.
    """
    if known := known_header(rows, width):
        return known
    end = _first_values(rows, width)
    is_named = any(filled(row) >= width for row in rows[:end])
    if not is_named and _names_by_numbers(rows[end : end + 1 + _TABLE], width):
        return Header(tuple(cell.strip() for cell in rows[end][:width]), (), end + 1, end)
    texts = [k for k in range(end) if not _has_number(rows[k])]
    if not texts:
        return Header((), (), 0)
    rows = [_names(_uncommented(row), width) if k in texts else row for k, row in enumerate(rows)]
    if texts[-2:] == [end - 2, end - 1] and all(filled(rows[k]) == width for k in texts[-2:]):
        both = _of_two_rows(*([cell.strip() for cell in rows[k][:width]] for k in texts[-2:]), end)
        if both is not None:
            return both
    texts = [k for k in texts if not (is_units(rows[k]) and k - 1 in texts and filled(rows[k - 1]) == width)]
    exact = [k for k in texts if filled(rows[k]) == width]
    wide = [k for k in texts if filled(rows[k]) > width]
    above_units = [k for k in exact if k + 1 < len(rows) and is_units(rows[k + 1])]
    start = max(above_units or exact or wide or texts[-1:], key=lambda k: (len({*rows[k]} - {""}), k))
    start -= bool(start and is_units(rows[start]) and _are_numbered(rows[start - 1], width))
    names, first = tuple(cell.strip() for cell in rows[start]), start + 1
    units: tuple[str, ...] = ()
    if first < len(rows) and is_units(rows[first]):
        units, first = tuple(cell.strip() for cell in rows[first]), first + 1
    between = max(end - first, 0) if end < len(rows) else 0  # texts that are neither names nor units
    others = tuple(tuple(cell.strip() for cell in rows[k][:width]) for k in exact if k != start)
    return Header(names, units, first + between, start + between, others=others)


def known_header(rows: Sequence[Sequence[str]], width: int) -> Header | None:
    """The header of a table whose rows say themselves what they are; None of any other."""
    if (markers := of_markers(rows)) is not None:
        names, units, first = markers
        return Header(names, units, first, first - 2)
    return _of_logger(rows) or _of_recorder(rows, width) or _labelled(rows, width) or _in_pairs(rows, width)


def _of_logger(rows: Sequence[Sequence[str]]) -> Header | None:
    """The header of four rows of a logger's file, whose units may be kinds of columns (`TS`, `RN`)."""
    if len(rows) <= _OF_LOGGER or not rows[0] or rows[0][0].strip() != _LOGGER:
        return None
    names, units = ([cell.strip() for cell in row] for row in rows[1:3])
    return Header(tuple(names), tuple(unit if _is_unit(unit) else "" for unit in units), _OF_LOGGER, 1)


def _of_recorder(rows: Sequence[Sequence[str]], width: int) -> Header | None:
    """The header of settings for each channel, below which the cells under their names are empty (Yokogawa)."""
    said = {row[0].strip(): [cell.strip() for cell in row[1:width]] for row in rows if row[0].strip()}
    first = next((k for k, row in enumerate(rows) if not row[0].strip() and _has_number(row)), 0)
    if not first or not all(len(said.get(label, ())) == width - 1 for label in _RECORDER):
        return None
    names, units = (("", *said[label]) for label in _RECORDER)
    return Header(names, units, first, first)


def _labelled(rows: Sequence[Sequence[str]], width: int) -> Header | None:
    """The header whose rows say what they hold (`Name`, `Unit`) in a cell before the columns, else above the first."""
    end = _first_numbers(rows, width)
    before, within = ({}, {})
    for row in rows[:end]:
        label = next((what for what, one in _LABELS.items() if one.match(row[0].strip())), None)
        if label and filled(row) == width + 1:
            before[label] = tuple(cell.strip() for cell in row[1 : width + 1])
        elif label and filled(row) == width and row[0] not in row[1:]:  # above a column of times or numbers of rows
            within[label] = ("", *(cell.strip() for cell in row[1:width]))
    found = before if "names" in before or len(within) < len(_LABELS) else within
    return Header(found["names"], found.get("units", ()), end, end) if "names" in found else None


def _in_pairs(rows: Sequence[Sequence[str]], width: int) -> Header | None:
    """The header whose labels stand again before every channel (NI: `Channel name,Force,Channel name,Torque`)."""
    end = _first_numbers(rows, width)
    found: dict[str, list[str]] = {}
    is_timed = False
    for row in rows[:end] if width > 2 and width % 2 == 0 else ():
        labels = {cell.strip() for cell in row[:width:2]}
        label = labels.pop() if len(labels) == 1 and filled(row) == width else ""
        is_timed |= bool(_BEGUN.match(label))
        found |= {what: [cell.strip() for cell in row[1:width:2]] for what, one in _LABELS.items() if one.match(label)}
    if "names" not in found:
        return None
    units = found.get("units", [""] * (width // 2))
    names = [either for name in found["names"] for either in (f"Time of {name}" if is_timed else "", name)]
    return Header(tuple(names), tuple(cell for unit in units for cell in ("s" * is_timed, unit)), end, end - len(found))


def _first_numbers(rows: Sequence[Sequence[str]], width: int) -> int:
    """The first row that holds numbers alone, one in every column; 0 without one."""
    return next((k for k, row in enumerate(rows) if filled(row) == width and all(map(is_written, row[:width]))), 0)


def _of_two_rows(upper: list[str], lower: list[str], first: int) -> Header | None:
    """The header of two rows of names, of which the lower one says the unit of time; None of any other two.

    Where the upper one is generic, `Analog 1`, the lower one names the column if no other bears that name.
    """
    said = [cell.strip("[]() ") for cell in lower]
    units = [one if _is_unit(one) or multiple_of_a_unit(one) else "" for one in said]
    by_time = [is_time(unit) for name, unit in zip(upper, units, strict=True) if unit and NAMED.search(name)]
    if not any(by_time) or is_units(lower):
        return None
    own = [bool(one) and not unit and lower.count(one) == 1 for one, unit in zip(lower, units, strict=True)]
    taken = [k for k, name in enumerate(upper) if own[k] and _GENERIC.match(name) and lower[k] not in upper]
    names = tuple(lower[k] if k in taken else name for k, name in enumerate(upper))
    left = dict.fromkeys(one for k, one in enumerate(lower) if one and not units[k] and k not in taken)
    says = "of two rows of names the lower one gives units"
    says += "".join(f", '{lower[k]}' for '{upper[k]}'" for k in taken)
    says += f"; left out of it: {', '.join(left)}" if left else ""
    units = tuple(unit or bracket_unit(name) or "" for unit, name in zip(units, names, strict=True))
    return Header(names, units, first, first - 2, says)


def _uncommented(row: Sequence[str]) -> Sequence[str]:
    return [_COMMENTED.sub("", row[0]), *row[1:]]


def _names(row: Sequence[str], width: int) -> Sequence[str]:
    """A row of texts, without a sign of comment before them and with units in brackets beside their names.

    Names with blanks or another sign between them may stand above values with other signs between them.
    """
    if filled(row) == 1 < width and (said := parted_otherwise(row[0], width)):
        return said
    if filled(row) <= width and row[0].strip() not in _COMMENTS:
        return row
    cells = [cell for cell in row if cell.strip()]
    cells = cells[1:] if cells[0].strip() in _COMMENTS else cells
    joined: list[str] = []
    for cell in cells:
        if joined and cell.strip()[0] in "([":
            joined[-1] += f" {cell.strip()}"
        else:
            joined.append(cell)
    return joined if len(joined) == width else row


def parted_otherwise(line: str, width: int) -> list[str]:
    """The names that a line holds without the sign between the values, as many as these; [] where it holds none."""
    for sign in _CELL_SIGNS:
        cells = [cell.strip() for cell in line.split(sign)]
        if len(cells) == width and all(_IS_NAME.search(cell) for cell in cells):
            return cells
    apart = [cell for cell in re.split(r"\s{2,}", line.strip()) if cell]
    if len(apart) == width and all(_IS_NAME.search(cell) and not _IN_PROSE.search(cell) for cell in apart):
        return apart
    words = line.split()
    is_prose = any(_IN_PROSE.search(word) or not _IS_NAME.search(word) for word in words)
    return words if len(words) == width and not is_prose else []


def _names_by_numbers(rows: Sequence[Sequence[str]], width: int) -> bool:
    """Whether the first of some rows names columns by numbers (`Zeit,1,2`, pandas: `,0,1`), and the others are values.

    Beside a word, or where they count the columns: behind an empty cell, or above numbers that all have decimals.
    """
    first, *others = [[cell.strip() for cell in row[:width]] for row in rows]
    if len(others) < _TABLE or not all(filled(row) == width and all(map(is_written, row)) for row in others):
        return False
    words = [cell for cell in first if not is_absent(cell) and not is_written(cell)]
    if words or width == 1 or filled(first) < width:
        return bool(words) and filled(first) == width
    begin = _COUNTED_FROM.get(first[1], 0)
    counted = [str(begin + k) for k in range(width)]
    has_decimals = all(re.search("[.,]", cell) for row in others for cell in row)
    return first[1:] == counted[1:] and (not first[0] or (first[0] == counted[0] and has_decimals))


def _are_numbered(row: Sequence[str], width: int) -> bool:
    """Whether a row names its columns by the numbers of channels behind the name of the first (`x-axis,1,2`)."""
    first, *others = [cell.strip() for cell in row[:width]]
    counted = [cell for cell in others if cell.isdecimal()]
    return filled(row) == width > 1 and not is_number(first) and others == counted == list(dict.fromkeys(counted))


def bracket_unit(name: str) -> str | None:
    """What stands in brackets at the end of a name, or within it, or at its end without any where that is a unit.

    A unit of several factors (`acc_m/s^2`) goes before one behind a quantity's first stroke (`a/(m/s^2)`, `Weg/mm`).
    """
    if _INDEX.search(name) or _ARGUMENT.match(name):
        return None
    if scaled := factor_in(name):
        return scaled
    found = _BRACKETS.search(name)
    if found is not None and (said := unit_said(found[1])):
        return said
    within = [one.strip() for one in _WITHIN.findall(name)]
    units = [said for one in within if not is_number(one) and (said := unit_said(one))]
    if len(units) == 1:
        return units[0]
    if found is not None:
        return None if is_number(found[1]) else found[1].strip()
    if (said := _IN.search(name)) and _is_unit(said[1]):
        return said[1]
    if (behind := _COMMA.match(name)) and is_known(said := as_ours(behind[1])) and _is_hardly_a_word(behind[1], said):
        return said
    if compound := compound_at_end(name):
        return compound
    behind = _SLASH.search(name.strip())
    return behind[1] if behind is not None and (_is_unit(behind[1]) or scaled_unit(behind[1])) else None


def _is_hardly_a_word(text: str, unit: str) -> bool:
    """Whether a unit behind a comma is one: a letter may as well be a side or an axis, but for that of seconds."""
    return len(unit) > 1 or unit == "s" or not text.isascii()


def is_among_words(name: str, unit: str) -> bool:
    """Whether the unit of a column stands beside other words in the brackets of its name, `(mm, LP 1kHz)`."""
    within = [one.strip() for one in _WITHIN.findall(name)]
    return unit not in within and any(unit_said(one) == unit for one in within)


def _has_number(row: Sequence[str]) -> bool:
    return any(is_written(cell) for cell in row)


def _first_values(rows: Sequence[Sequence[str]], width: int) -> int:
    """The first row of values: settings may be numbers too, but a table goes on for a few rows without one of texts.

    Settings of a name and a number each look like values of two columns, where a line of texts stands below them; so do
    numbers alone that are fewer than the columns.
    """
    texts = [not _has_number(row) for row in rows]
    values = (k for k, row in enumerate(rows) if _is_values(row, width))
    first = next((k for k in values if not any(texts[k : k + _TABLE])), len(rows))
    words = [_is_word(row[0]) for row in rows]
    named = (k for k in range(first + 1, len(rows) - _TABLE) if texts[k - 1])
    settings = [is_word or filled(row) < width for is_word, row in zip(words, rows, strict=True)]
    below = (k for k in named if all(settings[first:k]) and all(map(is_written, rows[k][:width])))
    return next((k for k in below if not any(words[k:])), first)


def _is_word(cell: str) -> bool:
    """Whether a cell says something, and neither a number nor that there is none."""
    return bool(cell.strip()) and not is_absent(cell) and not is_written(cell)


def _is_values(row: Sequence[str], width: int) -> bool:
    """Whether a row holds numbers alone, or is as wide as the values and at least half of it are numbers."""
    said = [cell for cell in row if cell.strip()]
    numbers = sum(is_written(cell) for cell in said)
    return numbers > 0 and (numbers == len(said) or (filled(row) >= width and 2 * numbers >= len(said)))


def filled(row: Sequence[str]) -> int:
    """The cells of a row up to its last one that is not empty."""
    return max((k + 1 for k, cell in enumerate(row) if cell.strip()), default=0)


def is_units(row: Sequence[str]) -> bool:
    """Whether a row of texts holds units and nothing else, at least one of them; in brackets some may be unknown."""
    cells = [cell.strip("[]() ") for cell in row]
    named = [cell for cell in cells if cell not in _NO_UNIT]
    counts = any if all(_IN_BRACKETS.fullmatch(cell.strip()) for cell in row) else all
    return bool(named) and not _has_number(row) and counts(_is_unit(as_ours(cell)) for cell in named)


def without_label(row: Sequence[str]) -> list[str]:
    """The cells of a row of units without what says that they are some: `Unit` in a cell of its own, `Units: s`."""
    return [_LABEL.sub("", row[0].strip()), *row[1:]] if row else []


def _is_unit(cell: str) -> bool:
    try:
        parse_unit(cell)
    except InputError:
        return False
    return True
