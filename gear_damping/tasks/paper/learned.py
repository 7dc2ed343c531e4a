"""One training of a case: networks and controls on the same windows, scored, as plain values."""

import shutil
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import torch

from gear_damping.identification.compare import MEAN, WHITE_NOISE, Repeats, compare_models
from gear_damping.identification.controls import mean_predictor, white_noise_runs
from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.lightning_module import DampingModule
from gear_damping.identification.metrics import means_over_runs, scores
from gear_damping.identification.runs import RunSet
from gear_damping.identification.saved import load_estimator
from gear_damping.identification.trainer import Place, Shown, predict_windows
from gear_damping.reporting.paper.printed import RATIOS_PERCENT
from gear_damping.tasks.paper.prepared import Prepared
from gear_damping.tasks.run_folder import git_state
from gear_damping.tasks.simulated import TEST_SEED

SCALED = ("rmse_percent", "rmse_paper", "rmse_percent_per_run")  # scores in the unit of the label
DIGITS = 7  # of what is kept: more than a float32 has
RATIO_RUNS = 24  # fresh runs of each ratio that networks are tested on, 1/4 of the windows that the test part has


def learn(ready: Prepared, seed: int, folder: Path) -> dict[str, Any]:
    """Train and score a case with one seed; its checkpoints lie in `folder` until it is finished.

    Returns:
        Plain data: `scores`, `histories`, `predictions` and (`by_ratio`) in % of critical, whatever unit was learned.
    """
    began = time.process_time()
    place = Place(folder, folder if folder.exists() else None)
    material, models = ready.material(), ready.models()
    repeats = Repeats(ready.training, [seed])
    found = compare_models(material, models, repeats, place, shown=Shown(ready.settings.progress))
    unit = 1 / ready.per_percent
    kept = {name: load_estimator(folder / name / f"seed_{seed}" / "last.ckpt") for name in (*models, WHITE_NOISE)}
    best = {name: load_estimator(folder / name / f"seed_{seed}" / "best.ckpt") for name in kept}
    part = {
        "effect": ready.case.effect,
        "protocol": ready.case.protocol,
        "seed": seed,
        "decided_by": ready.decided_by(seed),
        "scores": {n: _scores(s["per_seed"], unit) for n, s in {**found["models"], **found["controls"]}.items()},
        "histories": {name: _history(module, unit) for name, module in kept.items()},
        "predictions": {name: _predictions(one, unit) for name, one in found["predictions"].items()},
        "n_runs": len(material.run_set),
    }
    if ready.case.by_ratio:
        part["by_ratio"] = {f"{ratio:g}": _of_ratio(ready, best, material, ratio, seed) for ratio in RATIOS_PERCENT}
    shutil.rmtree(folder)
    return part | {"cpu_s": round(time.process_time() - began, 1), "git": git_state()}


def _scores(per_seed: Mapping[str, list[float | None]], unit: float) -> dict[str, float | None]:
    """The scores of the only seed."""
    found = {name: values[0] for name, values in per_seed.items()}
    return {name: value * unit if name in SCALED else value for name, value in found.items()}


def _history(module: DampingModule, unit: float) -> dict[str, list[float]]:
    """Training and validation error of every epoch, in %."""
    return {
        "train": [_short(epoch["train_loss"] * unit) for epoch in module.history],
        "validation": [_short(epoch["val_rmse_percent"] * unit) for epoch in module.history],
    }


def _predictions(found: Mapping[str, Any], unit: float) -> dict[str, Any]:
    """Of each test run, and of each window where there is but one run."""
    runs = {name: [_short(value * unit) for value in values] for name, values in found["per_run"].items()}
    if len(runs["true"]) > 1:
        return runs
    return runs | {"windows": [_short(value * unit) for value in found["predicted"]]}


def _of_ratio(
    ready: Prepared, trained: Mapping[str, DampingModule], material: Material, ratio: float, seed: int
) -> dict[str, Any]:
    """Scores on fresh runs that all have this ratio (%), by network and control."""
    fresh = replace(ready.plan, seed=ready.plan.seed + TEST_SEED, n_runs=min(RATIO_RUNS, ready.plan.n_runs))
    tested = ready.test_material(material, ratio, fresh)
    blind = replace(tested, test_runs=_as_loud(material.run_set, tested.test_runs, seed))
    mean = mean_predictor(WindowDataModule(material, seed=seed).training_labels)
    found = {}
    for name, module in trained.items():
        data = WindowDataModule(blind if name == WHITE_NOISE else tested, seed=seed)
        true, predicted = predict_windows(module, data.test_dataloader())
        _, per_run, _ = means_over_runs(true, predicted, data.test_window_runs)
        own = scores(true, predicted, data.test_window_runs, mean)
        own = {"rmse_percent": own["rmse_percent"], "rmse_paper": own["rmse_paper"]}
        found[name] = own | {"predicted": float(per_run.mean()), "spread": float(per_run.std(correction=0))}
    error = abs(mean - ratio)
    paper = error * (len(true) / 2) ** 0.5
    return found | {MEAN: {"rmse_percent": error, "rmse_paper": paper, "predicted": mean, "spread": 0.0}}


def _as_loud(trained_on: RunSet, runs: RunSet, seed: int) -> RunSet:
    """White noise in the place of runs, as loud as that in training: its size tells nothing of the ratio."""
    noise = white_noise_runs(trained_on, seed, "test_runs").signals[torch.arange(len(runs)) % len(trained_on)]
    return replace(runs, signals=noise, id=f"{runs.id} (white noise)")


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
