"""A mistake in a measurement.yaml is answered before anything that takes long is imported, Hydra among it.

Only where nothing else of the command can be wrong: otherwise everything that is wrong is said at once, a little later.
"""

import logging
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from gear_damping.config.folders import unusable
from gear_damping.config.measured import MEASURED, declares, measurement_file
from gear_damping.errors import InputError, Problem

WRONG_INPUT = 1  # exit code of a command that was wrong
PATH, TASK, FOLDER = "measurement.path", "task", "hydra.run.dir"
USUAL_FOLDER = "outputs"  # where runs go unless the command says otherwise
_PLAIN = re.compile(r"[\w./~@:+-]+( [\w./~@:+-]+)*")  # a value that Hydra takes as it stands
log = logging.getLogger("gear_damping")


def answered(words: Sequence[str]) -> bool:
    """Whether these words of a command name a measurement.yaml with mistakes, and nothing else is to be said.

    The mistakes are said then.
    """
    typed = _plain_values(words)
    if typed is None or typed.get(TASK) not in MEASURED or PATH not in typed:
        return False
    file = measurement_file(typed[PATH])
    if unusable(Path(typed.get(FOLDER, USUAL_FOLDER))) or not declares(file, typed[TASK]):
        return False
    from gear_damping.measurement.load import check_declaration

    try:
        check_declaration(file)
    except InputError as error:
        start_logging()
        log_problems(InputError(placed(error, {PATH: f"command line: {PATH}={typed[PATH]}"})))
        return True
    return False


def _plain_values(words: Sequence[str]) -> dict[str, str] | None:
    """The values by key; None where the words hold anything but plain values of the few known keys."""
    found = {}
    for word in words:
        key, _, value = word.partition("=")
        if key not in (PATH, TASK, FOLDER) or key in found or not _PLAIN.fullmatch(value):
            return None
        found[key] = value
    return found


def placed(error: InputError, sources: Mapping[str, str]) -> list[Problem]:
    """The problems of a declaration; those with a key of the command come from where that was given.

    Args:
        error: The problems.
        sources: Where each such key was given.
    """
    return [replace(p, source=p.source or sources.get(p.key, "")) for p in error.problems]


def start_logging() -> None:
    """Say what there is to say on stderr, as plain lines."""
    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    logging.getLogger("matplotlib").setLevel(logging.WARNING)  # it tells of its fonts


def log_problems(error: InputError) -> None:
    """Every problem, one a line."""
    count = len(error.problems)
    log.error("%s\n%s", "This cannot run:" if count == 1 else f"This cannot run, {count} problems:", error)
