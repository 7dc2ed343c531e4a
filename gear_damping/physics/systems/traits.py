"""What systems differ in, in the words of the field: a system declares its traits, effects say which ones they need."""

from collections.abc import Mapping
from enum import StrEnum
from typing import TYPE_CHECKING, TypeVar

from gear_damping.errors import InputError, Problem

if TYPE_CHECKING:
    from gear_damping.physics.systems.base import System

T = TypeVar("T")


class Trait(StrEnum):
    """One thing that a system has and another has not.

    SHAFTS: shafts turn (`rotations`): there are angles, orders and an index, and the motion keeps step with them.
    TEETH: the shafts mesh by teeth: tooth counts, base radii, contact ratio, flanks; the stiffness is a mesh_stiffness
        effect.
    TORQUE: it is driven by torques on its shafts, `load_per_pinion_torque` and `load_per_gear_torque` of it.
    PRELOAD: it moves about the deflection of a mean load (`mean_load`), where every law is nearly linear.
    REST: it swings about a place of rest, to both sides: laws are far from linear, and a free motion dies away.
    MASS: its mass and its load are known in SI. Without it parameters are per unit of mass, and lengths in the unit
        that the response was recorded in.
    """

    SHAFTS = "shafts"
    TEETH = "teeth"
    TORQUE = "torque"
    PRELOAD = "preload"
    REST = "rest"
    MASS = "mass"


def by_trait(system: "type[System]", table: Mapping[Trait, T], what: str) -> T:
    """The first entry of a table whose trait the system has.

    Args:
        system: What was measured.
        table: By trait.
        what: What the entries are, for the message.

    Raises:
        InputError: it has none of these traits.
    """
    found = next((entry for trait, entry in table.items() if system.has(trait)), None)
    if found is None:
        rule = f"there is no {what} of the system '{system.name}'"
        raise InputError(Problem("system", rule, remedy=f"it needs one of the traits {', '.join(table)}"))
    return found
