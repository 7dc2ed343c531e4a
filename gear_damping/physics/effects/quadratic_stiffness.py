"""Restoring force with a quadratic part."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, where_there_is_a_spring
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import ElasticForce, Values


class QuadraticStiffness(ElasticForce):
    """A force that makes one side stiffer than the other."""

    name = "quadratic_stiffness"
    equation = "N + k2 delta^2"
    reference = "Nayfeh & Mook (1979), Nonlinear Oscillations, Wiley"
    parameters: ClassVar = (Parameter("coefficient", "N/m^2", 0.1, "k2", -1e24, 1e24),)
    needs: ClassVar = (Trait.REST,)
    cause: ClassVar = Cause(
        "a restoring force that differs between the two directions of deflection",
        where_there_is_a_spring(Recipe({"coefficient": 0.02})),
    )

    def elastic_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        return p["coefficient"] * at.deflection * at.deflection
