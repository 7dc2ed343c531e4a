"""Error of the inertias."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import SystemChange, Values


class InertiaError(SystemChange):
    """Both inertias differ from the drawing by the same factor; the load stays."""

    name = "inertia_error"
    equation = "m_e (1 + kappa)"
    reference = "Özgüven & Houser (1988), J. Sound Vib. 121(3)"
    parameters: ClassVar = (Parameter("share", "1", 0.1, "kappa", -0.9, 10),)
    needs: ClassVar = (Trait.MASS,)
    cause: ClassVar = Cause(
        "a moment of inertia other than the one that was stated",
    )

    def change(self, values: Values, derived: dict[str, Tensor]) -> dict[str, Tensor]:
        """Mass and natural frequency."""
        mass = derived["equivalent_mass"] * (1 + values["share"])
        frequency = torch.sqrt(derived["mean_stiffness"] / mass)
        return derived | {"equivalent_mass": mass, "natural_frequency": frequency}
