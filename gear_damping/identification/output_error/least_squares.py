"""Levenberg–Marquardt over several starts at once, the starts being members of one batch."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

from torch import Tensor

from gear_damping.identification.output_error.descent import Descent, Lent, Points
from gear_damping.identification.output_error.problem import OutputErrorProblem, Prediction


@dataclass(frozen=True)
class Fitted:
    """The best point with its linearisation."""

    shared: Tensor
    states: Tensor
    prediction: Prediction
    cost: float
    converged: bool


def fit(
    problem: OutputErrorProblem,
    shared: Tensor,
    horizons: Sequence[float | None] | None = None,
    iterations: int | Sequence[int] = 40,
    states: Tensor | None = None,
    report: Callable[[int, int], None] | None = None,
    kept: float = 0.5,
    enough: float = 0.0,
    is_over: Callable[[], bool] = lambda: False,
    reach: float = inf,
    lent: Lent | None = None,
) -> Fitted:
    """The best of several starts.

    Args:
        problem: What is fitted to what.
        shared: Coordinates of the starts, (starts, n); those that are left out at the end begin at 0.
        horizons: Seconds of each round, growing, None for all; a short first round keeps away from local minima.
        iterations: At most so many linearisations in each round, or in each of the rounds.
        states: Initial states of the starts, (starts, records, local); from the records where absent.
        report: Told (done, total) rounds.
        kept: Share of the starts, the best ones, that goes on from round to round.
        enough: Fall of the cost below which a start has converged, whatever share of the cost it is.
        is_over: Whether time is over: after a few steps of each round nothing more is tried then.
        reach: Cost in the last round; a start that will not get below it is given up.
        lent: Sensitivities to begin with, as another fit to the same records found them.
    """
    if states is None:
        states = problem.first_states().expand(shared.shape[0], -1, -1).clone()
    points = Points(problem.unknowns.within(problem.unknowns.completed(shared)), states)
    rounds = list(horizons or [None])
    most = [iterations] * len(rounds) if isinstance(iterations, int) else iterations
    for number, horizon in enumerate(rounds):
        is_last = number == len(rounds) - 1
        descent = Descent(problem, points, horizon, enough, reach if is_last else inf, lent)
        descent.run(most[number], is_over, is_last)
        if not is_last:
            points = descent.points.pick(descent.cost.argsort()[: max(1, round(kept * len(descent.cost)))])
        if report:
            report(number + 1, len(rounds))
    best = descent.cost.argmin().reshape(1)
    chosen = descent.points.pick(best)
    return Fitted(
        chosen.shared[0],
        chosen.states[0],
        descent.now.pick(best),
        float(descent.cost[best]),
        bool(descent.converged[best]),
    )
