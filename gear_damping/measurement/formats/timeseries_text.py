"""What seismologists save as text: a line `TIMESERIES` with the rate, and values one after another or beside stamps.

In SLIST a row holds several values of one channel, in TSPAIR a stamp and a value.
"""

import re
from datetime import datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.bracket_words import is_known
from gear_damping.measurement.formats.table import ArrayTable, Held

BEGIN = b"TIMESERIES "
_HEAD = re.compile(
    r"^TIMESERIES (?P<name>[^,\n]+), *(?P<count>\d+) samples, *(?P<rate>\d+(\.\d*)?([eE][+-]?\d+)?) sps, *"
    r"(?P<start>[^,\n]+), *(?P<layout>SLIST|TSPAIR), *\w+, *(?P<unit>[^\n]*)\n",
    re.MULTILINE,
)


def timeseries_table(path: Path, text: bytes) -> ArrayTable | None:
    """(n,) values of each stretch of a channel, which has its own clock in s from the first; None of any other file.

    Raises:
        InputError: something between the values is no number, or a stretch has none.
    """
    if not text.startswith(BEGIN):
        return None
    said = text.decode("utf-8", "replace").replace("\r\n", "\n")
    heads = list(_HEAD.finditer(said))
    if not heads or heads[0].start() or not all(float(head["rate"]) > 0 for head in heads):
        return None
    ends = [head.start() for head in heads[1:]] + [len(said)]
    begins = [_moment(head["start"]) for head in heads]
    held, notes = [], []
    for head, end, begin in zip(heads, ends, begins, strict=True):
        values = _values(path, head["layout"], said[head.end() : end])
        name = head["name"].strip() if len(heads) == 1 else f"{head['name'].strip()} {head['start'].strip()}"
        after = (begin - begins[0]).total_seconds() if begin and begins[0] else 0.0
        unit = head["unit"].strip()
        clock = (after, float(head["rate"]))
        held.append(Held(name, values.shape, lambda one=values: one, unit if is_known(unit) else None, clock))
        if values.size != int(head["count"]):
            notes.append(f"{path.name}: '{name}' is said to have {head['count']} samples, and has {values.size}")
    table = ArrayTable(path, held)
    table.notes += tuple(notes)
    return table


def _values(path: Path, layout: str, block: str) -> NDArray[np.float64]:
    """(n,) the numbers of a block, in the order in which they stand."""
    rows = [line.split() for line in block.splitlines() if line.strip()]
    cells = [cell for row in rows for cell in (row if layout == "SLIST" else row[1:])]
    try:
        values = np.array(cells, dtype=np.float64)
    except ValueError as error:
        rule = f"below its line TIMESERIES something is no number ({error})"
        raise InputError(Problem("file", rule, str(path), "export it again")) from None
    if not values.size:
        raise InputError(Problem("file", "a line TIMESERIES and no values below it", str(path), "export it again"))
    return values


def _moment(text: str) -> datetime | None:
    """When a stretch begins; None where that is written otherwise than by ISO 8601."""
    try:
        return datetime.fromisoformat(text.strip().rstrip("Z")).replace(tzinfo=None)  # all of one file on one clock
    except ValueError:
        return None
