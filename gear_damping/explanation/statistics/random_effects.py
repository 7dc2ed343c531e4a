"""How much estimates of one quantity differ beyond their errors.

The standard deviation between groups is that of a random-effects model; its interval is the Q profile (Viechtbauer
2007, Statistics in Medicine 26): the deviations at which Cochran's Q is no surprise.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2

CONFIDENCE = 0.95  # of the interval of the deviation
WIDEST = 1e3  # times the largest difference of two estimates: no deviation is sought beyond
LEAST = 1e-9  # of the largest estimate or error: no estimate is known better


@dataclass(frozen=True)
class BetweenDeviation:
    """Standard deviation between groups, in the unit of the estimates, with its 95 % interval."""

    value: float
    interval95: tuple[float, float]


def statistic(estimates: Sequence[float], errors: Sequence[float], deviation: float) -> float:
    """Cochran's Q of estimates whose groups differ by `deviation` beside their standard errors."""
    values = np.asarray(estimates, float)
    least = LEAST * max(float(np.abs(values).max()), *errors)
    variances = np.square(np.maximum(errors, least)) + deviation**2
    mean = (values / variances).sum() / (1 / variances).sum()
    return float(((values - mean) ** 2 / variances).sum())


def between_deviation(estimates: Sequence[float], errors: Sequence[float]) -> BetweenDeviation:
    """The standard deviation between groups (n >= 2): the one at which Q is its expectation, and its interval."""
    degrees, tail = len(estimates) - 1, (1 - CONFIDENCE) / 2
    levels = (degrees, chi2.isf(tail, degrees), chi2.ppf(tail, degrees))
    value, low, high = (_where(estimates, errors, float(level)) for level in levels)
    return BetweenDeviation(value, (low, high))


def _where(estimates: Sequence[float], errors: Sequence[float], level: float) -> float:
    """The deviation at which Q falls to a level; 0 where it is below that without any."""
    if statistic(estimates, errors, 0.0) <= level:
        return 0.0
    widest = WIDEST * max(float(np.ptp(estimates)), max(errors))
    return float(brentq(lambda deviation: statistic(estimates, errors, deviation) - level, 0.0, widest))
