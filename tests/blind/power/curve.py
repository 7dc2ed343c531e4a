"""From successes at several sizes to the size at which nine of ten succeed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

MIDDLES = np.log(np.geomspace(0.05, 30.0, 240))  # of the curve, in multiples of the limit
WIDTHS = np.geomspace(0.05, 1.0, 40)  # of the curve, in the logarithm of the size
POWER = 0.9


def size_at_power(
    sizes: Sequence[float], successes: Sequence[bool], power: float = POWER
) -> tuple[float, float, float]:
    """Size at which a share `power` of cases succeeds, with its 95 % interval.

    A logistic curve over the logarithm of the size; its middle and its width are averaged over with even prior weight
    in their logarithms within MIDDLES and WIDTHS, since twenty cases that all succeed, or all beyond one size, have no
    largest likelihood.
    """
    x, good = np.log(np.asarray(sizes, dtype=float)), np.asarray(successes, dtype=bool)
    middle, width = MIDDLES[:, None, None], WIDTHS[None, :, None]
    slope = (x - middle) / width
    likelihood = np.where(good, -np.logaddexp(0.0, -slope), -np.logaddexp(0.0, slope)).sum(-1)
    weight = np.exp(likelihood - likelihood.max())
    at = MIDDLES[:, None] + WIDTHS[None, :] * np.log(power / (1.0 - power))
    order = np.argsort(at, axis=None)
    share = np.cumsum(weight.ravel()[order])
    low, median, high = np.interp([0.025, 0.5, 0.975], share / share[-1], at.ravel()[order])
    return float(np.exp(median)), float(np.exp(low)), float(np.exp(high))
