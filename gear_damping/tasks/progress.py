"""Progress of long work on the terminal."""

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

LINE_EVERY = 20.0  # seconds between lines where there is no terminal to draw a bar on


@contextmanager
def progress_bar(title: str, wanted: bool = True) -> Iterator[Callable[[int, int], None]]:
    """A callable (done, total): a bar on a terminal, a line every so often elsewhere, however long a step takes."""
    if not wanted:
        yield lambda done, total: None
    elif sys.stderr.isatty():
        columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn())
        with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task(title)
            yield lambda done, total: bar.update(task, completed=done, total=total)
    else:
        with _lines(title) as report:
            yield report


@contextmanager
def _lines(title: str) -> Iterator[Callable[[int, int], None]]:
    begun, percent, ended = time.monotonic(), 0.0, threading.Event()

    def report(done: int, total: int) -> None:
        nonlocal percent
        percent = 100 * done / total

    def speak() -> None:
        while not ended.wait(LINE_EVERY):
            print(f"{title}: {percent:.0f} %, {time.monotonic() - begun:.0f} s so far", file=sys.stderr, flush=True)

    speaker = threading.Thread(target=speak, daemon=True)
    speaker.start()
    try:
        yield report
    finally:
        ended.set()
        speaker.join()
