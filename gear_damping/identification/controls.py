"""Controls: what an estimator scores that knows nothing of the signal."""

from dataclasses import replace

import torch
from torch import Tensor

from gear_damping.identification.runs import RunSet
from gear_damping.identification.seeding import seeded_generator

NO_BETTER = 0.95  # of the error of the network that heard noise: from there on a network tells nothing


def mean_predictor(training_labels: Tensor) -> float:
    """The one value that the mean predictor always says: the mean of the training labels (%)."""
    return float(training_labels.double().mean())


def white_noise_runs(run_set: RunSet, seed: int, data: str = "runs") -> RunSet:
    """The same runs and labels with every signal replaced by white Gaussian noise.

    All runs get the same deviation (that of the whole set about each run's mean). With each run's own, its
    size would still tell of the damping, and a network could learn from it: the control has to know nothing.

    Args:
        run_set: The runs whose labels, rate and size are kept.
        seed: Seed of the noise.
        data: Name of the set; sets of other names get other noise.
    """
    deviation = torch.stack([signal.var(correction=0) for signal in run_set.signals]).mean().sqrt()
    generator = seeded_generator(seed, "white noise", data)
    noise = torch.randn(run_set.signals.shape, generator=generator) * deviation.cpu()
    return replace(run_set, signals=noise.to(run_set.signals.device), id=f"{run_set.id} (white noise)")
