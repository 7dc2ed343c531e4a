"""Multiple shooting of many runs at once: a record in segments, whose starts are unknown and must meet.

A start whose errors grow a thousandfold over a record leaves a single simulation in the wrong valley; over a segment
they grow little. Gauss-Newton steps on all segments together, in which the equations that join them are linearised
and the inner starts eliminated (Bock 1983; Deuflhard & Bornemann 2002, section 8.6.2).
"""

from typing import NamedTuple

import torch
from torch import Tensor

from gear_damping.identification.known_model.known_runs import KnownRuns

SEGMENT = 50  # samples: a few natural periods, over which the error of a start hardly grows
STEPS = 6  # Gauss-Newton steps; from a smoothed motion two or three bring the segments together
MOVE = 1e-5  # of the range and of the units of the motion: differences


class _Segment(NamedTuple):
    """One segment of all runs: residuals in deviations of the noise, the state at its end, and the slopes of both.

    Slopes are by the share of the range and by the state at the segment's start, (runs, …, 3).
    """

    residual: Tensor
    slopes: Tensor
    end: Tensor
    end_slopes: Tensor


def multiple_shooting(known: KnownRuns, share: Tensor, states: Tensor) -> Tensor:
    """Damping ratio and start that join the segments best.

    Args:
        known: The runs.
        share: Damping ratio to begin with, in ranges above the smallest, (runs,).
        states: Displacement and velocity to begin with about the centre, in units of the runs, (runs, time, 2).

    Returns:
        Share of the range, and the start in its standard deviations, (runs, 3).
    """
    per_deviation = known.deviation / known.units
    nodes = states[:, ::SEGMENT].clone()
    start = torch.where(per_deviation > 0, nodes[:, 0] / per_deviation, torch.zeros_like(per_deviation))
    for _ in range(STEPS):
        nodes[:, 0] = start * per_deviation
        segments = [_segment(known, share, nodes[:, number], number) for number in range(nodes.shape[1])]
        step, moved = _step(segments, nodes, start, per_deviation)
        share, start = (share + step[:, 0]).clamp(0, 1), start + step[:, 1:]
        nodes = torch.where(moved.isfinite(), moved, nodes)
    return torch.cat([share[:, None], start], -1)


def _segment(known: KnownRuns, share: Tensor, state: Tensor, number: int) -> _Segment:
    """The segment with its slopes by differences, one simulation of four blocks of all runs."""
    first = number * SEGMENT
    samples = min(SEGMENT, known.records.shape[1] - first)
    places = torch.cat([share[:, None], state], -1)
    moved = torch.stack([places, *(places + MOVE * axis for axis in torch.eye(3, dtype=torch.float64))])
    low, high = known.range_percent
    response, end = known.from_there(low + (high - low) * moved[..., 0], moved[..., 1:], first, samples)
    residual = (response - known.records[:, first : first + samples]) / known.noise[:, None]
    slopes = torch.stack([(side - residual[0]) / MOVE for side in residual[1:]], -1)
    return _Segment(residual[0], slopes, end[0], torch.stack([(side - end[0]) / MOVE for side in end[1:]], -1))


def _step(segments: list[_Segment], nodes: Tensor, start: Tensor, per_deviation: Tensor) -> tuple[Tensor, Tensor]:
    """The step of share and start (runs, 3), and the nodes after it.

    Each node follows from the three unknowns: its change is `follows @ step + gap`.
    """
    follows = torch.cat([torch.zeros_like(per_deviation)[..., None], torch.diag_embed(per_deviation)], -1)
    gap = torch.zeros_like(start)
    square = torch.diag_embed(torch.tensor([0.0, 1.0, 1.0], dtype=torch.float64)).expand(len(start), 3, 3).clone()
    downhill = torch.cat([torch.zeros_like(start[:, :1]), -start], -1)  # what is expected of the start
    joined = []
    for number, one in enumerate(segments):
        joined.append((follows, gap))
        slopes = one.slopes[..., 1:] @ follows
        slopes[..., 0] += one.slopes[..., 0]
        residual = one.residual + _times(one.slopes[..., 1:], gap)
        square, downhill = square + slopes.mT @ slopes, downhill - _times(slopes.mT, residual)
        if number + 1 < len(segments):
            gap = _times(one.end_slopes[..., 1:], gap) + one.end - nodes[:, number + 1]
            follows = one.end_slopes[..., 1:] @ follows
            follows[..., 0] += one.end_slopes[..., 0]
    step = _solved(square, downhill)
    return step, torch.stack([nodes[:, i] + _times(f, step) + g for i, (f, g) in enumerate(joined)], 1)


def _solved(square: Tensor, downhill: Tensor) -> Tensor:
    """The step, none where the equations have no finite solution; scaled, since the unknowns differ by far."""
    size = square.diagonal(dim1=-2, dim2=-1).clamp(min=torch.finfo(torch.float64).tiny).sqrt()
    scaled = (square / size[:, :, None] / size[:, None, :]).nan_to_num(posinf=0.0, neginf=0.0)
    found, _ = torch.linalg.solve_ex(scaled, (downhill / size).unsqueeze(-1))
    return (found.squeeze(-1) / size).nan_to_num(nan=0.0, posinf=0.0, neginf=0.0)


def _times(matrix: Tensor, vector: Tensor) -> Tensor:
    return (matrix @ vector.unsqueeze(-1)).squeeze(-1)
