"""What a program shows on its screen instead of saving it: a table of it would be read without what it leaves out."""

import re
from collections.abc import Sequence

from gear_damping.errors import InputError, Problem

_FACTOR = re.compile(r"^\s*(1\.0e[+-]\d+)\s*\*\s*$")  # MATLAB, above numbers that are shown without it
_COUNTED = re.compile(r"^\s*\[(\d+)\]\s+\S+\s+\S")  # R, before several values of one vector


def refuse_what_is_shown(path: str, lines: Sequence[str]) -> None:
    """Refuse a text that MATLAB or R has shown.

    Args:
        path: The file.
        lines: Its first lines.

    Raises:
        InputError: a factor stands above the numbers, or several values of one vector stand in each row.
    """
    if factor := next((found[1] for line in lines if (found := _FACTOR.match(line))), ""):
        rule = f"its numbers stand below '{factor} *', as MATLAB shows them, and are to be multiplied by that"
        raise InputError(Problem("file", rule, path, "save them with writematrix or writetable"))
    places = [int(found[1]) for line in lines if (found := _COUNTED.match(line))]
    if len(places) > 1 and places[0] == 1 and places[1] > 2:
        rule = f"it is one vector as R shows it, {places[1] - 1} values a line and the place of the first in brackets"
        raise InputError(Problem("file", rule, path, "save it with write.csv"))
