"""Where a sweep lies: the folder of the same command where that was cut off, else one of its own."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from hydra.errors import HydraException

from gear_damping.config.command_line import parse, swept_keys
from gear_damping.errors import Problem
from gear_damping.tasks.run_folder import git_state, versions, write_json

NOTE = "sweep.json"
PLACE = "hydra.sweep.dir"
USUAL = "outputs/sweep"  # where sweeps go unless the command says otherwise, as in conf/config.yaml
NOT_DECIDING = ("progress", "data_folder", "resume")  # keys that change no number of a job,
OF_THE_MACHINE = ("hydra", *NOT_DECIDING)  # and how those of a command begin


@dataclass(frozen=True)
class Sweep:
    """What a sweep is.

    Args:
        overrides: Those of its command that decide what its jobs find.
        keys: The keys and groups that it varies.
        jobs: How many jobs it has; None where only the launcher knows.
        version: Package, git revision and whether the checkout was changed.
        complete: Whether all jobs are finished.
    """

    overrides: list[str]
    keys: list[str]
    jobs: int | None
    version: str
    complete: bool = False

    def is_same(self, other: "Sweep") -> bool:
        """Whether the jobs of the other would find the same."""
        return (self.overrides, self.version) == (other.overrides, other.version)

    def write(self, folder: Path) -> None:
        """Note it in its folder."""
        folder.mkdir(parents=True, exist_ok=True)
        write_json(folder / NOTE, asdict(self))


@dataclass(frozen=True)
class Place:
    """Where a job stands in its sweep.

    Args:
        folder: Of the job.
        sweep: Of the sweep.
        words: Its values of the swept keys, as typed.
    """

    folder: Path
    sweep: Path
    words: str


def sweep_of(overrides: Sequence[str]) -> Sweep:
    """The sweep of a command."""
    deciding = [one for one in overrides if not _key(one).startswith(OF_THE_MACHINE)]
    git = git_state()
    version = f"{versions()['gear-damping']} {git['revision']} {git['dirty']}"
    return Sweep(deciding, swept_keys(overrides), _jobs(overrides), version)


def read_sweep(folder: Path) -> Sweep | None:
    """The sweep of a folder; None where it holds none."""
    try:
        return Sweep(**json.loads((folder / NOTE).read_text()))
    except (OSError, ValueError, TypeError):
        return None


def unfinished(sweep: Sweep, root: Path = Path(USUAL)) -> Path | None:
    """The newest folder in which the same sweep was cut off."""
    notes = sorted(root.glob(f"*/*/{NOTE}"), key=lambda path: path.parent.name, reverse=True)
    for folder in (path.parent for path in notes):
        found = read_sweep(folder)
        if found is not None and not found.complete and found.is_same(sweep):
            return folder
    return None


def place_of(overrides: Iterable[str]) -> str | None:
    """The folder that a command names for its sweep; None where it names none."""
    named = [one.partition("=")[2] for one in overrides if _key(one) == PLACE]
    return named[-1] if named else None


def problem_with_place(sweep: Sweep, folder: Path) -> Problem | None:
    """The problem with a folder that holds another sweep: its table would mix both."""
    there = read_sweep(folder)
    if there is None or there.is_same(sweep):
        return None
    rule = "holds another sweep" if there.overrides != sweep.overrides else "holds this sweep by another version"
    return Problem(PLACE, rule, str(folder), "give another folder, or move it away", "command line")


def _key(override: str) -> str:
    return override.lstrip("+~").partition("=")[0]


def _jobs(overrides: Sequence[str]) -> int | None:
    count = 1
    for parsed in map(parse, overrides):
        if parsed.is_delete() or not parsed.is_sweep_override():
            continue
        try:
            count *= len(list(parsed.sweep_string_iterator()))
        except (HydraException, AssertionError, AttributeError):  # glob(…), which only the launcher resolves
            return None
    return count
