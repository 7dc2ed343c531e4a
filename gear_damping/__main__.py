"""The one command: `python -m gear_damping`."""

import os
import sys
from collections.abc import Sequence

from gear_damping.tasks.wrong_declaration import WRONG_INPUT, answered


def entry(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and end with its exit code."""
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


if __name__ == "__main__":
    entry()
