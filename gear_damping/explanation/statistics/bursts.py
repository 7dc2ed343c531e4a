"""Whether a series comes in bursts, by its kurtosis."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

BURST_KURTOSIS = 6.0  # of a double exponential distribution: heavier tails come in bursts; a normal one has 3


def kurtosis(values: NDArray[np.float64]) -> float:
    """Fourth moment over the squared second one, of values (n,) without mean."""
    squares = values**2
    return float((squares**2).mean() / max(squares.mean() ** 2, 1e-300))


def pooled_kurtosis(series: Iterable[NDArray[np.float64]]) -> float:
    """That of several series (n,) without mean, each of unit deviation so that none rules by its size."""
    return kurtosis(np.concatenate([one / (one.std() or 1.0) for one in series]))
