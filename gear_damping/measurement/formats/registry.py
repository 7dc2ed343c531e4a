"""From the suffix of a file to its reader."""

from collections.abc import Callable
from pathlib import Path
from types import MappingProxyType

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.csv_file import read_csv
from gear_damping.measurement.formats.mat_file import read_mat
from gear_damping.measurement.formats.npz_file import read_npz
from gear_damping.measurement.formats.table import Table, refuse_size
from gear_damping.measurement.formats.wav_file import read_wav

MAX_BYTES = 512 * 1024**2
Reader = Callable[[Path, int], Table]

READERS: MappingProxyType[str, Reader] = MappingProxyType(
    {".csv": read_csv, ".txt": read_csv, ".mat": read_mat, ".npz": read_npz, ".wav": read_wav}
)
EXTRA_LIBRARY = MappingProxyType(
    {
        ".h5": "h5py", ".hdf5": "h5py", ".hdf": "h5py",
        ".unv": "pyuff", ".uff": "pyuff", ".uff58": "pyuff", ".tdms": "npTDMS",
    }
)  # fmt: skip


def read_table(path: Path, max_bytes: int = MAX_BYTES) -> Table:
    """The columns of a file.

    Args:
        path: An existing file.
        max_bytes: Larger files are refused before they are read.

    Raises:
        InputError: an unknown, missing or unreadable format, an empty or a too large file.
    """
    suffix = path.suffix.lower()
    if suffix in EXTRA_LIBRARY:
        rule = f"'{suffix}' files need the extra [formats] ({EXTRA_LIBRARY[suffix]}), which is not installed"
        raise InputError(Problem("file", rule, str(path), "export the channels as CSV, MAT v5, NPZ or WAV"))
    if suffix not in READERS:
        known = ", ".join(sorted({*READERS, *EXTRA_LIBRARY}))
        raise InputError(Problem("file", f"unknown format '{suffix}'", str(path), f"known are {known}"))
    size = path.stat().st_size
    if size == 0:
        raise InputError(Problem("file", "the file is empty", str(path), "export it again"))
    refuse_size(path, size, max_bytes)
    return READERS[suffix](path, max_bytes)
