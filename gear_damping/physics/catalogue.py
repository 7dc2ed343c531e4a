"""The catalogue: every effect file of `effects/`, and the user's own, by name."""

import importlib
import inspect
import pkgutil
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from types import ModuleType

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.physics import effects as effects_package
from gear_damping.physics.effect_files import KEY, load_effects
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.physics.terms import Effect

SYSTEMS: dict[str, type[System]] = {GearPair.name: GearPair, Oscillator.name: Oscillator}


@cache
def builtin_effects() -> dict[str, type[Effect]]:
    """The effects that come with the package, by name."""
    found = {}
    for module in pkgutil.iter_modules(effects_package.__path__):
        loaded = importlib.import_module(f"{effects_package.__name__}.{module.name}")
        found |= effects_in(loaded)
    return dict(sorted(found.items()))


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


def effects_in(module: ModuleType) -> dict[str, type[Effect]]:
    """The final effect classes that a module defines itself, by name."""
    classes = (c for c in vars(module).values() if inspect.isclass(c) and issubclass(c, Effect))
    own = (c for c in classes if c.__module__ == module.__name__ and not inspect.isabstract(c))
    return {c.name: c for c in own}


def effect_class(name: str, plugins: Sequence[str | Path] = ()) -> type[Effect]:
    """The effect called `name`; an unknown name raises InputError with the nearest one."""
    known = catalogue(plugins)
    if name not in known:
        raise InputError(Problem(f"simulator.{name}", "no such effect", remedy=nearest(name, list(known))))
    return known[name]

