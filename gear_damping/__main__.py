"""The one command: `python -m gear_damping`."""

import os
import sys
from collections.abc import Sequence

from gear_damping.tasks.wrong_declaration import WRONG_INPUT, answered


def entry(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and end with its exit code."""
    _wait_without_spinning()
    words = sys.argv[1:] if arguments is None else arguments
    try:
        code = _run(words)
        sys.stdout.flush()
    except BrokenPipeError:  # who read along, as `| head`, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0
    sys.exit(code)


def _run(words: Sequence[str]) -> int:
    if answered(words):
        return WRONG_INPUT
    from gear_damping.tasks.command import main

    return main(words)


def _wait_without_spinning() -> None:
    """Threads of PyTorch that wait for each other sleep, unless the user says otherwise.

    OpenMP lets them spin. Where other processes hold the cores, that made a training with two threads 16 times slower
    than this; it is read when PyTorch is loaded.
    """
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")


if __name__ == "__main__":
    entry()
