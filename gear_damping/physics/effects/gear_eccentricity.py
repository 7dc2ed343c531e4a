"""Eccentricity of the gear."""

from typing import ClassVar

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.shaft_order import Eccentricity


class GearEccentricity(Eccentricity):
    """The gear runs eccentric: a pure line at its shaft order in the transmission error."""

    name = "gear_eccentricity"
    equation = "e = E cos(theta_2 + phi), delta = x - e"
    shaft = "gear"
    cause: ClassVar = Cause(
        "the eccentricity of the gear",
        (Recipe({"amplitude": None}, {"amplitude": "phase"}, shaft="gear"),),
        separated_by="torque_channel",
        looks_like=("encoder_error",),
        turns_with="shaft",
    )
