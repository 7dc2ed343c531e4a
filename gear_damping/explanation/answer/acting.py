"""What a cause, or a constant force, comes to at the motion that was recorded."""

from math import sqrt

from gear_damping.explanation.answer.gain import final_parameters, mean_stiffness
from gear_damping.explanation.evidence.declared_units import rig_unit
from gear_damping.explanation.model.covariance import covariance_of
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.state import State
from gear_damping.identification.oscillator.linear_model import FORCE

BACK = 0.02  # of the way that a record goes: what start and noise take it back


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


def silent_inputs(state: State) -> list[str]:
    """A sentence for each measured input that is not told from one that does nothing."""
    outcome, evidence, found = state.outcome, state.bench.evidence, []
    gains = {evidence.base.gains.get(name): name for name in outcome.problem.records[0].inputs}
    fitted = [free.name for free in outcome.problem.free if free.name in gains]
    told = final_parameters(outcome, covariance_of(outcome, evidence), evidence) if fitted else {}
    for name in fitted:
        low, high = told[name]["interval95"]
        if low <= 0 <= high:
            found.append(
                f"What moved does not show the measured {gains[name]} ({name} {told[name]['value']:.2g}, {low:.2g} to "
                f"{high:.2g}): what is said of the rig rests on its motion alone."
            )
    return found


def steady_load(state: State) -> list[str]:
    """A sentence on the constant force of a rig without a spring that moves one way: a load, or friction.

    Where it moves both ways a friction has a name of its own; beside a spring it is where the rig rests.
    """
    outcome, evidence = state.outcome, state.bench.evidence
    places = [place for place, free in enumerate(outcome.problem.free) if free.name == FORCE]
    if evidence.has_spring or not places or not _is_one_way(outcome):
        return []
    found = final_parameters(outcome, covariance_of(outcome, evidence), evidence)[FORCE]
    low, high = found["interval95"]
    if low <= 0 <= high:
        return []
    gains = evidence.base.gains
    drives = [name for name in outcome.problem.records[0].inputs if name in gains]
    gain = (outcome.values | outcome.problem.given).get(gains[drives[0]], 1.0) if drives else 0.0
    size = f"{found['value']:.3g} {found['unit']} ({low:.3g} to {high:.3g})"
    size += f", which is {abs(found['value'] / gain):.3g} of the measured {drives[0]} in its unit," if gain else ""
    return [
        f"A constant force of {size} acts: all records move one way, where dry friction and a steady load are one and "
        "the same."
    ]


def _is_one_way(outcome: Outcome) -> bool:
    """Whether every record goes back by no more than a part of the way that it goes."""
    for motion in outcome.problem.motion(outcome.fitted.shared, outcome.fitted.states):
        forward, backward = motion[1].clamp(min=0).sum(), (-motion[1]).clamp(min=0).sum()
        if float(min(forward, backward)) > BACK * float(max(forward, backward)):
            return False
    return True


def _stiffness(outcome: Outcome) -> float:
    model = outcome.hypothesis.model
    return float(mean_stiffness(model, model.prepare(model.values(1, **outcome.flat_given())))[0])


def _amplitude(outcome: Outcome) -> float:
    """Of the displacement, of a sine with its mean square over the records."""
    motions = outcome.problem.motion(outcome.fitted.shared, outcome.fitted.states)
    squares = [float((motion[0] - motion[0].mean()).square().mean()) for motion in motions]
    return sqrt(2 * sum(squares) / len(squares))
