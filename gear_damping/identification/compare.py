"""Train several estimators and their controls on the same windows, with several seeds, and score them."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from statistics import fmean, stdev
from typing import Any

import torch
from torch import Tensor

from gear_damping.identification.catalogue import kind_of
from gear_damping.identification.controls import mean_predictor, white_noise_runs
from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.estimators.base import RecordNetwork
from gear_damping.identification.lightning_module import EstimatorConfig
from gear_damping.identification.metrics import interval_of_rmse, means_over_runs, scores
from gear_damping.identification.trainer import SHOWN, Place, Shown, Training, fit_estimator, predict_windows

MEAN, WHITE_NOISE = "mean", "white_noise"

INTERVAL = "rmse_interval95"  # stands with each seed: a mean of intervals is none

Scores = dict[str, Any]


@dataclass(frozen=True)
class _Seed:
    """What is the same for every fit of one seed."""

    seed: int
    training: Training
    data: WindowDataModule
    noise_data: WindowDataModule
    place: Place
    shown: Shown

    def data_of(self, config: EstimatorConfig, is_noise: bool = False) -> WindowDataModule:
        """What an estimator meets: windows, or whole records."""
        data = self.noise_data if is_noise else self.data
        if not issubclass(kind_of(config.estimator, config.plugins), RecordNetwork):
            return data
        protocol = data.protocol.of_whole_records(data.run_set.n_samples)
        return WindowDataModule(replace(data.material, protocol=protocol), seed=self.seed)

    def place_of(self, name: str) -> Place:
        """Where an estimator's files go, and its part of the comparison to go on with."""
        own = Path(name) / f"seed_{self.seed}"
        earlier = None if self.place.resume is None else Path(self.place.resume) / own / "last.ckpt"
        return Place(Path(self.place.folder) / own, earlier if earlier is not None and earlier.exists() else None)


@dataclass(frozen=True)
class Repeats:
    """How each estimator is fitted.

    Args:
        training: The budget of each fit.
        seeds: At least one.
    """

    training: Training
    seeds: Sequence[int]


def compare_models(
    material: Material,
    models: Mapping[str, EstimatorConfig],
    repeats: Repeats,
    place: Place,
    *,
    shown: Shown = SHOWN,
    announce: Callable[[str], None] = lambda line: None,
) -> dict[str, Any]:
    """Train and score every model and the controls, once for each seed.

    A seed decides split, sensor noise, order and weights; at one seed all models meet the same windows. The
    control `white_noise` is the network of the first model, trained in the same way on white noise.

    Args:
        material: Runs, their split, the sensor.
        models: Name -> estimator. The names become folders: <name>/seed_<seed>/.
        repeats: Budget and seeds.
        place: Where checkpoints and TensorBoard events go, and the folder of an interrupted comparison to go on with;
            what that finished is not trained again.
        shown: What is seen of the fits; the HParams table shows model and seed too.
        announce: Called with a line of text after each fit.

    Returns:
        Plain data, ready for JSON: `protocol`, `seeds`, `models` and `controls` (name -> `metrics.scores`:
        rmse_percent as {mean, std} over the seeds (std 0 for one seed), the others as means over the seeds
        (None where undefined), and `per_seed` with the values and the 95 % interval of each error), and
        `predictions` of the first seed: name -> true and predicted value of each test window, and of each run with
        the standard deviation over its windows.

    Raises:
        ValueError: no models, no seeds, a model named like a control, or what protocol and fits refuse.
        KeyboardInterrupt: as the user sent it; `place.resume` takes it up again.
    """
    seeds = repeats.seeds
    _require_names(models, seeds)
    per_seed: dict[str, list[Scores]] = {name: [] for name in (*models, MEAN, WHITE_NOISE)}
    predictions: dict[str, Any] = {}
    for seed in seeds:
        data = WindowDataModule(material, seed=seed)
        shared = _Seed(seed, repeats.training, data, _white_noise_data(data), place, shown)
        for name, (found, *said) in _one_seed(shared, models, announce):
            per_seed[name].append(found)
            if seed == seeds[0]:
                predictions[name] = _plain_predictions(*said)
    summaries = {name: _summary(found) for name, found in per_seed.items()}
    controls = {name: summaries.pop(name) for name in (MEAN, WHITE_NOISE)}
    results = {"protocol": material.protocol.name, "seeds": list(seeds), "models": summaries, "controls": controls}
    return results | {"predictions": predictions}


def _white_noise_data(data: WindowDataModule) -> WindowDataModule:
    """The same windows of white noise."""
    material = data.material
    runs, test_runs = white_noise_runs(material.run_set, data.seed), None
    if material.test_runs is not None:
        test_runs = white_noise_runs(material.test_runs, data.seed, "test_runs")
    return WindowDataModule(replace(material, run_set=runs, test_runs=test_runs), seed=data.seed)


def _one_seed(
    shared: _Seed, models: Mapping[str, EstimatorConfig], announce: Callable[[str], None]
) -> Iterator[tuple[str, tuple[Scores, Tensor, Tensor, Tensor]]]:
    """Name, and scores with true and predicted values and their runs, of every model and control."""
    for name, config in models.items():
        yield name, _fit_and_score(shared, name, config, shared.data_of(config), announce)
    config = next(iter(models.values()))
    yield WHITE_NOISE, _fit_and_score(shared, WHITE_NOISE, config, shared.data_of(config, is_noise=True), announce)
    data = shared.data
    mean = mean_predictor(data.training_labels)
    true = data.test_runs.damping_ratio_percent[data.test_window_runs].cpu()
    predicted = torch.full_like(true, mean)
    runs = data.test_window_runs
    yield MEAN, (_scored(true, predicted, runs, mean) | {"epochs": 0}, true, predicted, runs)


def _fit_and_score(
    shared: _Seed,
    name: str,
    config: EstimatorConfig,
    data: WindowDataModule,
    announce: Callable[[str], None],
) -> tuple[Scores, Tensor, Tensor, Tensor]:
    shown = replace(shared.shown, hparams={"model": name, **shared.shown.hparams})
    fit = fit_estimator(config, data, shared.training, shared.place_of(name), seed=shared.seed, shown=shown)
    true, predicted = predict_windows(fit.estimator, data.test_dataloader())
    found = _scored(true, predicted, data.test_window_runs, mean_predictor(data.training_labels))
    announce(
        f"{name}, seed {shared.seed}: test RMSE {found['rmse_percent']:.4f} %, validation "
        f"{fit.best_validation_rmse:.4f} %, {len(fit.history)} epochs"
    )
    return {**found, "epochs": fit.epochs}, true, predicted, data.test_window_runs


def _scored(true: Tensor, predicted: Tensor, runs: Tensor, mean: float) -> Scores:
    """Every score of one estimator, with the interval of its error over runs."""
    return scores(true, predicted, runs, mean) | {INTERVAL: interval_of_rmse(true, predicted, runs)}


def _summary(per_seed: Sequence[Scores]) -> dict[str, Any]:
    columns = {name: [found[name] for found in per_seed] for name in per_seed[0]}
    errors = columns["rmse_percent"]
    summary: dict[str, Any] = {name: _mean(values) for name, values in columns.items() if name != INTERVAL}
    deviation = stdev(errors) if len(errors) > 1 else 0.0
    summary["rmse_percent"] = {"mean": fmean(errors), "std": deviation}
    summary["per_seed"] = columns
    return summary


def _mean(values: Sequence[float | None]) -> float | None:
    if any(value is None or not isfinite(value) for value in values):
        return None
    return fmean(values)


def _plain_predictions(true: Tensor, predicted: Tensor, runs: Tensor) -> dict[str, Any]:
    label, mean, deviation = means_over_runs(true, predicted, runs)
    return {
        "true": true.tolist(),
        "predicted": predicted.tolist(),
        "per_run": {"true": label.tolist(), "predicted": mean.tolist(), "spread": deviation.tolist()},
    }


def _require_names(models: Mapping[str, EstimatorConfig], seeds: Sequence[int]) -> None:
    if not models or not seeds:
        raise ValueError("models and seeds must not be empty: give at least one of each")
    taken = {MEAN, WHITE_NOISE} & set(models)
    if taken:
        raise ValueError(f"models must not be named like the controls, got {sorted(taken)}: rename them")
