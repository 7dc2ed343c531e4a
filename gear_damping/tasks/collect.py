"""task=collect: table, figures and report of a sweep at any time, or, without one, the index of all runs."""

from typing import Any

from gear_damping.config.settings import Settings
from gear_damping.tasks import statements
from gear_damping.tasks.run_folder import RunFolder
from gear_damping.tasks.run_index import INDEX, OUTPUTS, write_index
from gear_damping.tasks.sweep.summary import summarise


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Write the sweep's files into its own folder, or the index; returns how far the sweep is, or how many runs."""
    if settings.sweep is None:
        count = write_index(OUTPUTS.absolute())
        statements.log(f"wrote {OUTPUTS / INDEX}: {count} runs and sweeps")
        return {"runs": count}
    found = summarise(settings.sweep)
    statements.log(f"{found.finished} of {found.jobs} jobs are finished")
    for path in found.files:
        statements.log(f"wrote {path}")
    return {"jobs": found.jobs, "finished": found.finished}
