"""Where the fit of a model of one's own begins: its own values, those of the file, and first guesses."""

from collections.abc import Sequence
from dataclasses import dataclass

from gear_damping.errors import InputError, Problem
from gear_damping.explanation.evidence.declared_units import radian_of
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.candidates import first_sizes
from gear_damping.explanation.model.hypothesis import Given, Hypothesis
from gear_damping.explanation.model.nominal_gear_pair import FLAT, first_gear_pair
from gear_damping.identification.oscillator.linear_model import DAMPING, linear_model
from gear_damping.interface.free_parameters import free_parameters, given_numbers
from gear_damping.interface.model import Model
from gear_damping.interface.overruled import contradictions, without_records_own
from gear_damping.interface.rig_unit import converted
from gear_damping.physics.damping_ratio import DAMPING_RATIO
from gear_damping.physics.systems.traits import Trait, by_trait

MOTION = ("amplitude", "characteristic_time")  # of an oscillator: what damping ratios belong to, as the records move
STARTS = (1.0, 0.2, 5.0)  # times what a strength is tried at: beside a viscous damping a law may die out on the way


@dataclass(frozen=True)
class Start:
    """Hypotheses to begin a fit with, and what is said of values that do not hold."""

    hypotheses: list[Hypothesis]
    overruled: list[str]


def own_start(model: Model, evidence: Evidence, free: Sequence[str]) -> Start:
    """Where a model begins that is to be fitted to records.

    Args:
        model: Of one's own.
        evidence: The records.
        free: Flat names of what is fitted; where empty, what it was given, and what scales an oscillator's motion.

    Raises:
        InputError: the two units are of different kinds, a name is unknown, a free parameter begins at zero, nothing is
            free, a count is another one in the file, or what scales an oscillator's motion is neither free nor known.
    """
    model, held = converted(model, evidence)
    model, said = without_records_own(model, evidence)
    first = {k: v for k, v in _first(evidence).items() if k in model.parameters()}
    named = {FLAT.get(name, name): value for name, value in evidence.parameters.items()}  # a ratio is no coefficient
    stated = {name: first[name] if name == DAMPING else value for name, value in named.items() if name in first}
    linear = [name for name in _linear(evidence) if name in first and name not in model.given]
    strengths, others = _sizes(model, evidence, first)
    unknown = [name for name in strengths if name not in {*stated, *model.given, *linear}]
    free = free or (*given_numbers(model), *linear, *unknown)
    if not free:
        rule = "names nothing to be fitted, and the model was given no values"
        raise InputError(Problem("free", rule, remedy="for example ['damping_ratio']"))
    names = {model.damping_coefficient if name == DAMPING_RATIO else name for name in free}
    motion = {name: first[name] for name in MOTION if name in first}
    sizes = strengths | others | first
    initial = {name: sizes[name] for name in names if name in sizes}
    given = held | initial | motion | _radians(model, evidence) | stated | model.given
    tried = [name for name in names if name in strengths and name not in {*stated, *model.given}]
    starts = [given | {name: factor * given[name] for name in tried} for factor in (STARTS if tried else (1.0,))]
    moved = [free_parameters(model, start, free, stated, evidence.known.uncertainty) for start in starts]
    _refuse_unknown(model, [name for name in (*linear, *unknown) if name not in {*names, *stated}])
    file = {name: value for name, value in named.items() if name != DAMPING}
    said += contradictions(model, file, {one.declared_name for one in moved[0]})
    return Start([Hypothesis(model.system, model.effects, *both) for both in zip(starts, moved, strict=True)], said)


def _sizes(model: Model, evidence: Evidence, first: Given) -> tuple[Given, Given]:
    """Strengths and other sizes of the effects of an oscillator that show in its motion: no default knows that."""
    if not evidence.has(Trait.REST):
        return {}, {}
    own = {parameter.name for parameter in model.system.parameters}
    given = {name: value for name, value in (first | model.given).items() if name in own}
    return first_sizes(Hypothesis(model.system, (), given, ()), evidence, model.effects)


def _linear(evidence: Evidence) -> list[str]:
    """What a linear oscillator is fitted with: stiffness, damping and gains; nothing of a gear pair."""
    if not evidence.has(Trait.REST):
        return []
    names = {evidence.base.spring, DAMPING, *evidence.base.gains.values()}
    return [one.name for one in linear_model(evidence.fit, evidence.known)[0] if one.name in names]


def _refuse_unknown(model: Model, names: Sequence[str]) -> None:
    """Refuse to hold what scales the motion at a default, which is that of no rig."""
    declared = model.parameters()
    problems = [
        Problem(
            "free",
            f"lacks '{name}', which is not known and would be held at {declared[name].default:g}",
            remedy="free it, give it to the model, or state it under `parameters`",
        )
        for name in names
    ]
    if problems:
        raise InputError(problems)


def _radians(model: Model, evidence: Evidence) -> dict[str, float]:
    """What follows of a model's parameters from the unit of an angle that was recorded."""
    radian = radian_of(evidence)
    return {f"{effect.name}.{effect.radian}": radian for effect in model.effects if effect.radian and radian}


def _first(evidence: Evidence) -> Given:
    """What the search begins with, by flat name of the simulator's parameters: stated, or a first guess."""
    return by_trait(evidence.base, FIRST, "nominal model")(evidence)


def _of_gears(evidence: Evidence) -> Given:
    return first_gear_pair(evidence).given


def _of_a_spring(evidence: Evidence) -> Given:
    free, given, _ = linear_model(evidence.fit, evidence.known)
    return given | {parameter.name: parameter.start for parameter in free}


FIRST = {Trait.TEETH: _of_gears, Trait.REST: _of_a_spring}
