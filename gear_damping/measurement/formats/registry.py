"""From the suffix of a file to its reader: every `*_file.py` of this room, and the user's own.

A file of a format says its `SUFFIXES`, and has `read(path, max_bytes)`, which gives a `Table`. One whose library a
damaged file may kill says `DEADLY = True`: it is tried once in a copy of this process, whose end is a message.
"""

import faulthandler
import inspect
import os
import signal
import sys
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from types import ModuleType

from gear_damping.errors import InputError, Problem, reading, with_article
from gear_damping.measurement import formats as room
from gear_damping.measurement.formats.table import Table, refuse_size
from gear_damping.own_files import REMEDY, classes_of, errors_in, load_module, modules_of

MAX_BYTES = 512 * 1024**2  # of a file: as text and as floats it is several times that in memory
KEY = "measurement.plugins"
# Formats that are not read, and how what is in them is brought into one that is.
BROUGHT = {
    **dict.fromkeys((".ods", ".xlsb"), "save it as an Excel workbook (.xlsx) or as CSV in the spreadsheet"),
    ".parquet": "write it as CSV, in Python pandas.read_parquet('{0}').to_csv('{1}.csv', index=False)",
    ".feather": "write it as CSV, in Python pandas.read_feather('{0}').to_csv('{1}.csv', index=False)",
    **dict.fromkeys(
        (".mf4", ".mdf", ".c3d", ".tdm"), "export its channels as CSV or MAT from the program that made it"
    ),
}
Reader = Callable[[Path, int], Table]
PATIENCE, SLOWEST = 30.0, 2e6  # s that any file may take, and more of them for bytes of the slowest disk, bytes/s
FIRST_LOOK, LAST_LOOK = 5e-4, 0.05  # s between two looks at the copy, longer each time


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
    if plugins:
        from gear_damping.physics.systems.base import System  # imports what takes long
    for path in map(Path, plugins):
        module = load_module(path, KEY)
        if not hasattr(module, "SUFFIXES") and classes_of(module, System):  # it declares what was measured
            continue
        faults = _faults(module)
        if faults:
            raise InputError([Problem(KEY, fault, str(path), REMEDY) for fault in faults])
        found |= dict.fromkeys(module.SUFFIXES, _own(module.read, path))
    return found


def _own(read: Reader, place: Path) -> Reader:
    """A user's own reader, whose errors are said as such, and which gives a table or nothing."""

    def guarded(path: Path, max_bytes: int) -> Table:
        with errors_in({str(place): KEY}):
            found = read(path, max_bytes)
        if not isinstance(found, Table):
            rule, remedy = (
                f"read gives {with_article(type(found).__name__)}",
                "return ArrayTable(path, [Held(...), ...])",
            )
            raise InputError(Problem(KEY, rule, str(place), remedy))
        return found

    return guarded


def _faults(module: ModuleType) -> list[str]:
    """What is missing or wrong in a file."""
    suffixes = getattr(module, "SUFFIXES", None)
    found = []
    texts = isinstance(suffixes, tuple) and suffixes and all(isinstance(one, str) for one in suffixes)
    if not texts or not all(one.startswith(".") and one == one.lower() for one in suffixes):
        found.append("lacks SUFFIXES, a tuple of suffixes in lower case such as ('.xyz',)")
    if not callable(read := getattr(module, "read", None)):
        return [*found, "lacks read(path, max_bytes), which gives a Table"]
    try:
        inspect.signature(read).bind(Path(), MAX_BYTES)
    except TypeError as error:
        found.append(f"read is called as read(path, max_bytes), and this one says: {error}")
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
        usual = f"add .txt to its name where it is a table in text, or save it as one of {', '.join(sorted(known))}"
        brought = BROUGHT.get(suffix, "").format(path.name, path.stem)
        remedy = f"{brought or usual}; a format of your own: {KEY}=[its file]"
        raise InputError(Problem("file", f"unknown format '{suffix}'", str(path), remedy))
    with reading(path), path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
    if size == 0:
        raise InputError(Problem("file", "the file is empty", str(path), "export it again"))
    refuse_size(path, size, max_bytes)
    if getattr(sys.modules.get(known[suffix].__module__), "DEADLY", False):
        refuse_deadly(known[suffix], path, max_bytes)
    return known[suffix](path, max_bytes)


def refuse_deadly(read: Callable[[Path, int], Table], path: Path, max_bytes: int) -> None:
    """Raise InputError where reading a file and all of its columns ends the process, or does not end.

    Whatever else is wrong with it is said when it is read in earnest. Where processes cannot be copied (Windows)
    nothing is tried.

    Args:
        read: The reader.
        path: The file.
        max_bytes: As the reader takes it.
    """
    if not hasattr(os, "fork"):
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of threads, of which the copy uses none
        child = os.fork()
    if child == 0:
        _read_all(read, path, max_bytes)
    status = _ended(child, PATIENCE + path.stat().st_size / SLOWEST)
    if status is None:
        raise InputError(Problem("file", "is damaged: reading it does not end", str(path), "export it again"))
    if os.WIFSIGNALED(status):
        name = signal.Signals(os.WTERMSIG(status)).name
        rule = f"is damaged: reading it ends the process ({name})"
        raise InputError(Problem("file", rule, str(path), "export it again"))


def _ended(child: int, seconds: float) -> int | None:
    """How a process ended; None where it took longer and was killed. An interruption kills it too."""
    look, over = FIRST_LOOK, time.monotonic() + seconds
    try:
        while True:
            done, status = os.waitpid(child, os.WNOHANG)
            if done:
                child = 0
                return status
            if time.monotonic() > over:
                return None
            time.sleep(look)
            look = min(1.5 * look, LAST_LOOK)
    finally:
        if child:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)


def _read_all(read: Callable[[Path, int], Table], path: Path, max_bytes: int) -> None:
    """Read everything and end this process, the copy."""
    try:
        faulthandler.disable()  # the message is ours
        with suppress(Exception):
            table = read(path, max_bytes)
            for index in range(len(table.names)):
                with suppress(Exception):
                    table.values(index)
    finally:
        os._exit(0)
