"""Stiffness of a curved contact."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, where_there_is_a_spring
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.shapes import power_of_size
from gear_damping.physics.terms import StiffnessFactor, Values

STEPS_AT_LIGHT_CONTACT = 2.5  # times as many as the natural frequency asks for


class HertzStiffness(StiffnessFactor):
    """The contact stiffens as it is pressed: 1/2 for a ball, about 1/10 for tooth flanks."""

    name = "hertz_stiffness"
    refinement = 2.25  # of the steps, measured by step halving: the force bends as delta^1.5 at contact
    equation = "N = k delta (|delta| / delta_0)^p"
    reference = "Yang & Sun (1985), J. Mech. Transm. Autom. Des. 107(4)"
    parameters: ClassVar = (
        Parameter("exponent", "1", 0.1, "p", 0, 2),
        Parameter("reference_deflection", "m", 1.66e-5, "delta_0, at which the stiffness is k", 1e-9, 1e9),
    )
    cause: ClassVar = Cause(
        "a contact stiffness that grows with the load",
        where_there_is_a_spring(Recipe({"exponent": 0.05}, fixed={"reference_deflection": 1.0})),
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Where contact is light the curvature of the force has no bound: smaller steps."""
        return dict(values) | {"fastest_rate": torch.full_like(values["exponent"], STEPS_AT_LIGHT_CONTACT)}

    def factor(self, at: Kinematics, p: Values) -> Tensor:
        """(|delta| / delta_0)^p."""
        return power_of_size(at.deflection / p["reference_deflection"], p["exponent"])
