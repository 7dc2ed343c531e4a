"""NPZ archives of numpy arrays; nothing in them is ever executed."""

from pathlib import Path
from zipfile import ZipFile

import numpy as np

from gear_damping.measurement.formats.table import ArrayTable, Table, held_arrays, refuse_size, unreadable

SUFFIXES = (".npz",)


def read(path: Path, max_bytes: int) -> Table:
    """The arrays of an NPZ file as columns.

    Raises:
        InputError: not an NPZ file, too large when unpacked, or it holds Python objects.
    """
    with unreadable(path, "not a readable NPZ file", "save plain numeric arrays with numpy.savez"):
        with ZipFile(path) as archive:
            refuse_size(path, sum(member.file_size for member in archive.infolist()), max_bytes)
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    return ArrayTable(path, *held_arrays(arrays))
