"""What an estimator says of many runs at once."""

from dataclasses import dataclass

import torch
from torch import Tensor

LEVEL = 0.9  # probability that an interval states, that of the networks beside it
GRID, REACH = 801, 8.0  # points of a cut distribution; deviations beyond which nothing of it is left
HALF = 1.6448536269514722  # standard deviations of a normal distribution on either side that hold so much


@dataclass(frozen=True)
class Estimates:
    """Damping ratios with their intervals.

    Args:
        ratio: In %, (runs,).
        low: Lower end of the 90 % interval, (runs,); nan of an estimator without one.
        high: Upper end.
    """

    ratio: Tensor
    low: Tensor
    high: Tensor

    @classmethod
    def without_interval(cls, ratio: Tensor) -> "Estimates":
        """Of an estimator that gives none."""
        none = torch.full_like(ratio, torch.nan)
        return cls(ratio, none, none)


def within(centre: Tensor, deviation: Tensor, ends: tuple[float, float]) -> Estimates:
    """A normal distribution cut at the ends of what is possible: its mean, and where its middle nine tenths lie.

    Args:
        centre: Of the normal distribution, (runs,).
        deviation: Its standard deviation, (runs,).
        ends: Smallest and largest value.
    """
    low, high = ((end - centre) / deviation for end in ends)
    grid = torch.linspace(0, 1, GRID, dtype=centre.dtype)
    left, right = low.clamp(-REACH, REACH), high.clamp(-REACH, REACH)
    places = left[:, None] + (right - left)[:, None] * grid
    weight = torch.exp(-(places**2 - places.abs().amin(1, keepdim=True) ** 2) / 2)
    weight[:, [0, -1]] /= 2  # by the trapezoidal rule
    weight = weight / weight.sum(1, keepdim=True)
    mean = centre + deviation * (weight * places).sum(1)
    below = weight.cumsum(1)
    edges = [centre + deviation * _quantile(places, below, share) for share in ((1 - LEVEL) / 2, (1 + LEVEL) / 2)]
    bounded = (value.clamp(*ends) for value in (mean, *edges))
    return Estimates(*bounded)


def _quantile(places: Tensor, below: Tensor, share: float) -> Tensor:
    number = torch.searchsorted(below, torch.full((len(below), 1), share, dtype=below.dtype)).clamp(max=GRID - 1)
    return places.gather(1, number).squeeze(1)
