"""An effect of one's own: a lubricant that thins under shear."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import DampingForce, Values


class ShearThinningDamping(DampingForce):
    """Viscous at low speed; at high speed the force grows no further."""

    name = "shear_thinning_damping"
    equation = "F_d = c delta' / (1 + |delta'| / v)"
    reference = "Cross (1965), J. Colloid Sci. 20(5), with exponent 1"
    parameters: ClassVar = (
        Parameter("damping_coefficient", "N*s/m", 200.0, "c, at low speed", 0, 1e12),
        Parameter("thinning_velocity", "m/s", 0.1, "v, at which half of it is left", 1e-9, 1e9),
    )
    dissipative = True
    cause: ClassVar = Cause(
        "a damping that thins under shear",
        (Recipe({"damping_coefficient": 0.01}, scanned={"thinning_velocity": 1.0}),),
        separated_by="ring_down",
    )

    def damping_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant, positive where it opposes a positive rate."""
        return p["damping_coefficient"] * at.delta_rate / (1 + at.delta_rate.abs() / p["thinning_velocity"])
