"""A worker of a launcher on this machine ends when the launching process is gone: nobody would take what it makes.

Workers of a cluster go on, and so do not ask.
"""

import os
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from typing import Any

from gear_damping.tasks.lease import begun

LAUNCHER = "GEAR_DAMPING_LAUNCHER"  # of the environment: number of the launching process, and when it was started
ON_THIS_MACHINE = "joblib"  # how the target of a launcher is called whose workers are children of the launching process
LOOK = 1.0  # s between two looks at the launching process
ORPHANED = 1  # exit code of a worker whose launching process is gone; nobody asks for it


@contextmanager
def launching() -> Iterator[None]:
    """Tell the workers that are started meanwhile who launches them."""
    pid, before = os.getpid(), os.environ.get(LAUNCHER)
    os.environ[LAUNCHER] = f"{pid} {begun(pid)}"
    try:
        yield
    finally:
        if before is None:
            del os.environ[LAUNCHER]
        else:
            os.environ[LAUNCHER] = before


def end_with_launcher(launcher: Mapping[str, Any]) -> None:
    """From now on this process ends when the one that launched it does; once is enough.

    Args:
        launcher: Its settings.
    """
    told = os.environ.get(LAUNCHER)
    if told is not None and ON_THIS_MACHINE in str(launcher.get("_target_")):
        _watch(told)


@cache
def _watch(told: str) -> None:
    """Look after the launching process; a watch of its own is none for whoever launches nobody."""
    pid = int(told.split(" ")[0])
    if pid != os.getpid():
        threading.Thread(target=_end_after, args=(pid, told), daemon=True).start()


def _end_after(pid: int, told: str) -> None:
    # Not the signal of a parent's death: it comes when the thread that started this process ends, as loky's does.
    while f"{pid} {begun(pid)}" == told:
        time.sleep(LOOK)
    os._exit(ORPHANED)  # at once: what was begun lies under a lease of nobody, and is taken up from there
