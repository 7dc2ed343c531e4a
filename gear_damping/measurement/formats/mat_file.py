"""MATLAB files up to version 7 (`save -v7`, the default)."""

from pathlib import Path

import numpy as np
from scipy.io import loadmat, whosmat

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.table import ArrayTable, Table, refuse_size, split_arrays

_HDF5_MAGIC = b"\x89HDF"


def read_mat(path: Path, max_bytes: int) -> Table:
    """The numeric variables of a MAT file as columns; structures and cells are left out.

    Raises:
        InputError: a version 7.3 file, an unreadable or a too large one.
    """
    with path.open("rb") as file:
        head = file.read(128)
        file.seek(512)
        hdf5 = head.startswith((b"MATLAB 7.3", _HDF5_MAGIC)) or file.read(4) == _HDF5_MAGIC
    if hdf5:
        rule = "a MAT 7.3 (HDF5) file needs the extra [formats] (h5py), which is not installed"
        raise InputError(Problem("file", rule, str(path), "save it in MATLAB with `save -v7`"))
    try:
        refuse_size(path, sum(8 * int(np.prod(shape)) for _, shape, _ in whosmat(path)), max_bytes)
        content = loadmat(path)
    except InputError:
        raise
    except Exception as error:  # scipy raises whatever a damaged file leads it to
        remedy = "save it in MATLAB with `save -v7`"
        raise InputError(Problem("file", f"not a readable MAT file ({error})", str(path), remedy)) from None
    arrays = {name: array for name, array in content.items() if not name.startswith("__")}
    return ArrayTable(path, split_arrays({n: a for n, a in arrays.items() if isinstance(a, np.ndarray)}))
