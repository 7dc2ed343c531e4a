"""Levenberg–Marquardt over several starts at once, the starts being members of one batch."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.identification.output_error.problem import OutputErrorProblem, Prediction

FIRST_DAMPING, LARGEST_DAMPING, SMALLEST_DAMPING = 1e-2, 1e10, 1e-12
SMALLEST_GAIN = 1e-7  # relative fall of the cost below which a start has converged
LONGEST_STEP = 2.0  # of any coordinate in one iteration


@dataclass
class Points:
    """Several starts on their way down.

    Args:
        shared: Coordinates of the shared parameters, (starts, n_shared).
        states: Initial states, (starts, records, local).
    """

    shared: Tensor
    states: Tensor

    def pick(self, index: Tensor) -> "Points":
        """Some of the starts."""
        return Points(self.shared[index], self.states[index])


@dataclass(frozen=True)
class Fitted:
    """The best point with its linearisation."""

    shared: Tensor
    states: Tensor
    prediction: Prediction
    cost: float
    converged: bool


def normal_equations(prediction: Prediction, n_shared: int) -> tuple[Tensor, Tensor]:
    """J'J and J'r over shared columns and every record's own ones, (starts, p, p) and (starts, p)."""
    jacobian = full_jacobian(prediction.sensitivity, n_shared)
    residual = prediction.residual.reshape(jacobian.shape[0], -1)
    return jacobian.transpose(1, 2) @ jacobian, (jacobian.transpose(1, 2) @ residual.unsqueeze(-1)).squeeze(-1)


def full_jacobian(sensitivity: Tensor, n_shared: int) -> Tensor:
    """(starts, records * time, n_shared + records * local) from (starts, records, time, columns)."""
    starts, records, samples, columns = sensitivity.shape
    local = columns - n_shared
    jacobian = sensitivity.new_zeros(starts, records, samples, n_shared + records * local)
    jacobian[..., :n_shared] = sensitivity[..., :n_shared]
    for r in range(records):
        first = n_shared + r * local
        jacobian[:, r, :, first : first + local] = sensitivity[:, r, :, n_shared:]
    return jacobian.reshape(starts, records * samples, -1)


def fit(
    problem: OutputErrorProblem,
    shared: Tensor,
    horizons: Sequence[int] | None = None,
    iterations: int | Sequence[int] = 40,
    states: Tensor | None = None,
    report: Callable[[int, int], None] | None = None,
    kept: float = 0.5,
    enough: float = 0.0,
) -> Fitted:
    """The best of several starts.

    Args:
        problem: What is fitted to what.
        shared: Coordinates of the starts, (starts, n_shared).
        horizons: Samples of each round, growing; a short first round keeps away from local minima.
        iterations: At most so many in each round, or in each of the rounds.
        states: Initial states of the starts, (starts, records, local); from the records where absent.
        report: Told (done, total) rounds.
        kept: Share of the starts, the best ones, that goes on from round to round.
        enough: Fall of the cost below which a start has converged, whatever share of the cost it is.
    """
    if states is None:
        states = problem.first_states().expand(shared.shape[0], -1, -1).clone()
    points = Points(shared.clone(), states)
    rounds = list(horizons or [problem.response.shape[1]])
    most = [iterations] * len(rounds) if isinstance(iterations, int) else iterations
    for number, samples in enumerate(rounds):
        points, prediction, cost, converged = _round(problem, points, samples, most[number], enough)
        if report:
            report(number + 1, len(rounds))
        if number < len(rounds) - 1:
            points = points.pick(cost.argsort()[: max(1, round(kept * len(cost)))])
    best = int(cost.argmin())
    chosen = Prediction(prediction.residual[best : best + 1], prediction.sensitivity[best : best + 1])
    return Fitted(points.shared[best], points.states[best], chosen, float(cost[best]), bool(converged[best]))


def _round(
    problem: OutputErrorProblem, points: Points, samples: int, iterations: int, enough: float
) -> tuple[Points, Prediction, Tensor, Tensor]:
    now = problem.linearise(points.shared, points.states, samples)
    cost = _cost(problem, points, now)
    damping = torch.full_like(cost, FIRST_DAMPING)
    converged = torch.zeros_like(cost, dtype=torch.bool)
    for _ in range(iterations):
        trial = _step(problem, points, now, damping)
        new = problem.linearise(trial.shared, trial.states, samples)
        new_cost = _cost(problem, trial, new)
        better = new_cost < cost
        gain = torch.where(better, (cost - new_cost) / cost.clamp(min=1e-300), torch.zeros_like(cost))
        small = (gain < SMALLEST_GAIN) | (cost - new_cost < enough)
        converged = (better & small) | (damping >= LARGEST_DAMPING) | (converged & ~better)
        points = Points(_select(better, trial.shared, points.shared), _select(better, trial.states, points.states))
        now = Prediction(_select(better, new.residual, now.residual), _select(better, new.sensitivity, now.sensitivity))
        cost = torch.where(better, new_cost, cost)
        damping = torch.where(better, damping / 5, damping * 6).clamp(SMALLEST_DAMPING, LARGEST_DAMPING)
        if bool(converged.all()):
            break
    return points, now, cost, converged


def _step(problem: OutputErrorProblem, points: Points, now: Prediction, damping: Tensor) -> Points:
    matrix, gradient = normal_equations(now, problem.n_shared)
    matrix, gradient = matrix.nan_to_num(0, 0, 0), gradient.nan_to_num(0, 0, 0)
    expected, slope = problem.expectation(points.shared)
    own = torch.cat([slope, slope.new_zeros(matrix.shape[1] - len(slope))])
    matrix = matrix + torch.diag(own.square())
    gradient[:, : len(slope)] += slope * expected
    diagonal = matrix.diagonal(dim1=1, dim2=2)
    ridge = damping.unsqueeze(1) * diagonal + 1e-12 * diagonal.amax(1, keepdim=True).clamp(min=1e-30)
    step = torch.linalg.solve(matrix + torch.diag_embed(ridge), gradient)
    step = step.clamp(-LONGEST_STEP, LONGEST_STEP)
    moved = points.states + step[:, problem.n_shared :].reshape(points.states.shape)
    return Points(points.shared + step[:, : problem.n_shared], moved)


def _cost(problem: OutputErrorProblem, points: Points, prediction: Prediction) -> Tensor:
    total = prediction.residual.square().sum((1, 2)) + problem.expectation(points.shared)[0].square().sum(1)
    return torch.where(total.isfinite(), total, torch.full_like(total, float("inf")))


def _select(better: Tensor, new: Tensor, old: Tensor) -> Tensor:
    return torch.where(better.reshape(-1, *[1] * (new.ndim - 1)), new, old)
