"""Which systems there are: the package's own, and those of a user's files."""

from gear_damping.errors import InputError, Problem, nearest
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.physics.terms import Effect

SYSTEMS: dict[str, type[System]] = {kind.name: kind for kind in (GearPair, Oscillator)}


def system_class(name: str) -> type[System]:
    """The system called `name` among the package's own.

    Raises:
        InputError: there is none.
    """
    if name not in SYSTEMS:
        raise InputError(Problem("system", "no such system", name, nearest(name, list(SYSTEMS))))
    return SYSTEMS[name]


def systems_of(kind: type[Effect]) -> tuple[str, ...]:
    """The package's own systems that an effect goes with, by name."""
    return tuple(name for name, system in SYSTEMS.items() if system.has(*kind.needs))
