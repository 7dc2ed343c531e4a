"""task=identify: damping from measured records, by output error, by estimators of records or by a trained network."""

from collections.abc import Mapping
from typing import Any

from gear_damping.config.settings import Settings
from gear_damping.identification.saved import files_of
from gear_damping.interface.damping import damping
from gear_damping.interface.estimator import ClassicalEstimator, Estimator, load_estimator
from gear_damping.interface.identified import Identification, identify, refuse_faults
from gear_damping.interface.model import Model
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.record import Measurement
from gear_damping.reporting import figures
from gear_damping.tasks import statements
from gear_damping.tasks.progress import progress_bar
from gear_damping.tasks.run_folder import RunFolder


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Identify; returns the metrics for run.json."""
    measurement = load_measurement(settings.measurement_path, plugins=settings.measurement_plugins)
    folder.add_inputs(measurement.files)
    refuse_faults(measurement)
    for finding in measurement.findings:
        statements.log(f"note: {finding.record} {finding.channel}: {finding.message}")
    if settings.checkpoint is not None:
        return _by_checkpoint(settings, measurement, folder)
    if settings.model.of_records:
        return _by_estimators(settings, settings.model.settings, measurement, folder)
    return _written(_fitted(settings, measurement), folder)


def _fitted(settings: Settings, measurement: Measurement) -> Identification:
    """By output error: the extended simulation where one is named, else the linear one."""
    solver = settings.simulator.solver
    model = Model.of_settings(settings.simulator) if settings.simulator.extended else None
    with progress_bar("fitting", settings.progress) as progress:
        return identify(measurement, model, log=statements.log, progress=progress, solver=solver)


def _written(found: Identification, folder: RunFolder) -> dict[str, Any]:
    """Write what was found; the metrics for run.json."""
    content, text = found.content, found.table()
    folder.write_json("identification.json", content)
    folder.write_text("identification.txt", text)
    statements.log(text)
    if not found.converged:
        statements.log("the search did not converge: take the figures as a first guess")
    figures.save(found.plot(), folder.path / "identification.png")
    ratio, frequency = found.damping_ratio_percent, content["natural_frequency_hz"]
    left = content["residual"]
    return {
        "damping_ratio_percent": ratio and ratio["value"],
        "natural_frequency_hz": frequency and frequency["value"],
        "rmse_fit": left["fit"]["rmse"],
        "rmse_holdout": (left["holdout"] or {}).get("rmse"),
    }


def _by_estimators(
    settings: Settings, asked: Mapping[str, Any], measurement: Measurement, folder: RunFolder
) -> dict[str, Any]:
    """Every estimator (settings by name) on every record; the mean over the records for run.json."""
    laws = {"extended simulation": _fitted(settings, measurement)} if settings.simulator.extended else None
    channel = settings.measurement_channel
    found = damping(measurement, asked, channel=channel, plugins=settings.model.plugins, laws=laws)
    text = found.table()
    folder.write_json("damping.json", found.content)
    folder.write_text("damping.txt", text)
    statements.log(text)
    figures.save(found.plot(), folder.path / "damping.png")
    return {f"{name}/damping_ratio_percent": mean for name, mean in found.mean_percent.items()}


def _by_checkpoint(settings: Settings, measurement: Measurement, folder: RunFolder) -> dict[str, Any]:
    """What was saved: a network, or an estimator that learns nothing."""
    estimator = load_estimator(settings.checkpoint, settings.model.plugins)
    if isinstance(estimator, ClassicalEstimator):
        folder.add_inputs([settings.checkpoint], "checkpoint")
        return _by_estimators(settings, {estimator.name: estimator.estimator.values}, measurement, folder)
    folder.add_inputs(files_of(settings.checkpoint), "checkpoint")
    return _by_network(estimator, settings, measurement, folder)


def _by_network(
    estimator: Estimator, settings: Settings, measurement: Measurement, folder: RunFolder
) -> dict[str, Any]:
    found = estimator.predict(measurement, settings.measurement_channel)
    mean = sum(one.damping_ratio_percent for one in found.values()) / len(found)
    only = next(iter(found.values())).interval95 if len(found) == 1 else None
    content = {
        "system": measurement.system,
        "method": "network",
        "parameters": {},
        "damping_ratio_percent": {"value": mean, "interval95": only},
        "natural_frequency_hz": None,
        "residual": {"fit": None, "holdout": None},
        "records": {
            name: {
                "damping_ratio_percent": one.damping_ratio_percent,
                "interval95": one.interval95,
                "spread_percent": one.spread_percent,  # over windows; of a network of records, its own deviation
                "outside_training": list(one.outside),
                "familiarity": one.familiarity and vars(one.familiarity),
            }
            for name, one in found.items()
        },
    }
    folder.write_json("identification.json", content)
    unknown = [name for name, one in found.items() if one.familiarity is None and not one.outside]
    if unknown:
        why = "the network does not say what its training was like, or they are shorter than its runs"
        statements.log(f"note: whether {', '.join(unknown)} are like the training was not looked at: {why}")
    for name, one in found.items():
        if one.outside:
            statements.log(f"warning: {name} lies outside what the network was trained on: {'; '.join(one.outside)}")
    for name, one in found.items():
        if one.interval95:
            low, high = one.interval95
            said = f"damping ratio {one.damping_ratio_percent:.4f} % of critical, 95 % interval {low:.4f} to {high:.4f}"
            statements.log(f"{name}: {said}")
    statements.log(f"damping ratio {mean:.4f} % of critical, the mean over {len(found)} records")
    holds = "holds only for gears like those that the network was trained on"
    sure = all(one.interval95 for one in found.values())
    statements.log(f"it {holds}" if sure else f"a network of windows gives no interval; what it says {holds}")
    return {"damping_ratio_percent": mean}
