"""Parameters weighed by what is random in the records.

Least squares takes samples for independent. Where a random load or a coloured sensor makes them hang together, one
Gauss-Newton step on whitened residuals from there is as good as their whole likelihood (Le Cam 1956), and what is left
is white, so that its interval holds.
"""

from dataclasses import replace

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome, settled_at
from gear_damping.explanation.trials.assess import assessed
from gear_damping.explanation.trials.random_part import Random, Whitener
from gear_damping.identification.output_error.descent import SMALLEST_DAMPING
from gear_damping.identification.output_error.problem import Prediction
from gear_damping.identification.output_error.step import Points, moves, newton_step

FAR_MORE = 2.0  # times the sum of squares: from one estimate to another it changes by a share of a few in all samples


def efficient(outcome: Outcome, random: Random) -> Outcome:
    """The outcome one step on, with its linearisation made white; itself where what is random is white.

    A step that leaves far more is not taken.

    Args:
        outcome: A fit that leaves nothing but what is random.
        random: What that is.
    """
    if not random.loads and not any(law.order for law in random.laws):
        return outcome
    problem, fitted, whiten = outcome.problem, outcome.fitted, Whitener(random, outcome)
    white = _whitened(fitted.prediction, whiten)
    initial = Points(fitted.shared.unsqueeze(0), fitted.states.unsqueeze(0))
    end = newton_step(problem, initial, white, fitted.shared.new_full((1,), SMALLEST_DAMPING))
    after = whiten(problem.residuals(end.shared, end.states).reshape(-1, 1)).reshape(white.residual.shape)
    begun, ended = problem.cost(initial.shared, white.residual), problem.cost(end.shared, after)
    if not bool(ended <= FAR_MORE * begun):  # nor what is not finite: what hardly tells a state sends it anywhere
        return outcome
    shared, states = end.shared[0], end.states[0]
    values = {name: float(value) for name, value in problem.unknowns.parameters(shared).items()}
    left = white.residual - white.along(moves(problem, initial, end))
    return replace(
        outcome,
        hypothesis=settled_at(outcome.hypothesis, values),
        fitted=replace(fitted, shared=shared, states=states),
        values=values,
        whitened=replace(white, residual=left),
    )


def weighed(outcome: Outcome, evidence: Evidence) -> Outcome:
    """The same by what is random in what a fit leaves; the fit as it is where more than that is visible."""
    seen = assessed(outcome, [], evidence)
    return outcome if seen is None or seen.visible else efficient(outcome, seen.random)


def _whitened(found: Prediction, whiten: Whitener) -> Prediction:
    sensitivity, residual = found.sensitivity, found.residual
    columns = whiten(sensitivity[0].flatten(0, 1)).reshape(sensitivity.shape)
    white = whiten(residual.reshape(-1, 1)).reshape(residual.shape)
    return replace(found, sensitivity=columns, residual=white, level=None)
