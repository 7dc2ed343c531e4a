"""Values that a model of one's own and the file of its records both have: which of them holds."""

from collections.abc import Collection, Mapping
from math import isclose

from gear_damping.errors import InputError, Problem
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.interface.model import Model

ROUNDED = 1e-4  # relative: what one writes with fewer digits than the other is one value


def without_records_own(model: Model, evidence: Evidence) -> tuple[Model, list[str]]:
    """A model without those values of its system that every record has of its own, as a torque.

    Returns:
        The model, and what is said of each that was left out, where a record has another one.
    """
    own = {name for name in model.system.given if all(name in {*r.conditions, *r.inputs} for r in evidence.records)}
    other = [
        name for name in own if not all(_is_as(r.conditions.get(name), model.given[name]) for r in evidence.records)
    ]
    said = [
        f"{name} = {model.given[name]:g} of the model has no effect: every record has its own, which holds"
        for name in model.system.given
        if name in other
    ]
    kept = {name: value for name, value in model.given.items() if name not in own}
    return (Model.holding(model, kept), said) if own else (model, said)


def contradictions(model: Model, stated: Mapping[str, float], free: Collection[str]) -> list[str]:
    """What is said of values that are held as the model has them, though the file states others.

    Args:
        model: The model.
        stated: What the file states, by flat name.
        free: What is fitted, which only begins there.

    Raises:
        InputError: the two count something, as teeth, of which there is one number.
    """
    given, declared = model.given, model.parameters()
    held = [name for name in stated if name in given and name not in free]
    apart = [name for name in held if not _is_as(stated[name], given[name])]
    remedy = "leave it out of the model, or correct the file"
    if counts := [name for name in apart if declared[name].whole]:
        rule = "is the model's, and the file states {:g}"
        raise InputError([Problem(name, rule.format(stated[name]), given[name], remedy) for name in counts])
    return [
        f"{name} is held at {given[name]:.4g}, as the model has it, and the file states {stated[name]:.4g}: {remedy}"
        for name in apart
    ]


def _is_as(one: float | None, other: float | tuple[float, ...]) -> bool:
    return one is not None and not isinstance(other, tuple) and isclose(one, other, rel_tol=ROUNDED)
