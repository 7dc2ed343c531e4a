"""Whether a series comes in bursts, by its kurtosis."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

BURST_KURTOSIS = 6.0  # of a double exponential distribution: heavier tails come in bursts; a normal one has 3


def kurtosis(values: NDArray[np.float64]) -> float:
    """Fourth moment of values (n,) over the square of the second, about the mean; 3 for noise, and for nothing."""
    square = (values - values.mean()) ** 2
    total = float(square.sum())
    return float(square @ square) * square.size / total**2 if total > 0 else 3.0


def pooled_kurtosis(series: Iterable[NDArray[np.float64]]) -> float:
    """That of several series (n,) without mean, each of unit deviation so that none rules by its size."""
    return kurtosis(np.concatenate([one / (one.std() or 1.0) for one in series]))
