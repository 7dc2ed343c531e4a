"""Files that may kill the library that reads them: tried once in a copy of this process, whose end is a message."""

import faulthandler
import os
import signal
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.table import Table

PATIENCE, SLOWEST = 30.0, 2e6  # s that any file may take, and more of them for bytes of the slowest disk, bytes/s
FIRST_LOOK, LAST_LOOK = 5e-4, 0.05  # s between two looks at the copy, longer each time


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
