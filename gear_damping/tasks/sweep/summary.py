"""What a sweep leaves: one table and figures over all its jobs of any task, also where some of them failed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from gear_damping.config.folders import read_record
from gear_damping.config.quantities import number_of
from gear_damping.errors import InputError, Problem, written_whole
from gear_damping.reporting.run_report import REPORT
from gear_damping.tasks.run_folder import FINISHED, status_of
from gear_damping.tasks.sweep.folder import NOTE, Sweep, read_sweep

TABLE, FIGURE, MAP = "sweep.csv", "sweep.png", "sweep_map.png"
NOT_BEGUN = "not begun"


@dataclass(frozen=True)
class Summary:
    """What a sweep has come to.

    Args:
        jobs: How many are known of.
        finished: How many of them are finished.
        files: What was written.
    """

    jobs: int
    finished: int
    files: tuple[Path, ...] = ()

    @property
    def is_complete(self) -> bool:
        """Whether nothing is left to do."""
        return 0 < self.jobs == self.finished


def summarise(folder: Path) -> Summary:
    """Write the table and the figures of a sweep, and note whether it is complete.

    Raises:
        InputError: the folder holds no sweep, or a file cannot be written.
    """
    from gear_damping.reporting import figures, tables  # here, since these take long to import
    from gear_damping.reporting.run_report.sweep import SweepLeft
    from gear_damping.reporting.run_report.write import write_sweep_report

    sweep = read_sweep(folder)
    if sweep is None:
        rule = "holds no sweep" if folder.is_dir() else "is no folder"
        raise InputError(
            Problem("sweep", f"{rule}: there is no {NOTE}", str(folder), "give the folder of a --multirun")
        )
    rows = [_row(path.parent, sweep.keys) for path in sorted(folder.glob("*/run.json"), key=_number)]
    finished = [row for row in rows if row["status"] == FINISHED]
    found = Summary(max(len(rows), sweep.jobs or 0), len(finished))
    if found.is_complete != sweep.complete:
        replace(sweep, complete=found.is_complete).write(folder)
    if not rows:
        return found
    with written_whole(folder / TABLE) as path:
        tables.write_csv(rows, path)
    files = [folder / TABLE]
    for name, figure in figures.sweep_figures(finished, sweep.keys, (FIGURE, MAP)).items():
        figures.save(figure, folder / name)
        files.append(folder / name)
    pages = {row["job"]: _page(folder, row["job"]) for row in rows}
    files.append(write_sweep_report(SweepLeft(folder, sweep.keys, found.jobs, rows, pages, _command(sweep))))
    return replace(found, files=tuple(files))


def _page(folder: Path, job: str) -> str:
    """Where a click on a job leads: to its report, or to its folder."""
    return f"{job}/{REPORT}" if (folder / job / REPORT).exists() else f"{job}/"


def _command(sweep: Sweep) -> str:
    return " ".join(["python -m gear_damping --multirun", *(word.lstrip("+") for word in sweep.overrides)])


def _number(path: Path) -> tuple[int, str]:
    name = path.parent.name
    return (int(name) if name.isdigit() else 10**9, name)


def _row(folder: Path, keys: Sequence[str]) -> dict[str, Any]:
    """Status, swept values, figures and error of a job."""
    record = read_record(folder) or {"status": NOT_BEGUN, "config": {}, "choices": {}, "metrics": {}}
    row = {"job": folder.name, "status": status_of(folder, record)}
    choices = record["choices"]
    given = {key: number_of(key, _lookup(record["config"], key)) for key in keys}
    row |= {key: choices.get(key, value) for key, value in given.items()}
    metrics = record["metrics"].items()
    row |= {name: ", ".join(map(str, value)) if isinstance(value, list) else value for name, value in metrics}
    row["error"] = record.get("error", "")
    return row


def _lookup(config: Any, key: str) -> Any:
    for part in key.split("."):
        config = config.get(part) if isinstance(config, Mapping) else None
    return config
