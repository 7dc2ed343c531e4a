"""Modulation of the mesh stiffness by the gear shaft."""

from typing import ClassVar

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.shaft_order import StiffnessModulation


class GearStiffnessModulation(StiffnessModulation):
    """The stiffness varies once per turn of the gear: sidebands of the mesh lines."""

    name = "gear_stiffness_modulation"
    equation = "k (1 + eps cos(theta_2 + phi))"
    shaft = "gear"
    cause: ClassVar = Cause(
        "a mesh stiffness that varies over a turn of the gear",
        (Recipe({"amplitude": None}, {"amplitude": "phase"}, shaft="gear"),),
        turns_with="shaft",
    )
