"""A constant force on an oscillator."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Load, Values


class OffsetForce(Load):
    """A constant force per unit of mass: the offset of a force channel, or a static load."""

    name = "offset_force"
    equation = "F + F0"
    reference = "Wigren & Schoukens (2013), European Control Conference"
    parameters: ClassVar = (Parameter("force", "N", 0.0, "F0", -1e18, 1e18),)
    needs: ClassVar = (Trait.REST,)

    def load_force(self, at: Kinematics, p: Values) -> Tensor:
        """The same at every instant."""
        return p["force"] + torch.zeros_like(at.displacement)
