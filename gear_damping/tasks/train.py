"""task=train: simulate runs, train the networks and their controls, score them, leave tables and figures."""

from collections.abc import Mapping
from typing import Any

from torch.utils.tensorboard import SummaryWriter

from gear_damping.config.settings import Settings
from gear_damping.identification.compare import Repeats, compare_models
from gear_damping.identification.datamodule import Material
from gear_damping.identification.lightning_module import EstimatorConfig
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.protocols import Protocol
from gear_damping.identification.trainer import Place, Shown, Training
from gear_damping.reporting import figures, tables
from gear_damping.simulation.runs import Runs
from gear_damping.tasks import statements
from gear_damping.tasks.experiment_figures import experiment_figures
from gear_damping.tasks.run_folder import RunFolder
from gear_damping.tasks.shared_models import share_models
from gear_damping.tasks.simulated import plan_of, run_set_of, simulated, test_plan_of


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Train and compare; returns the metrics for run.json."""
    plan, other = plan_of(settings), test_plan_of(settings)
    protocol, training = Protocol(**settings.protocol), Training(**settings.training)
    statements.log_budget(settings, training)
    runs = simulated(plan, settings)
    test_runs = simulated(other, settings, "simulating test runs") if other else None
    statements.log_runs(settings, runs)
    noise = SensorNoise(training.noise_snr_db or settings.simulator.sensor_noise_db)
    material = Material(run_set_of(runs, plan), protocol, noise, run_set_of(test_runs, other) if other else None)
    results = compare_models(
        material,
        estimators(settings),
        Repeats(training, settings.all_seeds),
        Place(folder.path, settings.resume),
        shown=Shown(settings.progress, _hparams(settings)),
        announce=statements.log,
    )
    predictions = results.pop("predictions")
    results = {"experiment": settings.name, "family": settings.simulator.family.name, **results}
    results["n_runs"], results["n_diverged"] = len(runs.status), runs.n_diverged
    folder.write_json("results.json", results)
    text = tables.results_table(results)
    folder.write_text("results.txt", text)
    statements.log(text)
    statements.log_controls(results)
    share_models(settings, results, folder)
    _figures(settings, runs, predictions, folder)
    return _metrics(results)


def estimators(settings: Settings) -> dict[str, EstimatorConfig]:
    """The networks to train, by name."""
    plugins = settings.model.plugins
    return {
        name: EstimatorConfig(name, values, settings.wavelet, plugins=plugins)
        for name, values in settings.model.settings.items()
    }


def _hparams(settings: Settings) -> dict[str, Any]:
    """Columns of TensorBoard's HParams table."""
    simulator = settings.simulator
    found = {"experiment": settings.name, "protocol": settings.protocol["name"], "family": simulator.family.name}
    snr = {k: float(v) for k, v in simulator.given.items() if k.endswith("snr_db")}
    ratio = simulator.damping_ratio_percent
    return found | snr | ({} if ratio is None else {"damping_ratio_percent": ratio})


def _metrics(results: Mapping[str, Any]) -> dict[str, Any]:
    scored = {**results["models"], **results["controls"]}
    metrics: dict[str, Any] = {}
    for name, found in scored.items():
        for score, value in found.items():
            if isinstance(value, Mapping) and score != "per_seed":
                metrics |= {f"{name}/{score}": value["mean"], f"{name}/{score}_std": value["std"]}
            elif score != "per_seed":
                metrics[f"{name}/{score}"] = value
    return metrics


def _figures(settings: Settings, runs: Runs, predictions: Mapping[str, Any], folder: RunFolder) -> None:
    with SummaryWriter(str(folder.path)) as writer:
        for name, figure in experiment_figures(settings, runs, predictions).items():
            figures.save(figure, folder.path / f"{name}.png")
            writer.add_figure(name, figure, close=False)
