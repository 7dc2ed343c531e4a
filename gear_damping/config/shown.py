"""Commands as they are shown: what is copied into a shell runs."""

import shlex
from collections.abc import Iterable
from pathlib import Path

PROGRAM = "python -m gear_damping"
ITS_FOLDERS = ("hydra.run.dir=", "hydra.sweep.dir=", "resume=")  # how words begin that say where a run lies


def shown(words: Iterable[str]) -> str:
    """A command of these words, quoted where a shell would read them otherwise."""
    return " ".join([PROGRAM, *map(shlex.quote, words)])


def going_on(command: str, folder: Path) -> str:
    """The command that goes on with what another one began in a folder, into a folder of its own."""
    words = command.removeprefix(PROGRAM)
    try:
        parted = shlex.split(words)
    except ValueError:  # of a version that wrote words as they were
        parted = words.split()
    kept = (word for word in parted if not word.startswith(ITS_FOLDERS))
    return shown([*kept, f"resume={folder}"])
