"""Output error of many runs at once: damping ratio and start by least squares on simulated responses.

Gauss-Newton steps with Levenberg's damping over growing stretches of the record (Ljung 1999, chapter 10), several
damping ratios to begin with; more of them, and more slowly, where more is left than the noise. The answer is the mean
of the distribution that is left, normal within the range.
"""

from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor

from gear_damping.identification.known_model.estimate import Estimates, within
from gear_damping.identification.known_model.family import KnownRuns

DOUBT = 2.0  # standard deviations of a sum of squares above what noise leaves: then another valley is looked for
STEP = 1e-4  # of the range, and of a deviation of the start: differences
FEWER, MORE, FIRST = 0.2, 5.0, 1e-2  # Levenberg's damping after a good and a bad step, and at first


@dataclass(frozen=True)
class _Search:
    """Where to begin and how to go on.

    Args:
        shares: Of the range of damping ratios: where the starts lie.
        stretches: Samples that are looked at one after another, before the whole record.
        kept: Starts that are left after each stretch, the best ones; one after the whole record.
    """

    shares: tuple[float, ...]
    stretches: tuple[int, ...]
    kept: tuple[int, ...]


# Starts over the range of damping ratios, samples of growing stretches, and how many fits go on from each: few starts
# suffice where the motion forgets (PLAIN), and many are needed where the likelihood has many peaks (CAREFUL).
PLAIN = _Search((0.1, 0.45, 0.8), (60, 200, 600), (3, 3, 1))
SIXTEEN = tuple((number + 0.5) / 16 for number in range(16))
# As many starts as lie in the middle of sixteen equal parts.
CAREFUL = _Search(SIXTEEN, (60, 100, 170, 300, 500, 850, 1400), (16, 16, 12, 8, 8, 6, 6))
STEPS, LAST = 5, 10  # of each stretch, and of the whole record


class _Points(NamedTuple):
    """Coordinates (starts, runs, 3): damping ratio in ranges above the smallest, start in deviations."""

    places: Tensor
    cost: Tensor
    damping: Tensor


def output_error(known: KnownRuns) -> Estimates:
    """The damping ratio of each run in %, with its 90 % interval."""
    length = known.records.shape[1]
    found = _found(known, PLAIN)
    doubtful = found.cost[0] > length + DOUBT * (2 * length) ** 0.5
    if bool(doubtful.any()):
        again = _found(known.pick(doubtful), CAREFUL)
        better = again.cost[0] < found.cost[0, doubtful]
        found.places[0, doubtful] = torch.where(better.unsqueeze(-1), again.places[0], found.places[0, doubtful])
    deviation = torch.linalg.inv(_information(known, found.places))[:, 0, 0].sqrt()
    low, high = known.range_percent
    return within(low + (high - low) * found.places[0, :, 0], (high - low) * deviation, (low, high))


def misfit(known: KnownRuns) -> Tensor:
    """What the nearest run of the family leaves of each record: root mean square over the noise, (runs,).

    Of the plain search alone: what is far from every run of the family is in the wrong valley of all of them.
    """
    return (_found(known, PLAIN).cost[0] / known.records.shape[1]).sqrt()


def _found(known: KnownRuns, search: _Search) -> _Points:
    """The lowest point of each run that a search comes to, one start."""
    length, places = known.records.shape[1], torch.zeros(len(search.shares), len(known), 3, dtype=torch.float64)
    places[..., 0] = torch.tensor(search.shares, dtype=torch.float64)[:, None]
    shorter = [(samples, kept) for samples, kept in zip(search.stretches, search.kept, strict=True) if samples < length]
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


