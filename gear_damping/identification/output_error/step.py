"""One step of Levenberg–Marquardt from points with their linearisation, and its bend along a narrow valley."""

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from gear_damping.identification.output_error.normal_equations import NormalEquations, normal_equations
from gear_damping.identification.output_error.problem import OutputErrorProblem, Prediction

LONGEST_STEP = 2.0  # of any coordinate in one iteration; far out, that many times the way from the start
AHEAD = 0.1  # of a step: there it is seen how the response bends (Transtrum & Sethna)
MOST_BENT = 0.75  # of a step, twice the correction for the bend: beyond it the second order foretells nothing


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

    def put(self, index: Tensor, other: "Points") -> None:
        """Other points in the place of some."""
        self.shared[index], self.states[index] = other.shared, other.states


def moves(problem: OutputErrorProblem, old: Points, new: Points) -> Tensor:
    """Change of every column's coordinate, by record, (starts, records, columns)."""
    shared = (new.shared - old.shared).unsqueeze(1) * problem.unknowns.reach
    return torch.cat([shared, new.states - old.states], -1)


def newton_step(problem: OutputErrorProblem, points: Points, linearised: Prediction, damping: Tensor) -> Points:
    """The damped step within the bounds; a parameter that is pulled beyond its bound stays there.

    One that would go further than the longest step goes just so far, and the others do the best they can beside it:
    cut by themselves, steps leave a narrow valley (the coefficient of a power law, beside its exponent).
    """
    expected, slope = problem.expectation(points.shared, linearised.residual, linearised.level)
    equations = normal_equations(linearised, problem.n_shared)
    equations = replace(equations, pull=equations.pull + slope * expected)
    free = problem.unknowns.at_bound(points.shared) * equations.pull <= 0
    return _stepped(problem, points, equations.beside(slope), damping, free)


def accelerated(
    problem: OutputErrorProblem,
    points: Points,
    linearised: Prediction,
    damping: Tensor,
    first: Points,
    horizon: float | None,
) -> Points:
    """The step to `first` with the correction of second order, for how the response bends along it.

    One more simulation tells the bend. In a narrow valley, as of a coefficient beside its exponent, a step that follows
    the bend goes many times as far. (Geodesic acceleration: Transtrum & Sethna, arXiv:1201.5885.)
    """
    shared, states = first.shared - points.shared, first.states - points.states
    ahead = Points(points.shared + AHEAD * shared, points.states + AHEAD * states)
    straight = linearised.residual - linearised.along(moves(problem, points, ahead))
    bend = (problem.residuals(ahead.shared, ahead.states, horizon) - straight) / AHEAD**2
    equations = normal_equations(replace(linearised, residual=bend.nan_to_num(0, 0, 0)), problem.n_shared)
    slope = problem.expectation(points.shared, linearised.residual, linearised.level)[1]
    second = _stepped(problem, points, equations.beside(slope), damping, shared != 0)
    lengths = linearised.sensitivity.square().sum(2)
    step, turn = ((moves(problem, points, to).square() * lengths).sum((1, 2)) for to in (first, second))
    small = 4 * turn <= MOST_BENT**2 * step
    shared = problem.unknowns.within(first.shared + second.shared - points.shared)
    states = first.states + second.states - points.states
    return Points(
        torch.where(small[:, None], shared, first.shared), torch.where(small[:, None, None], states, first.states)
    )


def _stepped(
    problem: OutputErrorProblem, points: Points, equations: NormalEquations, damping: Tensor, free: Tensor
) -> Points:
    """Where normal equations lead what is free."""
    shared, own = equations.only(free).step(damping)
    longest = LONGEST_STEP * torch.where(problem.unknowns.logarithmic, 1.0, points.shared.abs().clamp(min=1))
    far = shared.abs() > longest
    if far.any():
        held = shared.clamp(-longest, longest) * far
        shared, own = equations.beyond(held).only(free & ~far).step(damping)
        shared = (shared + held).clamp(-longest, longest)
    own = own.clamp(-LONGEST_STEP, LONGEST_STEP)
    return Points(problem.unknowns.within(points.shared + shared), points.states + own)
