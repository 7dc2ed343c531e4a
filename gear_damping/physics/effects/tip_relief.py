"""Tip relief: flanks cut back where a pair of teeth meets and parts."""

from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import ElasticForce, Values

FORMS = ("linear", "parabolic")
LENGTHS = (0.25, 0.5)  # of a base pitch: a short relief, and one that reaches down to the contact of a single pair
MEETS = 0.1  # of a base pitch, assumed: over so much a pair begins and ends


class TipRelief(ElasticForce):
    """A pair that enters or leaves lacks what its relief takes, and carries nothing until that is closed.

    Under a light load the contact is shorter, under a heavy one it grows to that of teeth without relief. A pair meets
    at the tip of the driven gear and parts at that of the pinion; the relief is counted along the line of action.
    Flanks of the coast side are taken as sound.
    """

    name = "tip_relief"
    equation = "F_el = -s k (lost(C_g) + lost(C_p)), lost = (delta^-4 + C^-4)^(-1/4), C = C_a (1 -+ A) (1 - u / L)^n"
    reference = "Lin, Oswald & Townsend (1994), Mech. Mach. Theory 29(8)"
    parameters: ClassVar = (
        Parameter("depth", "m", 1e-5, "C_a, mean of the gear's tips (a pair meets) and the pinion's", 0, 1e-3),
        Parameter("asymmetry", "1", 0.0, "A, by which the pinion's relief is larger and the gear's smaller", -1, 1),
        Parameter("length", "1", 0.3, "L, base pitches over which both run out", 0.05, 1.0),
        Parameter("share", "1", 0.4, "s, of the mesh stiffness that is the relieved pair's", 0, 1),
    )
    options: ClassVar = (Option("form", FORMS, "parabolic", "n = 1 or 2"),)
    needs: ClassVar = (Trait.TEETH, Trait.PRELOAD)
    cause: ClassVar = Cause(
        "a relief of the tips of the teeth",
        tuple(
            Recipe({"depth": 1e-6}, scanned={"length": length}, fixed={"asymmetry": 0.0}, in_si=True)
            for length in LENGTHS
        ),
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Mesh angles at which a pair enters and another one leaves."""
        begins = -base["contact_lead"]
        return dict(values) | {"enters": begins, "leaves": begins + 2 * pi * (base["contact_ratio"] - 1)}

    def elastic_force(self, at: Kinematics, p: Values) -> Tensor:
        """What the two pairs do not carry, for flanks that are pressed."""
        pressed = at.deflection.clamp(min=0.0)
        meets, parts = ((at.mesh.angle - p["enters"]) / (2 * pi), (p["leaves"] - at.mesh.angle) / (2 * pi))
        gear, pinion = p["depth"] * (1 - p["asymmetry"]), p["depth"] * (1 + p["asymmetry"])
        lost = _lost(pressed, gear * self._closing(meets, p)) + _lost(pressed, pinion * self._closing(parts, p))
        return -p["share"] * at.stiffness * lost

    def _closing(self, inside: Tensor, p: Values) -> Tensor:
        """The share of a relief at so many base pitches inside the contact; none beyond it, where there is no pair."""
        place = inside + MEETS / 2 - torch.floor(inside + MEETS / 2) - MEETS / 2
        left = torch.clamp(1 - place / p["length"], 0.0, 1.0)
        there = torch.clamp(place / MEETS + 0.5, 0.0, 1.0)
        there = there * there * (3 - 2 * there)
        return there * (left if self.chosen["form"] == "linear" else left * left)


def _lost(deflection: Tensor, relief: Tensor) -> Tensor:
    """The smaller of the two, rounded as rough flanks meet; 0 where either is."""
    largest = torch.maximum(deflection, relief).clamp(min=1e-300)
    smallest = torch.minimum(deflection, relief)
    return smallest / (1 + (smallest / largest) ** 4) ** 0.25
