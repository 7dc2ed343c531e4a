"""Drag of air and oil on the gears."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Load, Values


class WindageDrag(Load):
    """A torque against the rotation of the pinion that grows with the square of its speed."""

    name = "windage_drag"
    equation = "T1 - c_w |omega_1| omega_1"
    reference = "Diab, Ville, Velex & Changenet (2004), J. Mech. Des. 126(5)"
    parameters: ClassVar = (Parameter("coefficient", "N*m*s^2", 4e-6, "c_w; 0.9 N m at 4600 rpm", 0, 1),)
    needs: ClassVar = (Trait.SHAFTS, Trait.TORQUE)
    cause: ClassVar = Cause(
        "a drag that grows with the square of the speed",
        (Recipe({"coefficient": None}),),
        separated_by="speed",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The coefficient as a force along the line of action."""
        return {"force": values["coefficient"] * base["load_per_pinion_torque"]}

    def load_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        return -p["force"] * at.pinion.speed.abs() * at.pinion.speed
