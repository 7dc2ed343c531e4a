"""From the suffix of a file to its reader."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import MappingProxyType

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.table import Table, refuse_size

MAX_BYTES = 512 * 1024**2
Reader = Callable[[Path, int], Table]


def _reader(name: str) -> Reader:
    """The reader `read_<name>` of the file `<name>_file`, imported when it is first needed: its library takes long."""

    def read(path: Path, max_bytes: int) -> Table:
        module = import_module(f"gear_damping.measurement.formats.{name}_file")
        return getattr(module, f"read_{name}")(path, max_bytes)

    return read


READERS: MappingProxyType[str, Reader] = MappingProxyType(
    {
        **dict.fromkeys((".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm", ".gz"), _reader("csv")),
        **dict.fromkeys((".h5", ".hdf5", ".hdf"), _reader("hdf5")),
        **dict.fromkeys((".uff", ".unv", ".uff58"), _reader("uff")),
        **{f".{name}": _reader(name) for name in ("mat", "npz", "tdms", "wav", "xlsx")},
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
