"""The catalogue: every effect file of `effects/`, and the user's own, by name."""

import importlib
import importlib.util
import inspect
import pkgutil
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from types import ModuleType

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.physics import effects as effects_package
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
        InputError: a file is missing, declares no effect, or repeats a name.
    """
    found = dict(builtin_effects())
    for path in map(Path, plugins):
        own = effects_in(_load_file(path))
        repeated = sorted(set(own) & set(found))
        if not own or repeated:
            rule = f"repeats the name {repeated}" if repeated else "declares no effect"
            raise InputError(Problem("simulator.plugins", rule, str(path), "one Effect class with a new name"))
        found |= own
    return found


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


def _load_file(path: Path) -> ModuleType:
    if not path.is_file():
        raise InputError(Problem("simulator.plugins", "no such file", str(path), "give the path of a .py file"))
    spec = importlib.util.spec_from_file_location(f"gear_damping_plugin_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
