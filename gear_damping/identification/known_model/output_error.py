"""Output error of many runs at once: damping ratio and start by least squares on simulated responses.

Gauss-Newton steps with Levenberg's damping, begun twice: from several damping ratios over growing stretches of the
record (Ljung 1999, chapter 10), and from the motion of a Kalman smoother by multiple shooting, which finds the valley
where flanks part and errors of the start grow. The lower one counts. The answer is the mean of the distribution that
is left, normal within the range.
"""

from typing import NamedTuple

import torch
from torch import Tensor

from gear_damping.identification.known_model.estimate import Estimates, within
from gear_damping.identification.known_model.known_runs import KnownRuns
from gear_damping.identification.known_model.multiple_shooting import multiple_shooting
from gear_damping.identification.known_model.unscented_kalman import smoothed_states

STEP = 1e-4  # of the range, and of a deviation of the start: differences
FEWER, MORE, FIRST = 0.2, 5.0, 1e-2  # Levenberg's damping after a good and a bad step, and at first
SHARES = (0.1, 0.45, 0.8)  # of the range of damping ratios: where the search begins
STRETCHES, KEPT = (60, 200, 600), (3, 3, 1)  # samples looked at one after another, and starts left after each
STEPS, LAST = 5, 10  # of each stretch, and of the whole record
BLOCK = 250  # runs smoothed at a time: the smoother keeps 15 numbers of each sample


class _Points(NamedTuple):
    """Coordinates (starts, runs, 3): damping ratio in ranges above the smallest, start in deviations."""

    places: Tensor
    cost: Tensor
    damping: Tensor


def output_error(known: KnownRuns) -> Estimates:
    """The damping ratio of each run in %, with its 90 % interval."""
    places = torch.cat([_lowest(known.pick(rows)) for rows in torch.arange(len(known)).split(BLOCK)], 1)
    deviation = torch.linalg.inv(_information(known, places))[:, 0, 0].sqrt()
    low, high = known.range_percent
    return within(low + (high - low) * places[0, :, 0], (high - low) * deviation, (low, high))


def _lowest(known: KnownRuns) -> Tensor:
    """The lower one of where the search ends and where multiple shooting ends, (1, runs, 3)."""
    searched, (ratio, states) = _found(known), smoothed_states(known)
    low, high = known.range_percent
    joined = multiple_shooting(known, (ratio - low) / (high - low), states)
    shot = _walked(known, joined.unsqueeze(0), known.records.shape[1], LAST)
    both = (torch.cat([getattr(points, name) for points in (searched, shot)]) for name in _Points._fields)
    return _best(_Points(*both), 1).places


def misfit(known: KnownRuns) -> Tensor:
    """What the nearest run of the family leaves of each record: root mean square over the noise, (runs,).

    Of the search alone: what is far from every run of the family is in the wrong valley of all of them.
    """
    return (_found(known).cost[0] / known.records.shape[1]).sqrt()


def _found(known: KnownRuns) -> _Points:
    """The lowest point of each run that a search over growing stretches comes to, one start."""
    length, places = known.records.shape[1], torch.zeros(len(SHARES), len(known), 3, dtype=torch.float64)
    places[..., 0] = torch.tensor(SHARES, dtype=torch.float64)[:, None]
    shorter = [(samples, kept) for samples, kept in zip(STRETCHES, KEPT, strict=True) if samples < length]
    for samples, kept in shorter:
        places = _best(_walked(known, places, samples, STEPS), kept).places
    return _best(_walked(known, places, length, LAST), 1)


def _walked(known: KnownRuns, places: Tensor, samples: int, steps: int) -> _Points:
    points = _began(known, places, samples)
    for _ in range(steps):
        points = _stepped(known, points, samples)
    return points


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


def _best(points: _Points, kept: int) -> _Points:
    """The starts that came lowest, run by run."""
    order = points.cost.argsort(0)[:kept]
    places = points.places.gather(0, order.unsqueeze(-1).expand(-1, -1, 3))
    return _Points(places, points.cost.gather(0, order), points.damping.gather(0, order))


def _information(known: KnownRuns, places: Tensor) -> Tensor:
    _, slopes = _linearised(known, places, known.records.shape[1])
    return (slopes.mT @ slopes)[0]
