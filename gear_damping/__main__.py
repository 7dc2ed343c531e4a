"""The one command: `python -m gear_damping`."""

import sys
from collections.abc import Sequence

from gear_damping.tasks.wrong_declaration import WRONG_INPUT, answered


def entry(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and end with its exit code."""
    words = sys.argv[1:] if arguments is None else arguments
    if answered(words):
        sys.exit(WRONG_INPUT)
    from gear_damping.tasks.command import main

    sys.exit(main(words))


if __name__ == "__main__":
    entry()
