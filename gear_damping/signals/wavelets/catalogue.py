"""The wavelets of this room by name."""

import importlib
import pkgutil
from functools import cache

from gear_damping.own_files import classes_of
from gear_damping.signals import wavelets as room
from gear_damping.signals.wavelets.base import ContinuousWavelet


@cache
def builtin_wavelets() -> dict[str, type[ContinuousWavelet]]:
    """The wavelets that come with the package."""
    found = {}
    for module in pkgutil.iter_modules(room.__path__):
        if module.name not in ("base", "catalogue"):
            loaded = importlib.import_module(f"{room.__name__}.{module.name}")
            found |= {kind.name: kind for kind in classes_of(loaded, ContinuousWavelet)}
    return dict(sorted(found.items()))
