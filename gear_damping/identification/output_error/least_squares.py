"""Levenberg–Marquardt over several starts at once, the starts being members of one batch."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf

from torch import Tensor

from gear_damping.identification.kept_memory import keep_memory
from gear_damping.identification.output_error.descent import TO_THE_END, Descent, Ends, Lent
from gear_damping.identification.output_error.problem import OutputErrorProblem, Prediction
from gear_damping.identification.output_error.step import Points


@dataclass(frozen=True)
class Fitted:
    """The best point with its linearisation."""

    shared: Tensor
    states: Tensor
    prediction: Prediction
    cost: float
    converged: bool


@dataclass(frozen=True)
class Rounds:
    """How far a fit goes: in rounds over growing stretches of the records.

    Args:
        iterations: At most so many linearisations in each round, or in each of the rounds.
        horizons: Seconds of each round, growing, None for all; a short first round keeps away from local minima.
        kept: Share of the starts, the best ones, that goes on from round to round.
        report: Told (done, total) rounds.
    """

    iterations: int | Sequence[int] = 40
    horizons: Sequence[float | None] = (None,)
    kept: float = 0.5
    report: Callable[[int, int], None] | None = None


NONE = Rounds(0)  # the point itself, linearised


def fit(
    problem: OutputErrorProblem,
    shared: Tensor,
    rounds: Rounds = Rounds(),
    states: Tensor | None = None,
    ends: Ends = TO_THE_END,
    lent: Lent | None = None,
) -> Fitted:
    """The best of several starts.

    Args:
        problem: What is fitted to what.
        shared: Coordinates of the starts, (starts, n); those that are left out at the end begin at 0.
        rounds: How far it goes.
        states: Initial states of the starts, (starts, records, local); from the records where absent.
        ends: When it stops before.
        lent: Sensitivities to begin with, as another fit to the same records found them.
    """
    keep_memory()
    if states is None:
        states = problem.first_states().expand(shared.shape[0], -1, -1).clone()
    points = Points(problem.unknowns.within(problem.unknowns.completed(shared)), states)
    count = len(rounds.horizons)
    most = [rounds.iterations] * count if isinstance(rounds.iterations, int) else rounds.iterations
    for number, horizon in enumerate(rounds.horizons):
        is_last = number == count - 1
        descent = Descent(problem, points, horizon, ends if is_last else replace(ends, reach=inf), lent)
        descent.run(most[number], is_last)
        if not is_last:
            points = descent.points.pick(descent.cost.argsort()[: max(1, round(rounds.kept * len(descent.cost)))])
        if rounds.report:
            rounds.report(number + 1, count)
    best = descent.cost.argmin().reshape(1)
    chosen = descent.points.pick(best)
    return Fitted(
        chosen.shared[0],
        chosen.states[0],
        descent.linearised.pick(best),
        float(descent.cost[best]),
        bool(descent.converged[best]),
    )
