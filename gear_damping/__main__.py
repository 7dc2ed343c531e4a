"""The one command: `python -m gear_damping`."""

import sys
from collections.abc import Sequence

from gear_damping.tasks.command import main


def entry(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and end with its exit code."""
    sys.exit(main(sys.argv[1:] if arguments is None else arguments))


if __name__ == "__main__":
    entry()
