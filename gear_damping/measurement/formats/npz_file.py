"""Arrays of numpy, one in an NPY file or several in an NPZ archive; nothing in them is ever executed."""

from dataclasses import replace
from pathlib import Path
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.formats.names_beside import named_columns, text_lists
from gear_damping.measurement.formats.not_applied import said_beside
from gear_damping.measurement.formats.stated_rate import rate_beside
from gear_damping.measurement.formats.table import ArrayTable, Table, held_arrays, is_real, refuse_size, unreadable
from gear_damping.measurement.formats.units_beside import units_beside

SUFFIXES = (".npz", ".npy")


def read(path: Path, max_bytes: int) -> Table:
    """The arrays of an NPZ file as columns, or those of the one array of an NPY file; fields of a structured one too.

    Raises:
        InputError: neither of them, too large when unpacked, or it holds Python objects.
    """
    kind = path.suffix[1:].upper()
    with unreadable(path, f"not a readable {kind} file", "save plain numeric arrays with numpy.savez"):
        if kind == "NPY":
            return ArrayTable(path, *held_arrays(_fields("", np.load(path, allow_pickle=False))))
        with ZipFile(path) as archive:
            refuse_size(path, sum(member.file_size for member in archive.infolist()), max_bytes)
        with np.load(path, allow_pickle=False) as archive:
            parts = [_fields(name, archive[name]) for name in archive.files]
    arrays = {name: array for part in parts for name, array in part.items()}
    held, left_out = held_arrays(arrays)
    texts = {name: str(one.item()) for name, one in arrays.items() if one.dtype.kind == "U" and one.size == 1}
    units = units_beside((one.name for one in held if max(one.shape) > 1), texts)
    held = [replace(one, unit=units.get(one.name, one.unit)) for one in held]
    table = ArrayTable(path, named_columns(held, text_lists({}, arrays)), left_out)
    single = {name: one.item() for name, one in arrays.items() if one.size == 1 and is_real(one.dtype)}
    table.notes += said_beside(path.name, single)
    table.stated_rate = rate_beside(arrays, texts)
    return table


def _fields(name: str, array: NDArray) -> dict[str, NDArray]:
    if array.dtype.names is None:
        return {name: array}
    return {f"{name}.{field}" if name else field: array[field] for field in array.dtype.names}
