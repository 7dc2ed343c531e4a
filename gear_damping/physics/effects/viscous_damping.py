"""Viscous damping of the mesh."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import DampingLaw, Values


class ViscousDamping(DampingLaw):
    """A force in proportion to the rate of deflection."""

    name = "viscous_damping"
    equation = "F_d = c delta'"
    reference = "Özgüven & Houser (1988), J. Sound Vib. 121(3)"
    parameters: ClassVar = (
        Parameter("damping_coefficient", "N*s/m", 64.5, "c; 64.5 is 0.35 % of critical for the default pair", 0, 1e12),
    )
    dissipative = True
    cause: ClassVar = Cause(
        "a damping force proportional to the rate",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The coefficient, and the rate at which it alone brings a velocity to rest."""
        return dict(values) | {"fastest_rate": values["damping_coefficient"] / base["equivalent_mass"]}

    def damping_force(self, at: Kinematics, p: Values) -> Tensor:
        """C times the rate."""
        return p["damping_coefficient"] * at.delta_rate

    def damping_ratio(self, values: Values, mass: Tensor, stiffness: Tensor, velocity: Tensor) -> Tensor:
        """The same at every amplitude."""
        return values["damping_coefficient"] / (2 * torch.sqrt(mass * stiffness))

    def coefficient_for(
        self, damping_ratio: Tensor, values: Values, mass: Tensor, stiffness: Tensor, velocity: Tensor
    ) -> dict[str, Tensor]:
        """C = 2 zeta sqrt(k m)."""
        return {"damping_coefficient": 2 * damping_ratio * torch.sqrt(mass * stiffness)}
