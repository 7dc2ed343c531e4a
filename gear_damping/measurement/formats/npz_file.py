"""NPZ archives of numpy arrays; nothing in them is ever executed."""

from pathlib import Path
from zipfile import BadZipFile, ZipFile

import numpy as np

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.table import ArrayTable, Table, refuse_size, split_arrays


def read_npz(path: Path, max_bytes: int) -> Table:
    """The arrays of an NPZ file as columns.

    Raises:
        InputError: not an NPZ file, too large when unpacked, or it holds Python objects.
    """
    try:
        with ZipFile(path) as archive:
            refuse_size(path, sum(member.file_size for member in archive.infolist()), max_bytes)
        with np.load(path, allow_pickle=False) as archive:
            return ArrayTable(path, split_arrays({name: archive[name] for name in archive.files}))
    except InputError:
        raise
    except (ValueError, OSError, EOFError, BadZipFile) as error:
        remedy = "save plain numeric arrays with numpy.savez"
        raise InputError(Problem("file", f"not a readable NPZ file ({error})", str(path), remedy)) from None
