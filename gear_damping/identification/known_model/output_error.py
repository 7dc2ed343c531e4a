"""Output error of many runs at once: damping ratio and start by least squares on simulated responses.

Gauss-Newton steps with Levenberg's damping over growing stretches of the record (Ljung 1999, chapter 10), several
damping ratios to begin with. The answer is the mean of the distribution that is left, normal within the range.
"""

from typing import NamedTuple

import torch
from torch import Tensor

from gear_damping.identification.known_model.estimate import Estimates, within
from gear_damping.identification.known_model.family import KnownRuns

SHARES = (0.1, 0.45, 0.8)  # of the range of damping ratios: where the starts lie
STRETCHES = (60, 200, 600)  # samples, before the whole record
STEPS = (5, 5, 6, 10)  # of each stretch
STEP = 1e-4  # of the range, and of a deviation of the start: differences
FEWER, MORE, FIRST = 0.2, 5.0, 1e-2  # Levenberg's damping after a good and a bad step, and at first


class _Points(NamedTuple):
    """Coordinates (starts, runs, 3): damping ratio in ranges above the smallest, start in deviations."""

    places: Tensor
    cost: Tensor
    damping: Tensor


def output_error(known: KnownRuns) -> Estimates:
    """The damping ratio of each run in %, with its 90 % interval."""
    length = known.records.shape[1]
    stretches = [one for one in STRETCHES if one < length] + [length]
    places = torch.zeros(len(SHARES), len(known), 3, dtype=torch.float64)
    places[..., 0] = torch.tensor(SHARES, dtype=torch.float64)[:, None]
    for number, samples in enumerate(stretches):
        points = _began(known, places, samples)
        for _ in range(STEPS[number - len(stretches)]):
            points = _stepped(known, points, samples)
        places = _best(points).unsqueeze(0) if samples >= STRETCHES[-1] else points.places
    information = _information(known, places)
    deviation = torch.linalg.inv(information)[:, 0, 0].sqrt()
    low, high = known.range_percent
    scale = high - low
    return within(low + scale * places[0, :, 0], scale * deviation, (low, high))


def _residuals(known: KnownRuns, places: Tensor, samples: int) -> Tensor:
    """Of the record in deviations of its noise, then what is expected of the start, (starts, runs, samples + 2)."""
    low, high = known.range_percent
    response = known.response(low + (high - low) * places[..., 0], places[..., 1:], samples)
    left = (response - known.records[:, :samples]) / known.noise[:, None]
    return torch.cat([left, places[..., 1:]], -1)


def _began(known: KnownRuns, places: Tensor, samples: int) -> _Points:
    cost = _residuals(known, places, samples).square().sum(-1)
    return _Points(places, cost, torch.full_like(cost, FIRST))


def _linearised(known: KnownRuns, places: Tensor, samples: int) -> tuple[Tensor, Tensor]:
    """Residuals and their slopes (..., 3), one simulation of all blocks."""
    moved = torch.cat([places, *(places + STEP * axis for axis in torch.eye(3, dtype=torch.float64))])
    found = _residuals(known, moved, samples).unflatten(0, (4, len(places)))
    return found[0], torch.stack([(side - found[0]) / STEP for side in found[1:]], -1)


def _stepped(known: KnownRuns, points: _Points, samples: int) -> _Points:
    """One step of every start and run; a step that does not lower the cost is not taken."""
    residual, slopes = _linearised(known, points.places, samples)
    square = slopes.mT @ slopes
    size = torch.diag_embed(square.diagonal(dim1=-2, dim2=-1)) * points.damping[..., None, None]
    downhill = (slopes.mT @ residual.unsqueeze(-1)).nan_to_num()
    step = torch.linalg.solve((square + size).nan_to_num() + 1e-9 * torch.eye(3, dtype=torch.float64), downhill)
    tried = points.places - step.squeeze(-1)
    tried[..., 0] = tried[..., 0].clamp(0, 1)
    cost = _residuals(known, tried, samples).square().sum(-1).nan_to_num(torch.inf)
    better = cost < points.cost
    return _Points(
        torch.where(better.unsqueeze(-1), tried, points.places),
        torch.where(better, cost, points.cost),
        torch.where(better, points.damping * FEWER, points.damping * MORE),
    )


def _best(points: _Points) -> Tensor:
    """The coordinates of the start that came lowest, (runs, 3)."""
    first = points.cost.argmin(0)
    return points.places[first, torch.arange(len(first))]


def _information(known: KnownRuns, places: Tensor) -> Tensor:
    _, slopes = _linearised(known, places, known.records.shape[1])
    return (slopes.mT @ slopes)[0]


