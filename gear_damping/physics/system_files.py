"""A user's own system file: loaded, and checked before any of it is used."""

from collections.abc import Iterator
from pathlib import Path

from gear_damping.errors import InputError, Problem
from gear_damping.own_files import REMEDY, classes_of, load_module
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.traits import Trait

KEY = "simulator.plugins"
_DECLARED = {
    "response": "the channel that its displacement is recorded in",
    "responses": "channels that its motion is fitted to",
    "inputs": "series that may be given, with their units",
    "derived_units": "units of its derived quantities",
}


def load_systems(path: Path, key: str = KEY) -> dict[str, type[System]]:
    """The systems that a file declares, by name; none where it declares other parts.

    Raises:
        InputError: the file is missing, cannot be loaded, or declares a system that is not complete.
    """
    kinds = classes_of(load_module(path, key), System)
    faults = [f"the class {kind.__name__} {fault}" for kind in kinds for fault in _faults(kind)]
    if faults:
        raise InputError([Problem(key, fault, str(path), REMEDY) for fault in faults])
    return {kind.name: kind for kind in kinds}


def _faults(kind: type[System]) -> Iterator[str]:
    """What is missing or wrong in a class."""
    for method in sorted(kind.__abstractmethods__):
        yield f"lacks the method {method}"
    name = getattr(kind, "name", None)
    if not isinstance(name, str) or not name.isidentifier():
        yield "lacks name, a text of letters, digits and '_': its key in the configuration and in measurement.yaml"
    for attribute, meaning in _DECLARED.items():
        if not hasattr(kind, attribute):
            yield f"lacks {attribute}: {meaning}"
    traits = getattr(kind, "traits", None)
    if not isinstance(traits, frozenset) or not traits <= set(Trait):
        yield f"lacks traits, a frozenset from {tuple(map(str, Trait))}"
        return
    parameters = getattr(kind, "parameters", None)
    if not isinstance(parameters, tuple) or not all(isinstance(one, Parameter) for one in parameters):
        yield "lacks parameters, a tuple of Parameter(…)"
        return
    names = [one.name for one in (*parameters, *kind.options)]
    referred = [kind.spring] if kind.spring or Trait.REST in traits else []
    for name in (*referred, *kind.gains.values()):
        if name not in names:
            yield f"names {name!r} as its spring or gain, which is none of its parameters"
