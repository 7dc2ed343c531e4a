"""task=evaluate: a trained estimator on fresh runs of the configured simulator."""

from dataclasses import replace
from typing import Any

import torch

from gear_damping.config.settings import Settings
from gear_damping.identification.lightning_module import load_estimator
from gear_damping.identification.metrics import median_relative_error, rmse_percent, skill
from gear_damping.identification.noise import SensorNoise, noisy_records
from gear_damping.reporting import figures
from gear_damping.tasks import statements
from gear_damping.tasks.run_folder import RunFolder
from gear_damping.tasks.simulated import TEST_SEED, plan_of, run_set_of, simulated


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Score a checkpoint on runs that it never met; returns the metrics for run.json."""
    folder.add_inputs([settings.checkpoint])
    estimator = load_estimator(settings.checkpoint, settings.model.plugins)
    plan = plan_of(settings)
    ratio = settings.simulator.damping_ratio_percent
    plan = replace(plan, seed=plan.seed + 2 * TEST_SEED, damping_ratio_percent=ratio)
    run_set = run_set_of(simulated(plan, settings), plan)
    noise = SensorNoise(settings.simulator.sensor_noise_db)
    signals = noisy_records(run_set.signals, torch.arange(len(run_set)), noise, settings.seed, "evaluation")
    predicted = torch.tensor(
        [estimator.predict_record(s, run_set.sampling_rate, stride=15).damping_ratio_percent for s in signals]
    )
    true = run_set.damping_ratio_percent
    metrics = {
        "rmse_percent": rmse_percent(true, predicted),
        "median_relative_error": median_relative_error(true, predicted),
        "skill": skill(true, predicted, float(true.mean())),
    }
    folder.write_json("evaluation.json", {"checkpoint": str(settings.checkpoint), "n_runs": len(true), **metrics})
    pairs = {"estimator": {"per_run": {"true": true.tolist(), "predicted": predicted.tolist()}}}
    figures.save(figures.predicted_against_true_figure(pairs), folder.path / "predicted_against_true.png")
    statements.say(f"{len(true)} fresh runs: RMSE {metrics['rmse_percent']:.4f} % of critical, whole records")
    return metrics
