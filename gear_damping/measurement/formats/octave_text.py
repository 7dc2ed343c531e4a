"""What Octave saves as text (`save -text`): several variables one after another, each under its name and its size."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.formats.table import ArrayTable, held_arrays

_VARIABLE, _SAID = re.compile(r"^# name: (\w+)\n", re.MULTILINE), re.compile(r"^# (\w+): ?(.*)$", re.MULTILINE)
_ROUNDING = 1e-12  # of the number of steps of a range, whose limit is one of its values all the same
_MOST = 1e8  # values of a range: a few letters must not fill the memory
BEGIN = b"# Created by Octave"


def octave_table(path: Path, text: bytes, fewest: int = 2) -> ArrayTable | None:
    """The numbers of a file of variables; None of any other file, of fewer variables, and of one that is not whole.

    The lines of a single one are a table like any other.
    """
    if not text.startswith(BEGIN):
        return None
    _, *parts = _VARIABLE.split(text.decode("utf-8", "replace").replace("\r\n", "\n"))
    if len(parts) < 2 * fewest:
        return None
    try:
        found = {name: _array(block) for name, block in zip(parts[::2], parts[1::2], strict=True)}
    except ValueError:  # fewer numbers than it says, or complex ones
        return None
    arrays = {name: one for name, one in found.items() if one is not None}
    arrays = dict(sorted(arrays.items(), key=lambda named: named[1].size == 1))  # single numbers are no columns yet
    held, left_out = held_arrays(arrays)
    return ArrayTable(path, held, left_out + [f"{name} (no numbers)" for name, one in found.items() if one is None])


def _array(block: str) -> NDArray[np.float64] | None:
    """What is below the name of a variable: a matrix, a single number or a range; None of what holds no numbers."""
    said = dict(_SAID.findall(block))
    cells = "\n".join(line for line in block.splitlines() if not line.startswith("#")).split()
    kind = said.get("type", "")
    if kind == "matrix" and {"rows", "columns"} <= {*said}:
        return np.array(cells, dtype=np.float64).reshape(int(said["rows"]), int(said["columns"]))
    if kind == "scalar":
        return np.array(cells, dtype=np.float64).reshape(1)
    if kind.endswith("range"):
        base, limit, step = np.array(cells[:3], dtype=np.float64)
        count = np.floor((limit - base) / step * (1 + _ROUNDING)) + 1 if step else 0.0
        if not 0 < count < _MOST:
            raise ValueError
        return base + step * np.arange(count)
    return None
