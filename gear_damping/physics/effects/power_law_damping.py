"""Damping by a power of the rate of deflection."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.damping_ratio import equivalent_damping_ratio, power_law_coefficient
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.scales import Scales
from gear_damping.physics.shapes import power_of_size, sign_change_rate
from gear_damping.physics.terms import DampingLaw, Values

ROUNDED = 0.02  # of the unit of velocity, below which a law with an exponent below 1 goes on straight through rest


class PowerLawDamping(DampingLaw):
    """A force that grows with a power of the rate, in its direction.

    With an exponent below 1 its slope at rest would be infinite, and no step could follow it: there it goes straight
    through rest, below 2 % of the natural velocity.
    """

    name = "power_law_damping"
    equation = "F_d = alpha sign(delta') |delta'|^n"
    reference = "Yousfi et al. (2026); the printed form alpha |v|^(n+1) drives the motion where v < 0"
    parameters: ClassVar = (
        Parameter("coefficient", "N", 131.797425, "alpha in N (s/m)^n; the default is 0.35 % at n = 2", 0, 1e24),
        Parameter("exponent", "1", 2.0, "n", 0.2, 5, "assumed"),
    )
    options: ClassVar = (Option("as_printed", (False, True), False, "alpha |delta'|^(n+1), which does not dissipate"),)
    dissipative = True
    cause: ClassVar = Cause(
        "a damping force that grows with a power of the rate",
        tuple(Recipe({"coefficient": 0.01}, scanned={"exponent": n}) for n in (2.0, 0.5, 3.0)),
        separated_by="ring_down",
    )

    def to_natural(self, values: Values, scales: Scales) -> dict[str, Tensor]:
        """Alpha has the unit N (s/m)^n, which depends on n."""
        power = values["exponent"] + (1 if self.chosen["as_printed"] else 0)
        coefficient = values["coefficient"] * scales.velocity**power / scales.force
        return {"coefficient": coefficient, "exponent": values["exponent"]}

    def damping_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        size = p["coefficient"] * power_of_size(at.delta_rate, p["exponent"])
        if self.chosen["as_printed"]:
            return size * at.delta_rate.abs()
        rounded = (at.delta_rate.square() + ROUNDED**2) ** ((p["exponent"] - 1) / 2) * at.delta_rate
        return torch.where(p["exponent"] < 1, p["coefficient"] * rounded, torch.where(at.delta_rate < 0, -size, size))

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """With an exponent below 1 the slope at rest is steep: a rate that follows its turn, as of a dry friction.

        It bends the less, the nearer the exponent is to 1 (measured by step halving, exponents of 0.2 to 0.97).
        """
        exponent = values["exponent"]
        steep = values["coefficient"] * ROUNDED ** (exponent - 1)
        width = ROUNDED / (1 - exponent).clamp(min=ROUNDED)
        turning = sign_change_rate(steep * width, width, base["equivalent_mass"])
        return dict(values) | {"fastest_rate": torch.where(exponent < 1, turning, 0.0)}

    def damping_ratio(self, values: Values, mass: Tensor, stiffness: Tensor, velocity: Tensor) -> Tensor:
        """The ratio that dissipates as much per cycle at this velocity amplitude."""
        return equivalent_damping_ratio(values["coefficient"], values["exponent"], velocity, mass, stiffness)

    def coefficient_for(
        self, damping_ratio: Tensor, values: Values, mass: Tensor, stiffness: Tensor, velocity: Tensor
    ) -> dict[str, Tensor]:
        """Alpha for this ratio at this velocity amplitude."""
        alpha = power_law_coefficient(damping_ratio, values["exponent"], velocity, mass, stiffness)
        return {"coefficient": alpha}
