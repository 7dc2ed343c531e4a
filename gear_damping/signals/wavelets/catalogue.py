"""The wavelets of this room by name."""

from functools import cache
from inspect import isabstract

from gear_damping.own_files import classes_of, modules_of
from gear_damping.signals import wavelets as room
from gear_damping.signals.wavelets.base import ContinuousWavelet


@cache
def builtin_wavelets() -> dict[str, type[ContinuousWavelet]]:
    """The wavelets that come with the package."""
    kinds = (kind for module in modules_of(room) for kind in classes_of(module, ContinuousWavelet))
    return {kind.name: kind for kind in kinds if not isabstract(kind)}
