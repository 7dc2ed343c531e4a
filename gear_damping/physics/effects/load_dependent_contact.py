"""Contact that lasts longer under load."""

from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import ContactChange, Values

LARGEST = 2.0  # contact ratio with two pairs in contact all the time


class LoadDependentContact(ContactChange):
    """Corner contact: bent teeth meet early and part late, by equal angles, in proportion to the mean load."""

    name = "load_dependent_contact"
    equation = "eps + g |F0| / F_ref, half of it before and half after the unloaded zone"
    reference = "Munro, Morrish & Palmer (1999), Proc. IMechE C 213(4)"
    parameters: ClassVar = (
        Parameter("growth", "1", 0.05, "g, contact ratio added at the reference load", 0, 1),
        Parameter("reference_load", "N", 5321.0, "F_ref; 5321 N is 150 N m on the default pinion", 1e-6, 1e9),
    )
    needs: ClassVar = (Trait.TEETH, Trait.PRELOAD)
    cause: ClassVar = Cause(
        "a contact ratio that grows with the load",
        (
            # What it changes are the edges, which the free shape of the stiffness hid so far. Their height stays as
            # calibrated: twice the height and half the growth change the stiffness alike.
            Recipe(
                {"growth": None},
                jointly_fitted={
                    "mesh_phase": None,
                    "fourier_mesh_stiffness.contact_ratio": None,
                    "fourier_mesh_stiffness.edge": None,
                },
                within={"fourier_mesh_stiffness.edge": (0.02, 0.3)},
            ),
        ),
    )

    def contact(self, values: Values, contact_ratio: Tensor, derived: Values) -> tuple[Tensor, Tensor]:
        """The contact ratio under load, and the mesh angle by which double contact begins early."""
        grown = contact_ratio + values["growth"] * derived["mean_load"].abs() / values["reference_load"]
        grown = torch.maximum(contact_ratio, grown.clamp(max=LARGEST))
        return grown, pi * (grown - contact_ratio)
