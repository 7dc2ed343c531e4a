"""The line that a job of a sweep leaves on the terminal, with a bar over all of them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gear_damping.reporting.numbers import number
from gear_damping.tasks.run_folder import FINISHED, read_record
from gear_damping.tasks.sweep.folder import Place, read_sweep

BAR = 20  # characters, so that the line fits a terminal of 80
SHOWN = 2  # figures of a job, which the rest of the line has room for
FIRST = ("rmse_percent", "verdict", "misfit_after", "damping_ratio_percent")  # how the names end of those shown first


def line_of(place: Place, how: str) -> str:
    """Bar, values of the job, how it ended with its first figures, and how it came to be."""
    record = read_record(place.folder) or {"status": "unknown", "metrics": {}}
    reason = record.get("error", "").split("\n")[0].removeprefix("- ")
    found = _figures(record["metrics"]) if record["status"] == FINISHED else reason
    said = f"{record['status']}{', ' if found else ''}{found}"
    return f"{_bar(place.sweep)} {place.folder.name}: {place.words or 'as configured'}: {said} ({how})"


def _bar(sweep: Path) -> str:
    """How many jobs have ended, of how many."""
    noted = read_sweep(sweep)
    done = sum((read_record(path.parent) or {}).get("status") == FINISHED for path in sweep.glob("*/run.json"))
    if noted is None or not noted.jobs:
        return f"[{done} finished]"
    filled = round(BAR * min(done / noted.jobs, 1))
    return f"[{'#' * filled}{'.' * (BAR - filled)}] {done}/{noted.jobs}"


def _figures(metrics: Mapping[str, Any]) -> str:
    ranked = sorted(metrics, key=lambda name: not name.endswith(FIRST))  # stable: else as the task gives them
    shown = [(name, metrics[name]) for name in ranked if metrics[name] not in (None, [])][:SHOWN]
    return ", ".join(f"{name} {number(value) if isinstance(value, float) else value}" for name, value in shown)
