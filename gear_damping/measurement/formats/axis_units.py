"""The units of the axes that lines above a table of two columns say: `X Units: ms`, `Vertical Units,V`."""

import re
from collections.abc import Iterable, Sequence

from gear_damping.measurement.formats.bracket_words import is_known

_AXIS = re.compile(
    r"^[#%/;*! ]*(?:(?P<first>x|horizontal)|y|vertical)[ _-]*(?:axis[ _-]*)?units?\s*[:=\t ]\s*(?P<unit>\S+)\s*$", re.I
)
_OF_A_CURVE = 2  # columns: beside more of them nobody says which is the other axis


def axis_units(above: Iterable[Sequence[str]], width: int, numbered: bool = False) -> dict[int, str]:
    """The units of the first column and of the second; {} where none is said, or there are more columns.

    Args:
        above: The cells of the lines above the table.
        width: The number of its columns.
        numbered: Whether a column before them counts the rows.
    """
    lines = (" ".join(cell.strip().strip('"') for cell in row if cell.strip()) for row in above)
    found = [one for line in lines if (one := _AXIS.match(line)) and is_known(one["unit"])]
    units = {numbered + (0 if one["first"] else 1): one["unit"] for one in found}
    return units if width == _OF_A_CURVE + numbered and len(units) == len(found) else {}
