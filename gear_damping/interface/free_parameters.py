"""What is free in a model of one's own, or in one that `explain` wrote, when it is fitted to records."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.explanation.model.hypothesis import Given
from gear_damping.explanation.model.nominal_gear_pair import EXPECTED_SHAPE, FLAT, MESH, PHASED, SHAPE
from gear_damping.identification.output_error.records import FreeParameter
from gear_damping.physics.damping_ratio import DAMPING_RATIO
from gear_damping.physics.model import Model
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait

IN_SHAPE = (*PHASED, f"{MESH}.edge")  # its harmonics contain these
SHAPE_STEP, MOST_SHAPE = 0.02, 0.5  # of the mean stiffness: a step of a harmonic, and the most that teeth can have
TIMES = "s"  # the unit of lists that say when something happens: they are read off, and not fitted


def given_numbers(model: Model) -> tuple[str, ...]:
    """What may be free in a model: numbers and lists that its effects were given, an oscillator's stiffness and gain.

    Where the mesh has a shape, its harmonics are free and not what they contain: a shape that is held at what a fit
    found would make every interval too narrow.
    """
    declared, lists = model.parameters(), (f"{SHAPE}.in_phase", f"{SHAPE}.quadrature")
    shaped = any(name in model.given for name in lists)
    of_system = {model.system.spring} | (set(model.system.gains.values()) if model.system.has(Trait.REST) else set())
    return tuple(
        name
        for name, value in model.given.items()
        if (name in lists or _has_size(value))
        and declared[name].unit != TIMES * declared[name].vector
        and ("." in name or name in of_system)
        and not (shaped and name in IN_SHAPE)
    )


def free_parameters(
    model: Model, given: Given, names: Sequence[str], stated: Given, uncertainty: Mapping[str, float]
) -> tuple[FreeParameter, ...]:
    """Free parameters that begin where the model has them.

    What the file states with an uncertainty is free beside them, and expected where the file has it.

    Args:
        model: What is fitted.
        given: Its values by flat name.
        names: What is free, by flat name; `damping_ratio` stands for the coefficient of its one damping law.
        stated: What the file states of the rig, by flat name.
        uncertainty: Relative standard deviation of what is not known exactly, by the file's names.

    Raises:
        InputError: a name is unknown, a parameter is named in two ways, or a free one begins at zero.
    """
    declared, problems = model.parameters(), _named_twice(model, names)
    uncertain = {FLAT.get(name, name): relative for name, relative in uncertainty.items() if relative}
    found: dict[str, FreeParameter] = {}
    for name in (*names, *(n for n in uncertain if n in declared and n not in names and _has_size(given.get(n, 0.0)))):
        flat = model.damping_coefficient if name == DAMPING_RATIO and name not in declared else name
        if flat is None:
            laws = [f"{law.name}.{law.parameters[0].name}" for law in model.damping_laws]
            rule = f"the model has {len(laws) or 'no'} damping laws, and it stands for the coefficient of one"
            remedy = f"name {' or '.join(laws)}" if laws else "add ViscousDamping()"
            problems.append(Problem(f"free.{name}", rule, remedy=remedy))
            continue
        if flat not in declared:
            remedy = nearest(name, [*declared, DAMPING_RATIO])
            problems.append(Problem(f"free.{name}", "no such parameter of the model", remedy=remedy))
            continue
        start = given.get(flat, declared[flat].default)
        if not (_has_size(start) or declared[flat].unit == "rad" or flat.startswith(f"{SHAPE}.")):
            rule, remedy = "begins at zero, so that its size is unknown", "give the model a value that is about right"
            problems.append(Problem(f"free.{name}", rule, remedy=remedy))
            continue
        found |= {one.name: one for one in _elements(flat, start, declared[flat])}
    if problems:
        raise InputError(problems)
    return tuple(_expected(one, stated, uncertain) for one in found.values())


def _named_twice(model: Model, names: Sequence[str]) -> list[Problem]:
    """The coefficient of the one damping law, where it is named by itself and by the damping ratio."""
    coefficient = model.damping_coefficient
    if DAMPING_RATIO not in names or coefficient not in names or DAMPING_RATIO in model.parameters():
        return []
    rule = f"names one parameter twice: {DAMPING_RATIO} stands for {coefficient}"
    return [Problem("free", rule, list(names), "name one of the two")]


def _has_size(value: float | tuple[float, ...] | None) -> bool:
    return any(value) if isinstance(value, tuple) else bool(value)


def _elements(flat: str, start: float | tuple[float, ...], declared: Parameter) -> list[FreeParameter]:
    """The parameter, or one for each element of a list."""
    if flat.startswith(f"{SHAPE}."):
        ends = {"lower": -MOST_SHAPE, "upper": MOST_SHAPE}
        return [
            FreeParameter(f"{flat}[{i}]", value, SHAPE_STEP, **ends, deviation=EXPECTED_SHAPE / (i + 1))
            for i, value in enumerate(start)
        ]
    bounds = {"lower": declared.lower, "upper": declared.upper}
    if declared.vector:
        scale = 1.0 if declared.unit == "rad" else max(map(abs, start))
        return [FreeParameter(f"{flat}[{i}]", float(value), scale, **bounds) for i, value in enumerate(start)]
    scale = 1.0 if declared.unit == "rad" else abs(float(start))
    grows = start > 0 and declared.lower >= 0
    return [FreeParameter(flat, float(start), scale, logarithmic=grows, **bounds)]


def _expected(one: FreeParameter, stated: Given, uncertain: Mapping[str, float]) -> FreeParameter:
    """The parameter with the expectation that it lies about what the file states, within a relative uncertainty."""
    relative, about = uncertain.get(one.name), stated.get(one.name)
    if not relative or about is None:
        return one
    deviation = relative if one.logarithmic else relative * abs(about)
    return replace(one, deviation=deviation, expected=about)
