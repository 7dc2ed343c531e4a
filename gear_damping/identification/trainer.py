"""The one trainer of all learned estimators: seeds, early stopping, checkpoints, TensorBoard."""

import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from typing import Any

import lightning as L
import torch
from lightning.pytorch.callbacks import Callback, RichProgressBar
from lightning.pytorch.plugins.environments import LightningEnvironment
from lightning.pytorch.strategies import DDPStrategy
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.identification.datamodule import Material, WindowDataModule
from gear_damping.identification.kept_memory import keep_memory
from gear_damping.identification.lightning_module import CONSTANT, COSINE, DampingModule, EstimatorConfig
from gear_damping.identification.lightning_support import (
    EpochSeeds,
    EventsLogger,
    Patience,
    PortableCheckpoint,
    WholeCheckpoints,
    interruptible,
    own_randomness,
    quiet_lightning,
    threads,
)
from gear_damping.identification.metrics import epochs_to_convergence
from gear_damping.identification.processes import Share, in_processes
from gear_damping.identification.saved import load_estimator
from gear_damping.identification.seeding import derived_seed
from gear_damping.identification.untrained import build_estimator, fit_components, fit_front_end

SCHEDULES = (CONSTANT, COSINE)
_MONITOR = "val_loss"  # the RMSE, but of networks with a likelihood


@dataclass(frozen=True)
class Training:
    """The budget of one fit.

    Args:
        max_epochs: Epochs at most.
        batch_size: Windows of a batch.
        patience: Epochs without a better validation error before training stops.
        learning_rate: Step of Adam.
        schedule: `constant`, or `cosine`: the rate falls to nothing over all epochs.
        gradient_clip: Norm that a gradient is cut to; None for none.
        noise_snr_db: Limits between which the sensor noise of each record is drawn, in the place of that of the
            simulator; None: as simulated.
        devices: Processes that share every batch: on as many GPUs where this machine has them, else on its cores.
    """

    max_epochs: int = 32
    batch_size: int = 256
    patience: int = 8
    learning_rate: float = 3e-3
    schedule: str = COSINE
    gradient_clip: float | None = None
    noise_snr_db: tuple[float, float] | None = None
    devices: int = 1

    def __post_init__(self) -> None:
        if self.schedule not in SCHEDULES:
            raise ValueError(f"schedule must be one of {', '.join(SCHEDULES)}, got {self.schedule!r}")
        for name in ("max_epochs", "batch_size", "patience", "learning_rate", "devices"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)!r}")


# The budget of Yousfi et al. (2026), section 2.3.
PAPER_TRAINING = Training(max_epochs=200, batch_size=32, patience=20, learning_rate=1e-3, schedule=CONSTANT)


@dataclass(frozen=True)
class Place:
    """Where the files of a fit go, and what it goes on from.

    Args:
        folder: Made if missing; holds `best.ckpt`, `last.ckpt` and the TensorBoard events.
        resume: `last.ckpt` of a fit to go on with, in this folder or another.
    """

    folder: Path | str
    resume: Path | str | None = None


@dataclass(frozen=True)
class Shown:
    """What is seen of a fit while it runs and afterwards.

    Args:
        progress: Whether a progress bar stands on stderr, if that is a terminal.
        hparams: What TensorBoard's HParams table shows beside the seed (swept keys).
    """

    progress: bool = True
    hparams: Mapping[str, Any] = field(default_factory=dict)


SHOWN = Shown()


@dataclass(frozen=True)
class FitResult:
    """What a fit leaves: the best estimator, its learning curve and its files."""

    estimator: DampingModule
    history: list[dict[str, float]]
    best_checkpoint: Path
    last_checkpoint: Path

    @property
    def best_validation_rmse(self) -> float:
        """Lowest validation RMSE (%)."""
        return min(epoch["val_rmse_percent"] for epoch in self.history)

    @property
    def epochs(self) -> int:
        """Epochs to convergence (`metrics.epochs_to_convergence`)."""
        return epochs_to_convergence([epoch["val_rmse_percent"] for epoch in self.history])


def fit_estimator(
    config: EstimatorConfig,
    data: WindowDataModule,
    training: Training,
    place: Place,
    *,
    seed: int = 0,
    shown: Shown = SHOWN,
) -> FitResult:
    """Train an estimator and return the best one.

    `last.ckpt` is written at the start and after each epoch. The result depends on the arguments and not on the state
    of torch's generator, which is left as it was; a resumed fit repeats an interrupted epoch from its start and ends
    where an uninterrupted one would.

    Args:
        config: The estimator.
        data: The windows.
        training: The budget; its batch size and rate count, not those of `data`.
        place: Where files go.
        seed: Seed of the weights and of dropout.
        shown: What is seen of it.

    Raises:
        KeyboardInterrupt: as the user sent it, after the files were closed; `last.ckpt` can be resumed.
        InputError: `resume` is of another data set.
        RuntimeError: no epoch ended with a finite validation error.
    """
    folder, resume = Path(place.folder), place.resume
    folder.mkdir(parents=True, exist_ok=True)
    data.batch_size = training.batch_size
    keep_memory()
    if resume is None:
        for name in ("best.ckpt", "last.ckpt"):  # of an earlier fit: never to be taken for this one's
            (folder / name).unlink(missing_ok=True)
    with own_randomness(derived_seed(seed, "weights")), threads(training.batch_size), quiet_lightning():
        module = _prepared(config, training, data)
        finished = resume is not None and _take_over(Path(resume), folder, module, training)
        fit = _Fit(config, training, folder, None if resume is None else folder / "last.ckpt", seed, shown.progress)
        if not finished and training.devices > 1:
            in_processes(training.devices, _fit_share, fit, data.material, data.seed)
        elif not finished:
            _fit(fit, module, data)
        result = _result(module, folder)
        logger = EventsLogger(folder)
        table = {"seed": seed, **shown.hparams}
        logger.log_hyperparams(table, {"hp/val_rmse_percent": result.best_validation_rmse})
        logger.finalize("success")
    return result


@dataclass(frozen=True)
class _Fit:
    """What every process of a fit needs to know."""

    config: EstimatorConfig
    training: Training
    folder: Path
    checkpoint: Path | None
    seed: int
    progress: bool


def _fit_share(share: Share, fit: _Fit, material: Material, data_seed: int) -> None:
    """What one of several processes does: the same network, the same batches, of which it takes its share."""
    data = WindowDataModule(material, seed=data_seed, batch_size=fit.training.batch_size)
    data.share = share
    keep_memory()
    with own_randomness(derived_seed(fit.seed, "weights")), threads(fit.training.batch_size), quiet_lightning():
        _fit(fit, _prepared(fit.config, fit.training, data), data)


def _prepared(config: EstimatorConfig, training: Training, data: WindowDataModule) -> DampingModule:
    """The network before its first epoch."""
    module = build_estimator(config, data, training.learning_rate)
    module.schedule = training.schedule
    fit_front_end(module, data)
    fit_components(module, data)
    return module


def _take_over(resume: Path, folder: Path, module: DampingModule, training: Training) -> bool:
    """Bring the files of the fit to go on with into the folder; whether it had already come to its end."""
    earlier = load_estimator(resume, module.plugins)
    ours, theirs = module.data["id"], earlier.data["id"]
    if ours != theirs:
        rule = f"is of data set {theirs!r}, not of {ours!r}"
        remedy = "repeat the command that it was begun with, in the same version of the package, or train anew"
        raise InputError(Problem("resume", rule, str(resume), remedy))
    for name, path in {"last.ckpt": resume, "best.ckpt": resume.with_name("best.ckpt")}.items():
        if path.exists() and path.resolve() != (folder / name).resolve():
            shutil.copyfile(path, folder / name)
    errors = [epoch[_MONITOR] for epoch in earlier.history]
    if not errors:
        return False
    since_best = len(errors) - 1 - errors.index(min(errors))
    return len(errors) >= training.max_epochs or since_best >= training.patience


def _trainer(fit: _Fit) -> L.Trainer:
    training, folder = fit.training, fit.folder
    bar = fit.progress and sys.stderr.isatty()
    on_gpus = 0 < training.devices <= torch.cuda.device_count()
    callbacks: list[Callback] = [
        EpochSeeds(fit.seed, folder / "last.ckpt"),
        Patience(_MONITOR, patience=training.patience, check_on_train_epoch_end=True),
        PortableCheckpoint(folder, "best", monitor=_MONITOR),
        # A second one: `save_last` of the first would write only where it also finds a new best.
        PortableCheckpoint(folder, "last"),
    ]
    if bar:
        callbacks.append(RichProgressBar(refresh_rate=20, console_kwargs={"stderr": True}))
    return L.Trainer(
        accelerator="auto" if training.devices == 1 or on_gpus else "cpu",
        devices=training.devices,
        strategy="auto" if training.devices == 1 else DDPStrategy(process_group_backend="nccl" if on_gpus else "gloo"),
        # Processes of this machine: a job's scheduler must not be taken for a cluster to train on.
        plugins=[LightningEnvironment(), WholeCheckpoints()],
        max_epochs=training.max_epochs,
        logger=EventsLogger(folder),
        callbacks=callbacks,
        default_root_dir=folder,
        enable_progress_bar=bar,
        enable_model_summary=False,
        num_sanity_val_steps=0,
        gradient_clip_val=training.gradient_clip,
        log_every_n_steps=1,
    )


def _fit(fit: _Fit, module: DampingModule, data: WindowDataModule) -> None:
    try:
        with interruptible():
            _trainer(fit).fit(module, datamodule=data, ckpt_path=fit.checkpoint, weights_only=True)
    finally:
        data.trainer = None  # the data outlives this trainer


def _result(module: DampingModule, folder: Path) -> FitResult:
    best, last = folder / "best.ckpt", folder / "last.ckpt"
    history = module.history or load_estimator(last, module.plugins).history
    # Lightning keeps a first epoch that ended in nan as the best one.
    if not any(isfinite(epoch[_MONITOR]) for epoch in history):
        raise RuntimeError("no epoch had a finite validation error: lower learning_rate, or check the runs")
    return FitResult(load_estimator(best, module.plugins), history, best, last)


def predict_windows(module: DampingModule, batches: Any) -> tuple[Tensor, Tensor]:
    """True and predicted damping ratio (%) of all windows of a data loader, on the CPU."""
    module = module.eval()
    with torch.inference_mode():
        pairs = [(true.cpu(), module(inputs.to(module.device)).cpu()) for inputs, true in batches]
    true, predicted = zip(*pairs, strict=True)
    return torch.cat(true), torch.cat(predicted)
