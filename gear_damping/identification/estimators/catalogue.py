"""Every estimator by name: the files of this room, and the user's own."""

import importlib
import pkgutil
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.identification import estimators as room
from gear_damping.identification.estimators.base import Setting, WindowEstimator
from gear_damping.own_files import REMEDY, classes_of, load_module

KEY = "model.plugins"
TAKEN = ("mean", "white_noise", "names", "plugins")  # controls, and keys beside the settings


@cache
def builtin_estimators() -> dict[str, type[WindowEstimator]]:
    """The estimators that come with the package."""
    found = {}
    for module in pkgutil.iter_modules(room.__path__):
        if module.name not in ("base", "catalogue"):
            loaded = importlib.import_module(f"{room.__name__}.{module.name}")
            found |= {kind.name: kind for kind in classes_of(loaded, WindowEstimator)}
    return dict(sorted(found.items()))


def estimator_catalogue(plugins: Sequence[str | Path] = ()) -> dict[str, type[WindowEstimator]]:
    """Every known estimator, with those of the user's own files added.

    Raises:
        InputError: a file is missing, cannot be loaded, declares no complete estimator, or repeats a name.
    """
    found = dict(builtin_estimators())
    for path in map(Path, plugins):
        kinds = classes_of(load_module(path, KEY), WindowEstimator)
        faults = [f"the class {kind.__name__} {fault}" for kind in kinds for fault in _faults(kind)]
        if not kinds:
            faults = ["declares no estimator: no class in it derives from WindowEstimator"]
        repeated = sorted({kind.name for kind in kinds if not faults} & {*found, *TAKEN})
        if repeated:
            faults = [f"repeats the name {repeated}"]
        if faults:
            raise InputError([Problem(KEY, fault, str(path), REMEDY) for fault in faults])
        found |= {kind.name: kind for kind in kinds}
    return found


def kind_of(name: str, plugins: Sequence[str] = ()) -> type[WindowEstimator]:
    """The estimator of this name.

    Raises:
        InputError: there is none, or a file cannot be used.
    """
    known = estimator_catalogue(plugins)
    if name not in known:
        remedy = f"{nearest(name, list(known))}; an estimator of your own needs {KEY}=[its file]"
        raise InputError(Problem("estimator", "no such estimator", name, remedy))
    return known[name]


def _faults(kind: type[WindowEstimator]) -> list[str]:
    """What is missing or wrong in a class."""
    found = [f"lacks the method {method}" for method in sorted(kind.__abstractmethods__)]
    for attribute in ("name", "reference"):
        if not isinstance(getattr(kind, attribute, None), str):
            found.append(f"lacks {attribute}, a text")
    if not found and not kind.name.isidentifier():
        found.append(f"has the name {kind.name!r}: letters, digits and '_' make a key")
    if not isinstance(kind.settings, tuple) or not all(isinstance(one, Setting) for one in kind.settings):
        return [*found, "lacks settings, a tuple of Setting(…); () where it has none"]
    odd = [one.name for one in kind.settings if not one.lower <= one.default <= one.upper]
    taken = [one.name for one in kind.settings if one.name in TAKEN]
    found += [f"gives {name} a default outside its bounds" for name in odd]
    return found + [f"has a setting called {name}, which is a key of its own" for name in taken]
