"""A system of one's own: a payload on a vibration isolator."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.base import Values
from gear_damping.physics.systems.swinging import BASE, FORCE, MOTION, Swinging
from gear_damping.physics.systems.traits import Trait


class Isolator(Swinging):
    """A mass that is known, on a mount whose stiffness is not; pushed by a force, or shaken by its base."""

    name = "isolator"
    traits: ClassVar = frozenset({Trait.REST, Trait.MASS})
    spring = "mount_stiffness"
    parameters: ClassVar = (
        Parameter("payload_mass", "kg", 2.0, "what stands on the mount", 1e-3, 1e5),
        Parameter("mount_mass", "kg", 0.0, "mass of the spring itself, of which a third moves", 0, 1e5),
        Parameter("mount_stiffness", "N/m", 8000.0, "stiffness of the mount", 0, 1e12),
        *MOTION,
    )
    inputs: ClassVar = {FORCE: "N", BASE: "m/s^2"}

    def mass(self, values: Values) -> Tensor:
        """The payload with a third of the spring (Rayleigh)."""
        return values["payload_mass"] + values["mount_mass"] / 3
