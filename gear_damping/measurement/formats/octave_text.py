"""What Octave saves as text (`save -text`): several variables one after another, each under its name and its size."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.formats.table import ArrayTable, held_arrays

_VARIABLE = re.compile(
    r"^# name: (?P<name>\w+)\n# type: matrix\n# rows: (?P<rows>\d+)\n# columns: (?P<columns>\d+)\n", re.MULTILINE
)
_BEGIN = b"# Created by Octave"


def octave_table(path: Path, text: bytes) -> ArrayTable | None:
    """The matrices of a file of several; None of any other file, and of one that is not whole."""
    if not text.startswith(_BEGIN):
        return None
    content = text.decode("utf-8", "replace").replace("\r\n", "\n")
    found = list(_VARIABLE.finditer(content))
    arrays: dict[str, NDArray] = {}
    for one in found:
        rows, columns = int(one["rows"]), int(one["columns"])
        cells = content[one.end() :].partition("\n#")[0].split()
        if len(cells) != rows * columns:
            return None
        try:
            arrays[one["name"]] = np.array(cells, dtype=np.float64).reshape(rows, columns)
        except ValueError:  # complex numbers
            return None
    return ArrayTable(path, *held_arrays(arrays)) if len(arrays) > 1 else None
