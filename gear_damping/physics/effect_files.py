"""A user's own effect file: loaded, and checked before any of it is used."""

import inspect
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import get_args

import torch

from gear_damping.errors import InputError, Problem
from gear_damping.own_files import REMEDY, classes_of, load_module
from gear_damping.physics import terms
from gear_damping.physics.cause import SHAFTS, Cause, Experiment, Recipe, Rig
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.known import SYSTEMS, systems_of
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Effect, ExtraStates, MeshStiffness
from gear_damping.units import parse_unit

KEY = "simulator.plugins"
_SLOTS = tuple(c for c in vars(terms).values() if inspect.isclass(c) and issubclass(c, Effect) and c is not Effect)
_TEXTS = {
    "name": "its key in the configuration",
    "equation": "the term as it is printed",
    "reference": "where it is from",
}


def load_effects(path: Path) -> dict[str, type[Effect]]:
    """The effects that a file declares, by name.

    Raises:
        InputError: the file is missing, cannot be loaded, declares no effect or one that is not complete.
    """
    module = load_module(path, KEY)
    kinds = classes_of(module, Effect)
    faults = [f"the class {kind.__name__} {fault}" for kind in kinds for fault in _faults(kind)]
    if not kinds and not classes_of(module, System):
        faults = ["declares no effect: no class in it derives from a slot of gear_damping.physics.terms"]
    if faults:
        raise InputError([Problem(KEY, fault, str(path), REMEDY) for fault in faults])
    found = {kind.name: kind for kind in kinds}
    if len(found) < len(kinds):
        rule = f"declares {len(kinds)} effects under the names {sorted(found)}"
        raise InputError(Problem(KEY, rule, str(path), "give each effect a name of its own"))
    return found


def _faults(kind: type[Effect]) -> Iterator[str]:
    """What is missing or wrong in a class."""
    if not issubclass(kind, _SLOTS):
        yield "fills no slot: derive it from one of gear_damping.physics.terms, for example DampingForce"
    for method in sorted(kind.__abstractmethods__):
        yield f"lacks the method {method}"
    for attribute, meaning in _TEXTS.items():
        text = getattr(kind, attribute, None)
        if not isinstance(text, str) or not text.strip():
            yield f"lacks {attribute}, a text: {meaning}"
        elif attribute == "name" and not text.isidentifier():
            yield f"has the name {text!r}: letters, digits and '_' make a key"
    if not _all(kind.needs, str) or not set(kind.needs) <= set(Trait):
        yield f"needs {kind.needs!r} of a system: choose from {tuple(map(str, Trait))}"
        return
    if hasattr(kind, "systems"):
        yield f"names systems: say in needs what it needs of one, from {tuple(map(str, Trait))}"
    yield from _parameter_faults(kind)
    yield from cause_faults(kind)
    if issubclass(kind, ExtraStates):
        states = getattr(kind, "states", None)
        if not isinstance(states, dict):
            yield "lacks states, a dictionary from each state to its unit"
        else:
            yield from (fault for name, unit in states.items() for fault in _unit_faults(f"the state {name}", unit))


def _parameter_faults(kind: type[Effect]) -> Iterator[str]:
    parameters = getattr(kind, "parameters", None)
    if not _all(parameters, Parameter):
        yield "lacks parameters, a tuple of Parameter(…); () where it has none"
        return
    if not _all(kind.options, Option):
        yield "has options that are no tuple of Option(…)"
        return
    names = [one.name for one in (*parameters, *kind.options)]
    for name in sorted({name for name in names if names.count(name) > 1}):
        yield f"declares {name} twice"
    if issubclass(kind, MeshStiffness) and "contact_ratio" not in names:
        yield "lacks the parameter contact_ratio, which a mesh stiffness has"
    for parameter in parameters:
        whole = f"the parameter {parameter.name}"
        yield from _unit_faults(whole, parameter.unit)
        values = parameter.default if parameter.vector else (parameter.default,)
        if parameter.default is not None and not _all(values, (int, float)):
            wanted = "a tuple of numbers" if parameter.vector else "a number"
            yield f"gives {whole} the default {parameter.default!r}: must be {wanted}"
        elif parameter.default is not None and any(parameter.problem(value, "") for value in values):
            bounds = f"{parameter.lower:g} … {parameter.upper:g}"
            yield f"gives {whole} the default {parameter.default!r}: must lie within {bounds}"


def cause_faults(kind: type[Effect]) -> Iterator[str]:
    """What is wrong with how an effect is tried as a cause; its parameters must be right themselves."""
    if kind.cause is None or not _all(getattr(kind, "parameters", None), Parameter):
        return
    if not isinstance(kind.cause, Cause) or not (callable(kind.cause.recipes) or _all(kind.cause.recipes, Recipe)):
        yield "has a cause that is no Cause('what it is called', (Recipe(…), …))"
        return
    if kind.cause.separated_by not in get_args(Experiment):
        yield f"is separated by {kind.cause.separated_by!r}: choose from {get_args(Experiment)}"
    recipes: list[Recipe] = []
    for rig in (rig for name in systems_of(kind) for rig in some_rigs(SYSTEMS[name])):
        try:
            found = kind.cause.recipes_for(rig)
        except Exception as error:  # the user's own code can fail in any way
            yield f"has recipes that fail on a rig: {type(error).__name__}: {error}"
            return
        if not _all(found, Recipe):
            yield "has recipes that give something else than a tuple of Recipe(…)"
            return
        recipes += found
    yield from dict.fromkeys(fault for recipe in recipes for fault in _recipe_faults(kind, recipe))


@cache
def some_rigs(kind: type[System]) -> tuple[Rig, ...]:
    """Rigs of a system on which recipes are looked at that depend on the rig."""
    name, traits, drive = kind.name, kind.traits, tuple(kind.inputs)[:1]
    if not kind.has(Trait.TEETH):
        both = {"frequencies": (3.0, 0.1), "values": _values(kind(), None), "traits": traits, "spring": kind.spring}
        return Rig(name, radian=1.0, **both), Rig(name, inputs=drive, **both)
    values = _values(kind(), torch.tensor([3e8])) | {"contact_ratio": 1.6}
    others = {"mesh_harmonics": 4, "values": values, "traits": traits, "accelerometers": SHAFTS}
    return Rig(name, 20, 40, **others), Rig(name, 17, 43, inputs=("pinion_angle",), lines=(12.0,), **others)


def _values(system: System, mean_stiffness: torch.Tensor | None) -> dict[str, float]:
    """Defaults of a system with what follows from them."""
    own = {parameter.name: torch.tensor([parameter.default]) for parameter in system.parameters}
    return {name: float(value) for name, value in (own | system.derived(own, mean_stiffness)).items()}


def _recipe_faults(kind: type[Effect], recipe: Recipe) -> Iterator[str]:
    declared = {parameter.name for parameter in kind.parameters}
    named = {*recipe.strengths, *recipe.phases, *recipe.phases.values()}
    named |= {*recipe.scanned, *recipe.timed, *recipe.fixed, *recipe.sharpest, *recipe.whole, *recipe.replaces.values()}
    for name in sorted(named - declared):
        yield f"has a recipe with {name!r}, which is none of its parameters"


def _unit_faults(what: str, unit: object) -> Iterator[str]:
    try:
        if not isinstance(unit, str):
            raise InputError(Problem("unit", f"unknown unit {unit!r}", remedy="write for example 'N*s/m'"))
        parse_unit(unit)
    except InputError as error:
        yield from (f"gives {what} an {p.rule} ({p.remedy})" for p in error.problems)


def _all(values: object, kinds: type | tuple[type, ...]) -> bool:
    return isinstance(values, Sequence) and not isinstance(values, str) and all(isinstance(v, kinds) for v in values)
