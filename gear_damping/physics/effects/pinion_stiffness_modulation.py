"""Modulation of the mesh stiffness by the pinion shaft."""

from typing import ClassVar

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.shaft_order import StiffnessModulation


class PinionStiffnessModulation(StiffnessModulation):
    """The stiffness varies once per turn of the pinion: sidebands of the mesh lines."""

    name = "pinion_stiffness_modulation"
    equation = "k (1 + eps cos(theta_1 + phi))"
    shaft = "pinion"
    cause: ClassVar = Cause(
        "a mesh stiffness that varies over a turn of the pinion",
        (Recipe({"amplitude": None}, {"amplitude": "phase"}),),
        turns_with="shaft",
    )
