"""Tables of frames one below the other in one file, as Vicon exports forces and markers: none of them is all of it."""

import re

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.text_lines import Text

_BEGINS = re.compile(rb'^[ \t]*"?Frame"?[ \t]*[,;\t][ \t]*"?Sub Frame"?[ \t]*[,;\t]', re.MULTILINE)
_ABOVE = 4  # lines above the names of its columns in which the title of a table stands


def refuse_several_tables(text: Text) -> None:
    """Refuse a file of several tables of frames, each with a rate and columns of its own.

    Raises:
        InputError: names them.
    """
    begins = [found.start() for found in _BEGINS.finditer(text.utf8)]
    if len(begins) < 2:
        return
    titles = [title for begin in begins if (title := _title(text.utf8[:begin]))]
    named = f": {', '.join(titles)}" if len(titles) == len(begins) else ""
    rule = f"holds {len(begins)} tables one below the other, each with frames of its own{named}"
    remedy = "put each that is wanted into a file of its own, from its title on, or export it alone"
    raise InputError(Problem("file", rule, str(text.path), remedy))


def _title(above: bytes) -> str:
    """The last line of one cell that is no number, near the end of what stands above a table; "" where none is."""
    lines = above.decode("utf-8", "replace").splitlines()[-_ABOVE:]
    cells = [line.strip(' \t,;"') for line in lines]
    alone = [one for one in cells if one and not re.search(r"[,;\t]", one) and not re.fullmatch(r"[\d.]+", one)]
    return alone[0] if alone else ""
