"""What a cause, or a constant force, comes to at the motion that was recorded."""

from collections.abc import Mapping
from math import sqrt
from typing import Any

from gear_damping.explanation.answer.gain import final_parameters, mean_stiffness
from gear_damping.explanation.evidence.declared_units import rig_unit
from gear_damping.explanation.model.covariance import covariance_of
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.state import State
from gear_damping.identification.oscillator.linear_model import FORCE
from gear_damping.physics.model import Prepared

Told = Mapping[str, Mapping[str, Any]]  # fitted parameters by flat name, as `final_parameters` has them
BACK = 0.02  # of the way that a record goes: what start and noise take it back


def acts_as(state: State) -> list[str]:
    """A sentence for each cause whose effect has a word for what it comes to."""
    outcome, evidence, found = state.outcome, state.bench.evidence, []
    for cause in state.accepted:
        if (told := cause.effect.cause.acts_as) is None:
            continue
        said = told(outcome.values_of(cause.name), _stiffness(outcome), _amplitude(outcome))
        if said:
            found.append(f"{said[0]} of {said[1]:.2g} {rig_unit('N', evidence)}.")
    return found


def also_as(state: State) -> list[str]:
    """A sentence for each cause that something else would do the same as, where no sensor on a shaft parts the two."""
    outcome = state.outcome
    told = [(cause.effect, cause.effect.cause.also) for cause in state.accepted if cause.effect.cause.also]
    if not told or state.bench.evidence.has_rates:
        return []
    base = {name: float(value[0]) for name, value in _prepared(outcome).base.items() if value.numel() == 1}
    said = (also(effect.chosen, outcome.values_of(effect.name), base) for effect, also in told)
    return [sentence for sentence in said if sentence]


def inputs_and_loads(state: State) -> list[str]:
    """Sentences on measured inputs that the motion does not show, and on a constant force that may be friction."""
    outcome, evidence = state.outcome, state.bench.evidence
    gains = {gain: name for name, gain in evidence.base.gains.items() if name in outcome.problem.records[0].inputs}
    if not any(free.name in (FORCE, *gains) for free in outcome.problem.free):
        return []
    told = final_parameters(outcome, covariance_of(outcome, evidence), evidence)
    return [*_silent_inputs(told, gains), *_steady_load(state, told, gains)]


def _silent_inputs(told: Told, gains: Mapping[str, str]) -> list[str]:
    """A sentence for each measured input that is not told from one that does nothing."""
    found = []
    for gain, name in ((gain, name) for gain, name in gains.items() if gain in told):
        low, high = told[gain]["interval95"]
        if low <= 0 <= high:
            found.append(
                f"What moved does not show the measured {name} ({gain} {told[gain]['value']:.2g}, {low:.2g} to "
                f"{high:.2g}): what is said of the rig rests on its motion alone."
            )
    return found


def _steady_load(state: State, told: Told, gains: Mapping[str, str]) -> list[str]:
    """A sentence on the constant force of a rig without a spring that moves one way: a load, or friction.

    Where it moves both ways a friction has a name of its own; beside a spring it is where the rig rests.
    """
    outcome = state.outcome
    if FORCE not in told or state.bench.evidence.has_spring or not _is_one_way(outcome):
        return []
    value, (low, high) = told[FORCE]["value"], told[FORCE]["interval95"]
    if low <= 0 <= high:
        return []
    size = f"{value:.3g} {told[FORCE]['unit']} ({low:.3g} to {high:.3g})"
    for gain, name in list(gains.items())[:1]:
        factor = (outcome.values | outcome.problem.given).get(gain, 1.0)
        size += f", which is {abs(value / factor):.3g} of the measured {name} in its unit," if factor else ""
    return [
        f"A constant force of {size} acts: all records move one way, where dry friction and a steady load are one and "
        "the same."
    ]


def _is_one_way(outcome: Outcome) -> bool:
    """Whether all records together go back by no more than a part of the way that they go; each may be in segments."""
    rates = [motion[1] for motion in outcome.problem.motion(outcome.fitted.shared, outcome.fitted.states)]
    forward, backward = (sum(float((sign * rate).clamp(min=0).sum()) for rate in rates) for sign in (1, -1))
    return min(forward, backward) <= BACK * max(forward, backward)


def _prepared(outcome: Outcome) -> Prepared:
    """The model with its fitted values, a batch of one."""
    model = outcome.hypothesis.model
    return model.prepare(model.values(1, **outcome.flat_given()))


def _stiffness(outcome: Outcome) -> float:
    return float(mean_stiffness(outcome.hypothesis.model, _prepared(outcome))[0])


def _amplitude(outcome: Outcome) -> float:
    """Of the displacement, of a sine with its mean square over the records."""
    motions = outcome.problem.motion(outcome.fitted.shared, outcome.fitted.states)
    squares = [float((motion[0] - motion[0].mean()).square().mean()) for motion in motions]
    return sqrt(2 * sum(squares) / len(squares))
