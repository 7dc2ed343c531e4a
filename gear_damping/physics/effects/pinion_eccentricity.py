"""Eccentricity of the pinion."""

from typing import ClassVar

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.shaft_order import Eccentricity


class PinionEccentricity(Eccentricity):
    """The pinion runs eccentric: a pure line at its shaft order in the transmission error."""

    name = "pinion_eccentricity"
    equation = "e = E cos(theta_1 + phi), delta = x - e"
    shaft = "pinion"
    cause: ClassVar = Cause(
        "the eccentricity of the pinion",
        (Recipe({"amplitude": None}, {"amplitude": "phase"}),),
        separated_by="torque_channel",
        looks_like=("encoder_error",),
        turns_with="shaft",
    )
