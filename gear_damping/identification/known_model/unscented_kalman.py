"""A joint unscented Kalman filter over many runs at once: displacement, velocity, logarithm of the damping ratio.

The sigma points go through the simulator from sample to sample (Julier and Uhlmann 2004; van der Merwe 2004 for the
scaling), so that the filter knows the same equation as the simulation.
"""

from collections.abc import Callable
from math import log, sqrt
from typing import NamedTuple

import torch
from torch import Tensor

from gear_damping.identification.known_model.estimate import HALF, Estimates
from gear_damping.identification.known_model.known_runs import KnownRuns

SIZE = 3  # displacement and velocity in units of their deviation at the start, and ln(damping ratio)
ALPHA, BETA, KAPPA = 0.5, 2.0, 0.0  # spread of the sigma points, what is known of a normal distribution, and the rest
DRIFT = 1e-10  # variance that each sample adds: against rounding
WIDEST = 2.0  # of the logarithm, beyond the range on either side: what a sigma point may ask of the simulator


def unscented_kalman(known: KnownRuns) -> Estimates:
    """The damping ratio of each run in %, with its 90 % interval."""
    mean, covariance = _passed(known)
    deviation = covariance[:, 2, 2].sqrt()
    ends = (mean[:, 2] + side * HALF * deviation for side in (-1, 1))
    centre = mean[:, 2] + deviation**2 / 2
    return Estimates(*(value.exp().clamp(*known.range_percent) for value in (centre, *ends)))


def smoothed_states(known: KnownRuns) -> tuple[Tensor, Tensor]:
    """The damping ratio of each run in %, (runs,), and the motion that all samples together make likely.

    The motion is displacement and velocity about the centre, in units of the runs, (runs, time, 2): the filter's, gone
    through backwards (Särkkä 2008).
    """
    steps: list[tuple[Tensor, Tensor, Tensor]] = []
    mean, _ = _passed(known, lambda step: steps.append(_gain(step)))
    states = [mean]
    for before, expected, gain in reversed(steps):
        states.append(before + (gain @ (states[-1] - expected).unsqueeze(-1)).squeeze(-1))
    return mean[:, 2].exp().clamp(*known.range_percent), torch.stack(states[::-1], 1)[..., :2]


class _Step(NamedTuple):
    """From one sample to the next: mean before it (runs, 3), points before and after it (points, runs, 3), and the mean
    (runs, 3) and covariance (runs, 3, 3) that are expected after it.
    """

    before: Tensor
    points: Tensor
    moved: Tensor
    mean: Tensor
    covariance: Tensor


def _passed(known: KnownRuns, note: Callable[[_Step], None] = lambda step: None) -> tuple[Tensor, Tensor]:
    """The filter over all samples: mean (runs, 3) and covariance (runs, 3, 3) after the last; each step is noted."""
    low, high = (log(end) for end in known.range_percent)
    mean = torch.zeros(len(known), SIZE, dtype=torch.float64)
    mean[:, 2] = (low + high) / 2
    covariance = DRIFT * torch.eye(SIZE, dtype=torch.float64).repeat(len(known), 1, 1)
    covariance[:, :2, :2] += torch.diag_embed((known.deviation / known.units).square())
    covariance[:, 2, 2] = (high - low) ** 2 / 12
    weights = _weights()
    for sample in range(known.records.shape[1] - 1):
        before, covariance = _corrected(known, sample, mean, covariance)
        points = _points(before, covariance)
        moved = _moved(known, points, sample)
        mean, covariance = _moments(moved, weights)
        note(_Step(before, points, moved, mean, covariance))
    return _corrected(known, known.records.shape[1] - 1, mean, covariance)


def _gain(step: _Step) -> tuple[Tensor, Tensor, Tensor]:
    """What going back over a step takes: the means on both sides of it and the smoother's gain (runs, 3, 3)."""
    off = step.points - step.before, step.moved - step.mean
    together = torch.einsum("p,pri,prj->rij", _weights()[1], *off)
    return step.before, step.mean, torch.linalg.solve(step.covariance, together.mT).mT


def _weights() -> tuple[Tensor, Tensor]:
    """Of the sigma points in the mean and in the covariance, (points,) each."""
    scale = ALPHA**2 * (SIZE + KAPPA)
    mean = torch.full((2 * SIZE + 1,), 1 / (2 * scale), dtype=torch.float64)
    mean[0] = 1 - SIZE / scale
    covariance = mean.clone()
    covariance[0] += 1 - ALPHA**2 + BETA
    return mean, covariance


def _points(mean: Tensor, covariance: Tensor) -> Tensor:
    """Sigma points, (points, runs, 3)."""
    root = sqrt(ALPHA**2 * (SIZE + KAPPA)) * torch.linalg.cholesky(covariance).mT
    steps = root.permute(1, 0, 2)
    return torch.cat([mean.unsqueeze(0), mean + steps, mean - steps])


def _moments(points: Tensor, weights: tuple[Tensor, Tensor]) -> tuple[Tensor, Tensor]:
    mean = (weights[0][:, None, None] * points).sum(0)
    off = points - mean
    covariance = torch.einsum("p,pri,prj->rij", weights[1], off, off)
    return mean, (covariance + covariance.mT) / 2 + DRIFT * torch.eye(SIZE, dtype=torch.float64)


def _corrected(known: KnownRuns, sample: int, mean: Tensor, covariance: Tensor) -> tuple[Tensor, Tensor]:
    """After a look at one sample: the displacement is seen behind noise, so that this step is exact."""
    scale = known.units[:, 0]
    off = (known.records[:, sample] - known.centre[:, 0]) / scale - mean[:, 0]
    gain = covariance[:, :, 0] / (covariance[:, 0, 0] + (known.noise / scale) ** 2)[:, None]
    left = torch.eye(SIZE, dtype=torch.float64).repeat(len(mean), 1, 1)
    left[:, :, 0] -= gain
    posterior = (
        left @ covariance @ left.mT + (gain[:, :, None] * gain[:, None, :]) * (known.noise / scale)[:, None, None] ** 2
    )
    return mean + gain * off[:, None], (posterior + posterior.mT) / 2


def _moved(known: KnownRuns, points: Tensor, sample: int) -> Tensor:
    """Sigma points one sample later."""
    low, high = (log(end) for end in known.range_percent)
    ratio = points[..., 2].clamp(low - WIDEST, high + WIDEST).exp()
    _, states = known.from_there(ratio, points[..., :2], sample, 1)
    return torch.cat([states, points[..., 2:]], -1)
