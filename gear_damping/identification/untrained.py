"""A network before its training: built for its windows, its normalisation fitted."""

import torch
from torch import Tensor

from gear_damping.identification.catalogue import kind_of
from gear_damping.identification.datamodule import WindowDataModule
from gear_damping.identification.familiarity import components_for
from gear_damping.identification.lightning_module import DampingModule, EstimatorConfig
from gear_damping.identification.trained_on import TrainedOn


def build_estimator(config: EstimatorConfig, data: WindowDataModule, learning_rate: float) -> DampingModule:
    """The untrained estimator of a configuration for these windows; it starts at the mean label."""
    transforms = kind_of(config.estimator, config.plugins).transforms
    module = DampingModule(
        estimator=config.estimator,
        data={
            "id": str(data.run_set.id),
            "sampling_rate": float(data.run_set.sampling_rate),
            "window": int(data.protocol.window),
            "whole_run": transforms and config.whole_run_columns and data.protocol.chronological,
            "trained_on": TrainedOn.of(data.run_set, data.split.train[:, 0]).plain(),
            "record": int(data.run_set.n_samples),
            "components": components_for(*map(len, _told_apart(data))),
        },
        settings=dict(config.settings),
        wavelet=dict(config.wavelet) if transforms else None,
        learning_rate=float(learning_rate),
        plugins=config.plugins,
    )
    module.network.begin(data.training_labels)
    return module


def fit_front_end(module: DampingModule, data: WindowDataModule) -> None:
    """Fit the normalisation on training windows; give `data` its whole-run columns where they are used."""
    with torch.no_grad():
        data.use_signals()
        module.front_end.fit_signal(data.training_inputs())
        if module.data["whole_run"]:
            data.use_columns(module.front_end.columns)
        module.front_end.fit_features(data.training_inputs())


def fit_components(module: DampingModule, data: WindowDataModule) -> None:
    """Learn what the records of the training are like, from their runs and from those of validation."""
    if module.components is not None:
        own, others = (data.run_set.signals[runs] for runs in _told_apart(data))
        with torch.no_grad():
            module.components.fit(own, others, data.noise, data.seed)


def _told_apart(data: WindowDataModule) -> tuple[Tensor, Tensor]:
    """Runs of training and of validation; none where a protocol cuts inside them."""
    none = torch.zeros(0, dtype=torch.long)
    return (none, none) if data.protocol.chronological else tuple(part[:, 0].unique() for part in data.split[:2])
