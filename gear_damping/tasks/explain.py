"""task=explain: what a simulation gets wrong, its name, the extended model, and the gain."""

from pathlib import Path
from typing import Any

from gear_damping.config.settings import Settings
from gear_damping.explanation.budget import Budget
from gear_damping.explanation.evidence.declared_units import length_unit
from gear_damping.explanation.explain import Explanation, Listener, explain
from gear_damping.explanation.model.extended_simulator import write_extended
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.record import Measurement
from gear_damping.physics.catalogue import catalogue
from gear_damping.physics.terms import Effect
from gear_damping.reporting.explanation_report import write_report
from gear_damping.reporting.explanation_report.sentences import in_short
from gear_damping.tasks import statements
from gear_damping.tasks.progress import progress_bar
from gear_damping.tasks.run_folder import EDITED, RunFolder

EXTENDED = EDITED["explain"]


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Explain; returns the metrics for run.json."""
    measurement = load_measurement(settings.measurement_path, plugins=settings.measurement_plugins)
    folder.add_inputs(measurement.files)
    with progress_bar("explaining", settings.progress) as progress:
        listener, solver = Listener(statements.log, progress), settings.simulator.solver
        budget = Budget(settings.explain_minutes)
        found = explain(measurement, listener, solver, _library(settings), budget, settings.search)
    folder.write_json("explanation.json", found.content)
    if found.found is not None:
        _write_extended(folder.path / EXTENDED, found, measurement)
    write_report(folder.path, found, {"command": folder.record["command"], "measurement": str(measurement.source)})
    for sentence in in_short(found.content):
        statements.log(sentence)
    statements.log(f"verdict: {found.content['verdict']}; the report is {folder.path / 'report.html'}")
    return _metrics(found.content)


def _library(settings: Settings) -> dict[str, type[Effect]]:
    """The catalogue with the user's own effects, without those that are ruled out."""
    known = catalogue(settings.simulator.plugins)
    return {name: kind for name, kind in known.items() if name not in settings.ruled_out}


def _write_extended(path: Path, found: Explanation, measurement: Measurement) -> None:
    causes = ", ".join(cause["name"] for cause in found.content["causes"] if cause["status"] == "established")
    notes = {"measurement": measurement.source.name, "causes": causes or "none"}
    write_extended(path, found.found.outcome, notes, length_unit(found.evidence.channel))


def _metrics(content: dict[str, Any]) -> dict[str, Any]:
    metrics: dict[str, Any] = {"verdict": content["verdict"], "causes": [cause["name"] for cause in content["causes"]]}
    if content["misfit"]:
        metrics |= {f"misfit_{key}": content["misfit"][key] for key in ("before", "after")}
        metrics |= {f"rmse_holdout_{key}": content["residual"]["holdout"][key] for key in ("before", "after")}
    return metrics
