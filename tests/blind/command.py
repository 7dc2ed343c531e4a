"""What the commands of long runs have in common."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STOPPED = "stopped; the cases done so far are kept, and the same command goes on from here"


def see_oracles() -> None:
    """Let this process and its workers import the oracles, each on one core."""
    os.environ["OMP_NUM_THREADS"] = "1"
    sys.path.insert(0, str(ROOT / "tests" / "oracles"))
    os.environ["PYTHONPATH"] = os.pathsep.join([str(ROOT / "tests" / "oracles"), str(ROOT)])  # of the workers


def stop_by_signals() -> None:
    """Ctrl-C and a request to end both raise KeyboardInterrupt, in the background too."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)


def shown(target: str, given: list[str] | None) -> str:
    """The command as a user types it."""
    words = sys.argv[1:] if given is None else given
    return f'{target} ARGS="{" ".join(words)}"' if words else target


def at_least_one(text: str) -> int:
    """A number of things of which there is at least one, as an argument."""
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of at least 1")
    return int(text)


def log(text: str) -> None:
    """Say a line at once."""
    print(text, flush=True)
