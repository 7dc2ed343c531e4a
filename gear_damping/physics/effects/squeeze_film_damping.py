"""Damping by the oil film between the flanks."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import DampingForce, Values


class SqueezeFilmDamping(DampingForce):
    """The film on both sides of the tooth resists their motion, the more the thinner it is."""

    name = "squeeze_film_damping"
    refinement = 1.3  # of the steps, measured by step halving: the film is stiff where it is thin
    equation = "F_d = c ((h0 / (h0 + h_drive))^3 + (h0 / (h0 + h_coast))^3) delta', also in the gap"
    reference = "Brancati, Rocca & Russo (2005), Proc. IMechE D 219(9)"
    parameters: ClassVar = (
        Parameter("damping_coefficient", "N*s/m", 64.5, "c, of the film between flanks that touch", 0, 1e12),
        Parameter("film_thickness", "m", 1e-5, "h0, film that remains between flanks that touch", 1e-8, 1e-2),
    )
    needs: ClassVar = (Trait.TEETH,)
    dissipative = True
    acts_in_gap = True
    requires: ClassVar = ("backlash",)
    cause: ClassVar = Cause(
        "the damping of an oil film squeezed between the flanks",
        (Recipe({"damping_coefficient": 0.01}),),
    )

    def damping_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        drive, coast = (p["film_thickness"] / (p["film_thickness"] + h.clamp(min=0)) for h in at.clearances)
        return p["damping_coefficient"] * at.delta_rate * (drive * drive * drive + coast * coast * coast)
