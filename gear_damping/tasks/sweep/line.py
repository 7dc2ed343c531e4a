"""The line that a job of a sweep leaves on the terminal, with a bar over all of them."""

from pathlib import Path

from gear_damping.config.folders import read_record
from gear_damping.reporting.headline import headline
from gear_damping.tasks.run_folder import FINISHED
from gear_damping.tasks.sweep.folder import Place, read_sweep

BAR = 20  # characters, so that the line fits a terminal of 80


def line_of(place: Place, how: str) -> str:
    """Bar, values of the job, how it ended with its first figures, and how it came to be."""
    record = read_record(place.folder) or {"status": "unknown", "metrics": {}}
    reason = record.get("error", "").split("\n")[0].removeprefix("- ")
    found = headline(record["metrics"]) if record["status"] == FINISHED else reason
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
