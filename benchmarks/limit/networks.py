"""The networks: trained on one set of runs each seed, kept, and asked."""

from dataclasses import replace
from pathlib import Path

import torch
from torch import Tensor

from benchmarks.limit.bench import Bench, settings_of
from gear_damping.identification.asked import estimates_of
from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.known_model.estimate import Estimates
from gear_damping.identification.lightning_module import CONSTANT, EstimatorConfig
from gear_damping.identification.noise import SensorNoise
from gear_damping.identification.protocols import BY_RUN
from gear_damping.identification.runs import RunSet
from gear_damping.identification.saved import load_estimator
from gear_damping.identification.trainer import Place, Shown, Training, fit_estimator
from gear_damping.simulation.plan import run_plan
from gear_damping.tasks.simulated import plan_of, run_set_of

WHOLE = "record_cwt_lstm"
NETWORKS = (WHOLE, "raw_lstm", "cwt_lstm")
VALIDATION, TEST = 0.075, 1e-4  # of the runs; other runs are tested on
VALIDATION_STRIDE = 150  # samples between windows of validation runs
OF_WINDOWS = Training(max_epochs=40, learning_rate=1e-3, schedule=CONSTANT)  # the rate is the paper's
WINDOW_RUNS = 4000  # that networks of windows are trained on: 8 million windows
_sets: dict[int, RunSet] = {}  # of the last seed: three networks share it


def trained(name: str, seed: int, folder: Path, n_runs: int) -> None:
    """Train a network, unless it is kept already."""
    if (folder / "done").exists():
        return
    settings = settings_of("bench", n_runs, seed)
    runs = _runs_of(settings, seed)
    whole = name == WHOLE
    training = Training(**settings.training)
    training = training if whole else replace(OF_WINDOWS, noise_snr_db=training.noise_snr_db)
    protocol = replace(BY_RUN, validation_fraction=VALIDATION, test_fraction=TEST)
    if whole:
        protocol = replace(protocol.of_whole_records(runs.n_samples), windows_per_epoch=None)
    else:
        protocol = replace(protocol, evaluation_stride=VALIDATION_STRIDE)
        runs = runs.subset(torch.arange(min(WINDOW_RUNS, len(runs))))
    noise = SensorNoise(tuple(training.noise_snr_db))
    data = WindowDataModule(Material(runs, protocol, noise), seed=seed)
    config = EstimatorConfig(name, settings.model.settings[name] if whole else {})
    resume = folder / "last.ckpt" if (folder / "last.ckpt").exists() else None
    found = fit_estimator(config, data, training, Place(folder, resume), seed=seed, shown=Shown(progress=True))
    (folder / "done").touch()
    print(f"{name}, seed {seed}: {len(found.history)} epochs", flush=True)


def _runs_of(settings, seed: int) -> RunSet:
    if seed not in _sets:
        _sets.clear()
        plan = plan_of(settings)
        _sets[seed] = run_set_of(run_plan(plan), plan)
    return _sets[seed]


def estimates_of_network(folder: Path, made: Bench, rows: Tensor, snr: int) -> Estimates:
    """What a trained network says of whole records."""
    return estimates_of(load_estimator(folder / "best.ckpt"), made.records(rows, snr))
