"""Units and names that lines above a table say: `X Units: ms`, `Disp: mm`, a row of units, `Column 1: Time [ms]`."""

import re
from collections.abc import Iterable, Sequence

from gear_damping.measurement.formats.bracket_words import is_known
from gear_damping.measurement.formats.header import bracket_unit, is_units, without_label
from gear_damping.measurement.formats.unit_words import as_ours
from gear_damping.measurement.time_column import NAMED, is_time
from gear_damping.units import is_of_kind

_AXIS = re.compile(
    r"^[#%/;*! ]*(?:(?P<first>x|horizontal)|y|vertical)[ _-]*(?:axis[ _-]*)?units?\s*[:=\t ]\s*(?P<unit>\S+)\s*$", re.I
)
_ALONE = re.compile(r"^[#%/;*! ]*(?:units?|einheit)\s*[:=]\s*(?P<unit>\S+)\s*$", re.I)
_SIGNS = "#%/;*! \t"  # before a line
_OF_A_CURVE = 2  # columns: beside more of them nobody says which is the other axis
_BEHIND_A_NAME = re.compile(r"\s*[:=]\s*|\s+(?=[\[(])")
_LISTED = re.compile(  # `Column 1: Time [ms]`, `# col0: time (s)`, `Kanal 2 = Weg in mm`
    r"^(?:[#%/;*! ]*(?:col(?:umn)?|spalte|colonne|columna|colonna|channel|chan|ch|kanal|signal)\.?[ _#]*|[#%][#% ]*)"
    r"(?P<number>\d+)\s*[:=)\-]\s*(?P<name>[^\W\d_].*?)\s*$",
    re.I,
)
_SIDE = "A"  # as often that of a machine, or a mode


def axis_units(above: Iterable[Sequence[str]], width: int, numbered: bool = False) -> dict[int, str]:
    """The units of the first column and of the second; {} where none is said, or there are more columns.

    Args:
        above: The cells of the lines above the table.
        width: The number of its columns.
        numbered: Whether a column before them counts the rows.
    """
    lines = [" ".join(cell.strip().strip('"') for cell in row if cell.strip()) for row in above]
    found = [one for line in lines if (one := _AXIS.match(line)) and is_known(one["unit"])]
    units = {numbered + (0 if one["first"] else 1): one["unit"] for one in found}
    if width != _OF_A_CURVE + numbered or len(units) != len(found):
        return {}
    alone = [one["unit"] for line in lines if (one := _ALONE.match(line)) and _is_said(one["unit"])]
    alone = [unit for unit in alone if not is_of_kind(unit, "s")]
    return units or ({numbered + 1: alone[0]} if len(alone) == 1 else {})


def units_of_names(above: Iterable[Sequence[str]], names: Sequence[str]) -> dict[int, str]:
    """The units of columns by their places, as a row of units or lines that begin with a name say them.

    Args:
        above: The cells of the lines above the table, that of the names among them.
        names: Of the columns, "" for none.
    """
    names = [name.strip() for name in names]
    above = list(above)
    listed = [bracket_unit(one) or "" for one in listed_names(above, len(names), " ")]
    found = {k: unit for k, one in enumerate(listed) if is_known(unit := as_ours(one))}
    for row in above:
        cells = [row[0].lstrip(_SIGNS), *row[1:]] if row else [""]
        cells = [cell.strip(" \t\"'") for cell in cells]
        if sum(cell in names for cell in cells if cell) > 1:
            continue  # the names themselves
        found |= _row_of_units(cells, names) or _unit_of_one(cells, names)
    return found


def listed_names(above: Iterable[Sequence[str]], width: int, sign: str) -> tuple[str, ...]:
    """The names of all columns, where lines above the table list them by their numbers from 0 or 1 on; else ().

    Args:
        above: The cells of the lines above the table.
        width: The number of its columns.
        sign: What parts its cells.
    """
    found = [one for row in above if (one := _LISTED.match(sign.join(row)))]
    numbers = [int(one["number"]) for one in found]
    is_whole = len(numbers) == width and numbers in (list(range(width)), list(range(1, width + 1)))
    return tuple(one["name"] for one in found) if is_whole else ()


def _row_of_units(cells: Sequence[str], names: Sequence[str]) -> dict[int, str]:
    """The units of all columns, where a line is made of them: `s,mm,g`, `Units: s mm g`; {} of any other line."""
    units = without_label(cells)
    units = [as_ours(one.strip("[]() ")) for one in (units if len(units) > 1 else units[0].split())]
    if not len(units) == len(names) > 1 or not is_units(units):
        return {}
    if any(
        NAMED.search(name) and is_known(unit) and not is_time(unit) for name, unit in zip(names, units, strict=True)
    ):
        return {}  # of ranges, `V,V,V`
    return {k: unit for k, unit in enumerate(units) if is_known(unit)}


def _unit_of_one(cells: Sequence[str], names: Sequence[str]) -> dict[int, str]:
    """The unit of the column whose name a line begins with: `Disp: mm`, `Disp [mm]`, `Disp,mm,10`; {} without one."""
    told = cells if len(cells) > 1 else _BEHIND_A_NAME.split(cells[0], maxsplit=1)
    name, *behind = [cell for cell in told if cell] or [""]
    places = [k for k, one in enumerate(names) if one and one.lower() == name.lower().rstrip(" :=")]
    unit = as_ours(behind[0].strip("[]() ")) if behind else ""
    unit = unit if _is_said(unit) or not behind else as_ours(bracket_unit(behind[0]) or "")
    return {places[0]: unit} if len(places) == 1 and _is_said(unit) else {}


def _is_said(text: str) -> bool:
    """Whether a text is a unit, and hardly anything else; `raw` and `steps` may be how something was set."""
    return text != _SIDE and is_known(text) and not is_of_kind(text, "1")
