"""What a cause comes to at the motion that was recorded."""

from math import sqrt

from gear_damping.explanation.answer.gain import mean_stiffness
from gear_damping.explanation.evidence.declared_units import rig_unit
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.state import State


def acts_as(state: State) -> list[str]:
    """A sentence for each cause whose effect has a word for what it comes to."""
    outcome, evidence, found = state.outcome, state.bench.evidence, []
    for cause in state.accepted:
        if (told := cause.effect.cause.acts_as) is None:
            continue
        own = {n.partition(".")[2]: v for n, v in outcome.flat_given().items() if n.startswith(f"{cause.name}.")}
        said = told(own, _stiffness(outcome), _amplitude(outcome))
        if said:
            found.append(f"{said[0]} of {said[1]:.2g} {rig_unit('N', evidence)}.")
    return found


def _stiffness(outcome: Outcome) -> float:
    model = outcome.hypothesis.model
    return float(mean_stiffness(model, model.prepare(model.values(1, **outcome.flat_given())))[0])


def _amplitude(outcome: Outcome) -> float:
    """Of the displacement, of a sine with its mean square over the records."""
    motions = outcome.problem.motion(outcome.fitted.shared, outcome.fitted.states)
    squares = [float((motion[0] - motion[0].mean()).square().mean()) for motion in motions]
    return sqrt(2 * sum(squares) / len(squares))
