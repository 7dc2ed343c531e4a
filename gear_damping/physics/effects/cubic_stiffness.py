"""Stiffness that grows with the square of the deflection."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, where_there_is_a_spring
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import ElasticForce, Values


class CubicStiffness(ElasticForce):
    """A cubic restoring force beside the linear one."""

    name = "cubic_stiffness"
    equation = "N + k3 delta^3"
    reference = "Duffing (1918), Erzwungene Schwingungen bei veränderlicher Eigenfrequenz, Vieweg"
    parameters: ClassVar = (Parameter("coefficient", "N/m^3", 5.8e16, "k3; default: 5 % at 16.6 um", -1e24, 1e24),)
    cause: ClassVar = Cause(
        "a restoring force that hardens or softens with the cube of the deflection",
        where_there_is_a_spring(Recipe({"coefficient": 0.02})),
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The coefficient, and the rate at one natural length of deflection."""
        stiffness = base["mean_stiffness"] + 3 * values["coefficient"].abs()
        return dict(values) | {"fastest_rate": torch.sqrt(stiffness / base["equivalent_mass"])}

    def elastic_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        return p["coefficient"] * at.deflection * at.deflection * at.deflection
