"""Damping that grows with the deflection."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, where_there_is_a_spring
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.shapes import power_of_size
from gear_damping.physics.terms import DampingForce, Values

EXPONENTS = (0.3, 3.0)  # beyond, it is no damping that grows with the deflection, or a stop
SWITCHED_ON = Recipe(
    {"damping_coefficient": 0.01},
    scanned={"exponent": 1.0},
    fixed={"reference_deflection": 1.0},
    within={"hunt_crossley_damping.exponent": EXPONENTS},
)


class HuntCrossleyDamping(DampingForce):
    """A viscous force that vanishes where the flanks just touch, or at the place of rest."""

    name = "hunt_crossley_damping"
    refinement = 1.5  # of the steps, measured by step halving: the force bends where contact begins
    equation = "F_d = c (|delta| / delta_0)^p delta'"
    reference = "Hunt & Crossley (1975), J. Appl. Mech. 42(2)"
    parameters: ClassVar = (
        Parameter("damping_coefficient", "N*s/m", 64.5, "c, at the reference deflection", 0, 1e12),
        Parameter("exponent", "1", 1.0, "p", 0, 5),
        Parameter("reference_deflection", "m", 1.66e-5, "delta_0, a fixed length", 1e-9, 1e9),
    )
    dissipative = True
    cause: ClassVar = Cause(
        "a damping force that grows with the deflection",
        where_there_is_a_spring(SWITCHED_ON),
    )

    def damping_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        share = power_of_size(at.deflection / p["reference_deflection"], p["exponent"])
        return p["damping_coefficient"] * share * at.delta_rate
