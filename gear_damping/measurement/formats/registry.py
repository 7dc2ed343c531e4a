"""From the suffix of a file to its reader."""

from collections.abc import Callable
from pathlib import Path
from types import MappingProxyType

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.csv_file import read_csv
from gear_damping.measurement.formats.hdf5_file import read_hdf5
from gear_damping.measurement.formats.mat_file import read_mat
from gear_damping.measurement.formats.npz_file import read_npz
from gear_damping.measurement.formats.table import Table, refuse_size
from gear_damping.measurement.formats.tdms_file import read_tdms
from gear_damping.measurement.formats.uff_file import read_uff
from gear_damping.measurement.formats.wav_file import read_wav
from gear_damping.measurement.formats.xlsx_file import read_xlsx

MAX_BYTES = 512 * 1024**2
Reader = Callable[[Path, int], Table]

READERS: MappingProxyType[str, Reader] = MappingProxyType(
    {
        **dict.fromkeys((".csv", ".txt", ".tsv", ".dat", ".asc", ".gz"), read_csv),
        **dict.fromkeys((".h5", ".hdf5", ".hdf"), read_hdf5),
        **dict.fromkeys((".uff", ".unv", ".uff58"), read_uff),
        ".mat": read_mat, ".npz": read_npz, ".tdms": read_tdms, ".wav": read_wav, ".xlsx": read_xlsx,
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
    if suffix not in READERS:
        known = ", ".join(sorted(READERS))
        raise InputError(Problem("file", f"unknown format '{suffix}'", str(path), f"known are {known}"))
    size = path.stat().st_size
    if size == 0:
        raise InputError(Problem("file", "the file is empty", str(path), "export it again"))
    refuse_size(path, size, max_bytes)
    return READERS[suffix](path, max_bytes)
