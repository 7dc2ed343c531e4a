"""Whether a series comes in bursts, by its kurtosis."""

import numpy as np
from numpy.typing import NDArray

BURST_KURTOSIS = 6.0  # of a double exponential distribution: heavier tails come in bursts; a normal one has 3


def kurtosis(values: NDArray[np.float64]) -> float:
    """Fourth moment over the squared second one, of values (n,) without mean."""
    squares = values**2
    return float((squares**2).mean() / max(squares.mean() ** 2, 1e-300))
