"""The catalogue: every effect file of `effects/`, and the user's own, by name."""

from collections.abc import Sequence
from functools import cache
from inspect import isabstract
from pathlib import Path
from types import ModuleType

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.own_files import classes_of, modules_of
from gear_damping.physics import effects as room
from gear_damping.physics.effect_files import KEY, load_effects
from gear_damping.physics.system_files import load_systems
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.known import SYSTEMS
from gear_damping.physics.terms import Effect


@cache
def builtin_effects() -> dict[str, type[Effect]]:
    """The effects that come with the package, by name."""
    return {name: kind for module in modules_of(room) for name, kind in effects_in(module).items()}


def catalogue(plugins: Sequence[str | Path] = ()) -> dict[str, type[Effect]]:
    """Every known effect by name, with those of the user's own files added.

    Args:
        plugins: Python files that each declare one effect or more.

    Raises:
        InputError: a file is missing, cannot be loaded, declares no complete effect, or repeats a name.
    """
    found = dict(builtin_effects())
    for path in map(Path, plugins):
        own = load_effects(path)
        repeated = sorted(set(own) & (set(found) | _keys_of_systems()))
        if repeated:
            raise InputError(Problem(KEY, f"repeats the name {repeated}", str(path), "give the effect a new name"))
        found |= own
    return found


def _keys_of_systems() -> set[str]:
    """The names that stand beside those of effects in the configuration."""
    return {one.name for system in SYSTEMS.values() for one in (*system.parameters, *system.options)}


def system_catalogue(plugins: Sequence[str | Path] = ()) -> dict[str, type[System]]:
    """Every known system by name, with those of the user's own files added.

    Args:
        plugins: Python files that each declare systems, effects or both.

    Raises:
        InputError: a file is missing, cannot be loaded, declares no complete system, or repeats a name.
    """
    found = dict(SYSTEMS)
    for path in map(Path, plugins):
        own = load_systems(path)
        repeated = sorted(set(own) & set(found))
        keys = {one.name for kind in own.values() for one in (*kind.parameters, *kind.options)}
        repeated += sorted(keys & builtin_effects().keys())
        if repeated:
            raise InputError(Problem(KEY, f"repeats the name {repeated}", str(path), "give it a new name"))
        found |= own
    return found


def effects_in(module: ModuleType) -> dict[str, type[Effect]]:
    """The final effect classes that a module defines itself, by name."""
    return {kind.name: kind for kind in classes_of(module, Effect) if not isabstract(kind)}


def effect_class(name: str, plugins: Sequence[str | Path] = ()) -> type[Effect]:
    """The effect called `name`; an unknown name raises InputError with the nearest one."""
    known = catalogue(plugins)
    if name not in known:
        raise InputError(Problem(f"simulator.{name}", "no such effect", remedy=nearest(name, list(known))))
    return known[name]
