"""task=collect: table and figures of a sweep at any time, also while it runs or after it was cut off."""

from typing import Any

from gear_damping.config.settings import Settings
from gear_damping.tasks import statements
from gear_damping.tasks.run_folder import RunFolder
from gear_damping.tasks.sweep.summary import summarise


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Write the sweep's files into its own folder; returns how far it is."""
    found = summarise(settings.sweep)
    statements.say(f"{found.finished} of {found.jobs} jobs are finished")
    for path in found.files:
        statements.say(f"wrote {path}")
    return {"jobs": found.jobs, "finished": found.finished}
