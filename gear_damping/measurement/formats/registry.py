"""From the suffix of a file to its reader: every `*_file.py` of this room, and the user's own.

A file of a format says its `SUFFIXES`, and has `read(path, max_bytes)`, which gives a `Table`. One whose library a
damaged file may kill says `DEADLY = True`.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType

from gear_damping.errors import InputError, Problem
from gear_damping.measurement import formats as room
from gear_damping.measurement.formats.guarded import refuse_deadly
from gear_damping.measurement.formats.table import Table, refuse_size
from gear_damping.own_files import REMEDY, load_module, modules_of

MAX_BYTES = 512 * 1024**2  # of a file: as text and as floats it is several times that in memory
KEY = "measurement.plugins"
Reader = Callable[[Path, int], Table]


@cache
def builtin_readers() -> dict[str, Reader]:
    """The readers that come with the package, by suffix."""
    modules = [module for module in modules_of(room) if hasattr(module, "SUFFIXES")]
    return {suffix: module.read for module in modules for suffix in module.SUFFIXES}


def readers(plugins: Sequence[str | Path] = ()) -> dict[str, Reader]:
    """Every reader by suffix; a user's own file may read a known suffix in another way.

    Raises:
        InputError: a file is missing, cannot be loaded, or is no reader.
    """
    found = dict(builtin_readers())
    for path in map(Path, plugins):
        module = load_module(path, KEY)
        faults = _faults(module)
        if faults:
            raise InputError([Problem(KEY, fault, str(path), REMEDY) for fault in faults])
        found |= dict.fromkeys(module.SUFFIXES, module.read)
    return found


def _faults(module: ModuleType) -> list[str]:
    """What is missing or wrong in a file."""
    suffixes = getattr(module, "SUFFIXES", None)
    found = []
    texts = isinstance(suffixes, tuple) and suffixes and all(isinstance(one, str) for one in suffixes)
    if not texts or not all(one.startswith(".") and one == one.lower() for one in suffixes):
        found.append("lacks SUFFIXES, a tuple of suffixes in lower case such as ('.xyz',)")
    if not callable(getattr(module, "read", None)):
        found.append("lacks read(path, max_bytes), which gives a Table")
    return found


def read_table(path: Path, max_bytes: int = MAX_BYTES, known: Mapping[str, Reader] | None = None) -> Table:
    """The columns of a file.

    Args:
        path: An existing file.
        max_bytes: Larger files are refused before they are read.
        known: Readers by suffix; those of the package where absent.

    Raises:
        InputError: an unknown, missing or unreadable format, an empty or a too large file.
    """
    suffix, known = path.suffix.lower(), builtin_readers() if known is None else known
    if suffix not in known:
        remedy = f"known are {', '.join(sorted(known))}; a format of your own: {KEY}=[its file]"
        raise InputError(Problem("file", f"unknown format '{suffix}'", str(path), remedy))
    size = path.stat().st_size
    if size == 0:
        raise InputError(Problem("file", "the file is empty", str(path), "export it again"))
    refuse_size(path, size, max_bytes)
    if getattr(sys.modules.get(known[suffix].__module__), "DEADLY", False):
        refuse_deadly(known[suffix], path, max_bytes)
    return known[suffix](path, max_bytes)
