"""Who works on a run: a file in its folder that is held while the work goes on, and told stale when the worker is gone.

On the host of the worker a process that is gone is dead at once; on another host the file must change (it does every
few seconds), or the worker counts as dead. What run.json of a run without a live worker says last may be `running`.
"""

import json
import logging
import os
import socket
import threading
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

NAME = "lease.json"
BEAT = 10.0  # s between two signs of life
SILENCE = 60.0  # s without one, after which a worker on another host counts as dead
LOOK = 2.0  # s between two looks at a lease that another holds
log = logging.getLogger("gear_damping")


@contextmanager
def leased(folder: Path) -> Iterator[None]:
    """Hold the lease of a folder; waits while another holds it.

    Args:
        folder: Of the run; made where it is missing.

    Raises:
        OSError: it cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    own = _Own(folder / NAME)
    _wait_for(own)
    over = threading.Event()
    beating = threading.Thread(target=own.beat, args=(over,), daemon=True)
    beating.start()
    try:
        yield
    finally:
        over.set()
        beating.join()
        own.release()


def is_held(folder: Path) -> bool:
    """Whether somebody alive holds the lease of a folder: told at once, of another host by the age of its last sign."""
    path = folder / NAME
    content = _read(path)
    if content is None:
        return False
    holder = _holder(content)
    if holder and holder["host"] == host():
        return not _is_gone(content)
    with suppress(FileNotFoundError):
        return time.time() - path.stat().st_mtime <= SILENCE
    return False


class _Own:
    """The lease as this process would hold it."""

    def __init__(self, path: Path) -> None:
        self.path, self.token, self.beats = path, uuid.uuid4().hex, 0

    @property
    def content(self) -> str:
        pid = os.getpid()
        return json.dumps({"host": host(), "pid": pid, "begun": begun(pid), "token": self.token, "beats": self.beats})

    def take(self) -> bool:
        """Whether the file is ours now: it is linked into place, which only one of several can."""
        written = self._written()
        try:
            os.link(written, self.path)
        except FileExistsError:
            return False
        except OSError:  # a file system without links
            return self._taken_plainly()
        finally:
            written.unlink()
        return True

    def _taken_plainly(self) -> bool:
        try:
            with self.path.open("x") as file:
                file.write(self.content)
        except FileExistsError:
            return False
        return True

    def take_over(self, dead: str) -> bool:
        """Whether it is ours now, in the place of a dead one; the path is never without a lease meanwhile."""
        lock = self.path.with_name(f"{NAME}.takeover")
        try:
            os.close(os.open(lock, os.O_CREAT | os.O_EXCL))
        except FileExistsError:  # another is at it, or died over it
            with suppress(FileNotFoundError):
                if time.time() - lock.stat().st_mtime > SILENCE:
                    lock.unlink()
            return False
        try:
            if _read(self.path) != dead:
                return False
            os.replace(self._written(), self.path)
            return True
        finally:
            lock.unlink(missing_ok=True)

    def beat(self, over: threading.Event) -> None:
        """Sign of life until it is over; a disk that is full for a while does not end the work."""
        while not over.wait(BEAT):
            self.beats += 1
            with suppress(OSError):
                if self._is_ours:
                    os.replace(self._written(), self.path)

    def release(self) -> None:
        """Leave it to others."""
        if self._is_ours:
            self.path.unlink(missing_ok=True)

    @property
    def _is_ours(self) -> bool:
        """Whether nobody took it over, as after a long sleep of this machine."""
        return _holder(_read(self.path)).get("token") == self.token

    def _written(self) -> Path:
        path = self.path.with_name(f"{NAME}.{self.token}.part")
        path.write_text(self.content)
        return path


def _wait_for(own: _Own) -> None:
    """Until the lease is ours."""
    seen, since, said = None, time.monotonic(), False
    while not own.take():
        content = _read(own.path)
        if content is None:  # released in between
            continue
        if content != seen:
            seen, since = content, time.monotonic()
        if _is_gone(content) or time.monotonic() - since > SILENCE:
            if own.take_over(content):
                return
            time.sleep(LOOK / 10)
            continue
        if not said:
            holder = _holder(content)
            who = f"process {holder['pid']} on {holder['host'].split()[0]}" if holder else "another process"
            log.warning("%s: %s works on it; waiting", own.path.parent, who)
            said = True
        time.sleep(LOOK)


def _is_gone(content: str) -> bool:
    """Whether the holder was a process of this host that is no more."""
    holder = _holder(content)
    return bool(holder) and holder["host"] == host() and begun(holder["pid"]) != holder["begun"]


def host() -> str:
    """This host, since it was started: after that no process of before is left."""
    boot = Path("/proc/sys/kernel/random/boot_id")
    return f"{socket.gethostname()} {boot.read_text().strip()}" if boot.exists() else socket.gethostname()


def begun(pid: int) -> str | None:
    """When a process of this host was started, in a form that no later one of the same number has; None: no process."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return None
    except PermissionError:  # of another user
        pass
    state = Path(f"/proc/{pid}/stat")
    try:
        fields = state.read_text().rpartition(")")[2].split()
    except OSError:
        return "" if not Path("/proc/self/stat").exists() else None
    return None if fields[0] == "Z" else fields[19]  # a zombie does nothing any more


def _read(path: Path) -> str | None:
    """The content of a lease; None where there is none."""
    try:
        return path.read_text()
    except FileNotFoundError:
        return None


def _holder(content: str | None) -> dict[str, Any]:
    """What a lease says of its holder; empty where it was cut off, by a full disk for example."""
    with suppress(ValueError, TypeError):
        found = json.loads(content)
        if isinstance(found, dict) and {"host", "pid", "begun", "token"} <= set(found):
            return found
    return {}
