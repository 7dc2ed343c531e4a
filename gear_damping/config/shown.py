"""Commands as they are shown: what is copied into a shell runs."""

import re
import shlex
from collections.abc import Iterable
from pathlib import Path

PROGRAM = "python -m gear_damping"
ITS_FOLDERS = ("hydra.run.dir=", "resume=")  # how words begin that say where a run lies
_PLAIN = re.compile(r"[\w@%+=:,./\[\]-]+")  # of a word that no shell reads as anything else


def shown(words: Iterable[str]) -> str:
    """A command of these words, quoted where a shell would read them otherwise."""
    return " ".join([PROGRAM, *(word if _PLAIN.fullmatch(word) else shlex.quote(word) for word in words)])


def going_on(command: str, folder: Path) -> str:
    """The command that goes on with what another one began in a folder, into a folder of its own."""
    kept = (word for word in shlex.split(command.removeprefix(PROGRAM)) if not word.startswith(ITS_FOLDERS))
    return shown([*kept, f"resume={folder}"])
