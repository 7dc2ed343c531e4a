"""Levenberg–Marquardt over several starts at once, the starts being members of one batch."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from gear_damping.identification.output_error.problem import OutputErrorProblem, Prediction

FIRST_DAMPING, LARGEST_DAMPING, SMALLEST_DAMPING = 1e-2, 1e10, 1e-12
SMALLEST_GAIN = 1e-7  # relative fall of the cost below which a start has converged
CALM_STEPS = 3  # steps in a row that change the cost by little: one alone may be short
INDEPENDENT = 1e-9  # of the largest: a direction that counts
LONGEST_STEP = 2.0  # of any coordinate in one iteration; far out, that many times the way from the start


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


@dataclass(frozen=True)
class NormalEquations:
    """J'J and J'r of several starts, in blocks: what a record has of its own meets only that record.

    Args:
        shared: Of the shared parameters, (starts, p, p).
        between: Of these and every record's own, (starts, records, p, l).
        own: Of every record's own, (starts, records, l, l).
        pull: J'r of the shared parameters, (starts, p).
        own_pull: J'r of every record's own, (starts, records, l).
    """

    shared: Tensor
    between: Tensor
    own: Tensor
    pull: Tensor
    own_pull: Tensor

    def only(self, free: Tensor) -> "NormalEquations":
        """With the shared parameters held that are not free, (starts, p)."""
        kept = free.to(self.pull.dtype)
        shared = self.shared * kept.unsqueeze(-1) * kept.unsqueeze(-2)
        return replace(self, shared=shared, between=self.between * kept[:, None, :, None], pull=self.pull * kept)

    def step(self, damping: Tensor) -> tuple[Tensor, Tensor]:
        """The damped step, (starts, p) and (starts, records, l), by elimination of what is the records' own."""
        diagonals = self.shared.diagonal(dim1=-2, dim2=-1), self.own.diagonal(dim1=-2, dim2=-1)
        largest = torch.cat([d.flatten(1) for d in diagonals], 1).amax(1).clamp(min=1e-30)
        ridges = [_like(damping, d) * d + _like(1e-12 * largest, d) for d in diagonals]
        own = self.own + torch.diag_embed(ridges[1])
        right = torch.cat([self.between.transpose(-1, -2), self.own_pull.unsqueeze(-1)], -1)
        solved = torch.linalg.solve(own, right)
        reduced = (self.between @ solved).sum(1)
        matrix = self.shared + torch.diag_embed(ridges[0]) - reduced[..., :-1]
        shared = torch.linalg.solve(matrix, self.pull - reduced[..., -1])
        return shared, solved[..., -1] - (solved[..., :-1] @ shared[:, None, :, None]).squeeze(-1)


def normal_equations(prediction: Prediction, n_shared: int) -> NormalEquations:
    """J'J and J'r of a linearisation."""
    sensitivity, residual = prediction.sensitivity, prediction.residual.unsqueeze(-1)
    shared, own = sensitivity[..., :n_shared], sensitivity[..., n_shared:]
    flat = shared.flatten(1, 2)
    return NormalEquations(
        (flat.transpose(1, 2) @ flat).nan_to_num(0, 0, 0),
        (shared.transpose(-1, -2) @ own).nan_to_num(0, 0, 0),
        (own.transpose(-1, -2) @ own).nan_to_num(0, 0, 0),
        (flat.transpose(1, 2) @ residual.flatten(1, 2)).squeeze(-1).nan_to_num(0, 0, 0),
        (own.transpose(-1, -2) @ residual).squeeze(-1).nan_to_num(0, 0, 0),
    )


def own_basis(sensitivity: Tensor, n_shared: int) -> Tensor:
    """Orthonormal columns that span what every record has of its own, (records, time, l); zero where it is less.

    Args:
        sensitivity: Of one start, (records, time, n_shared + l).
        n_shared: Number of shared parameters.
    """
    own = sensitivity[..., n_shared:]
    columns = own / own.norm(dim=1, keepdim=True).clamp(min=1e-300)
    basis, sizes, _ = torch.linalg.svd(columns, full_matrices=False)
    return basis * (sizes > INDEPENDENT * sizes.amax(-1, keepdim=True)).unsqueeze(1)


def without_own(signal: Tensor, basis: Tensor) -> Tensor:
    """`signal` (records, time, n) without what the records' own columns could do."""
    return signal - basis @ (basis.transpose(-1, -2) @ signal)


def _like(value: Tensor, other: Tensor) -> Tensor:
    """(starts,) with the number of dimensions of another."""
    return value.reshape(-1, *[1] * (other.ndim - 1))


def fit(
    problem: OutputErrorProblem,
    shared: Tensor,
    horizons: Sequence[float | None] | None = None,
    iterations: int | Sequence[int] = 40,
    states: Tensor | None = None,
    report: Callable[[int, int], None] | None = None,
    kept: float = 0.5,
    enough: float = 0.0,
) -> Fitted:
    """The best of several starts.

    Args:
        problem: What is fitted to what.
        shared: Coordinates of the starts, (starts, n); those that are left out at the end begin at 0.
        horizons: Seconds of each round, growing, None for all; a short first round keeps away from local minima.
        iterations: At most so many in each round, or in each of the rounds.
        states: Initial states of the starts, (starts, records, local); from the records where absent.
        report: Told (done, total) rounds.
        kept: Share of the starts, the best ones, that goes on from round to round.
        enough: Fall of the cost below which a start has converged, whatever share of the cost it is.
    """
    if states is None:
        states = problem.first_states().expand(shared.shape[0], -1, -1).clone()
    points = Points(problem.within(problem.completed(shared)), states)
    rounds = list(horizons or [None])
    most = [iterations] * len(rounds) if isinstance(iterations, int) else iterations
    for number, horizon in enumerate(rounds):
        points, prediction, cost, converged = _round(problem, points, horizon, most[number], enough)
        if report:
            report(number + 1, len(rounds))
        if number < len(rounds) - 1:
            points = points.pick(cost.argsort()[: max(1, round(kept * len(cost)))])
    best = int(cost.argmin())
    chosen = replace(
        prediction, residual=prediction.residual[best : best + 1], sensitivity=prediction.sensitivity[best : best + 1]
    )
    return Fitted(points.shared[best], points.states[best], chosen, float(cost[best]), bool(converged[best]))


def _round(
    problem: OutputErrorProblem, points: Points, horizon: float | None, iterations: int, enough: float
) -> tuple[Points, Prediction, Tensor, Tensor]:
    now = problem.linearise(points.shared, points.states, horizon)
    cost = _cost(problem, points, now)
    damping = torch.full_like(cost, FIRST_DAMPING)
    converged = torch.zeros_like(cost, dtype=torch.bool)
    calm = torch.zeros_like(cost, dtype=torch.long)
    for _ in range(iterations):
        trial = _step(problem, points, now, damping)
        new = problem.linearise(trial.shared, trial.states, horizon)
        new_cost = _cost(problem, trial, new)
        better = new_cost < cost
        flat = (cost - new_cost).abs() <= torch.maximum(SMALLEST_GAIN * cost, torch.full_like(cost, enough))
        calm = torch.where(flat, calm + 1, torch.where(better, 0, calm))
        converged = (calm >= CALM_STEPS) | (damping >= LARGEST_DAMPING)
        points = Points(_select(better, trial.shared, points.shared), _select(better, trial.states, points.states))
        residual, sensitivity = (
            _select(better, a, b) for a, b in ((new.residual, now.residual), (new.sensitivity, now.sensitivity))
        )
        now = replace(now, residual=residual, sensitivity=sensitivity)
        cost = torch.where(better, new_cost, cost)
        damping = torch.where(better, damping / 5, damping * 6).clamp(SMALLEST_DAMPING, LARGEST_DAMPING)
        if bool(converged.all()):
            break
    return points, now, cost, converged


def _step(problem: OutputErrorProblem, points: Points, now: Prediction, damping: Tensor) -> Points:
    """The damped step within the bounds; a parameter that is pulled beyond its bound stays there."""
    equations = normal_equations(now, problem.n_shared)
    expected, slope = problem.expectation(points.shared)
    matrix, pull = equations.shared + torch.diag(slope.square()), equations.pull + slope * expected
    equations = replace(equations, shared=matrix, pull=pull)
    free = problem.at_bound(points.shared) * pull <= 0
    shared, own = equations.only(free).step(damping)
    longest = LONGEST_STEP * torch.where(problem.logarithmic, 1.0, points.shared.abs().clamp(min=1))
    shared, own = shared.clamp(-longest, longest), own.clamp(-LONGEST_STEP, LONGEST_STEP)
    return Points(problem.within(points.shared + shared), points.states + own)


def _cost(problem: OutputErrorProblem, points: Points, prediction: Prediction) -> Tensor:
    total = prediction.residual.square().sum((1, 2)) + problem.expectation(points.shared)[0].square().sum(1)
    return torch.where(total.isfinite(), total, torch.full_like(total, float("inf")))


def _select(better: Tensor, new: Tensor, old: Tensor) -> Tensor:
    return torch.where(better.reshape(-1, *[1] * (new.ndim - 1)), new, old)
