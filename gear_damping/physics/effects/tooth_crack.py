"""A cracked tooth."""

from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import SHAFTS, Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import StiffnessFactor, Switch, Values

IN_MESH = "tooth_crack.in_mesh"
EDGE, EDGES = 0.32, (0.064, 1.9)  # where it begins and its bounds, in angles from tooth to tooth


def _every_tooth(rig: Rig) -> tuple[Recipe, ...]:
    """One variant a tooth, on either shaft; one for all teeth where they have no numbers."""
    counts = {shaft: rig.teeth(shaft) if rig.indexed else 1 for shaft in SHAFTS}
    return tuple(_one_tooth(i, shaft, rig.teeth(shaft)) for shaft in SHAFTS for i in range(counts[shaft]))


def _one_tooth(number: int, shaft: str, teeth: int) -> Recipe:
    pitch = 2 * pi / teeth
    return Recipe(
        {"depth": None},
        scanned={"phase": number * pitch, "extent": 0.8, "edge": EDGE * pitch},
        within={"tooth_crack.edge": (EDGES[0] * pitch, EDGES[1] * pitch), "tooth_crack.extent": (0.2, 1.2)},
        in_si=True,
        sharpest=("edge",),
        options={"shaft": shaft},
    )


class ToothCrack(StiffnessFactor, Switch):
    """The mesh is softer while one tooth is in contact, once per turn of its shaft."""

    name = "tooth_crack"
    equation = "k (1 - d) while |theta + phi - pi eps / z| < s pi eps / z"
    reference = "Chaari, Fakhfakh & Haddar (2009), Eur. J. Mech. A/Solids 28(3)"
    parameters: ClassVar = (
        Parameter("depth", "1", 0.1, "d, share of the stiffness that is lost", 0, 0.9),
        Parameter("phase", "rad", 0.0, "phi; the tooth enters at theta = -phi"),
        Parameter("extent", "1", 1.0, "s, share of the contact over which the tooth is softer", 0.05, 1.5),
        Parameter("edge", "rad", 0.02, "shaft angle over which a smooth edge goes from 12 to 88 %", 1e-6, 1),
    )
    options: ClassVar = (
        Option("shaft", SHAFTS, "pinion", "whose tooth"),
        Option("edges", ("smooth", "switched"), "smooth", "a tanh at either edge, or a jump"),
    )
    needs: ClassVar = (Trait.SHAFTS, Trait.TEETH)
    cause: ClassVar = Cause(
        "a tooth that is softer than the others",
        _every_tooth,
        turns_with="tooth",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The centre of the contact and the cosine of half the width of what is softer."""
        contact = pi * base["contact_ratio"] / base[f"n_teeth_{self.chosen['shaft']}"]
        half, centre = values["extent"] * contact, contact - values["phase"]
        limit, steepness = torch.cos(half), 2 / (values["edge"] * torch.sin(half))
        found = {"depth": values["depth"], "limit": limit, "steepness": steepness}
        if self.chosen["edges"] == "smooth":  # edges that meet leave less than all of it in the middle
            found["depth"] = values["depth"] * 2 / (1 + torch.tanh(steepness * (1 - limit)))
        return found | {"centre_cos": torch.cos(centre), "centre_sin": torch.sin(centre)}

    def _inside(self, at: Kinematics, p: Values) -> Tensor:
        """Positive while the tooth is in contact."""
        turn = getattr(at, self.chosen["shaft"])
        return turn.cos * p["centre_cos"] + turn.sin * p["centre_sin"] - p["limit"]

    def switches(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """One function where the edges are jumps."""
        return {IN_MESH: self._inside(at, p)} if self.chosen["edges"] == "switched" else {}

    def factor(self, at: Kinematics, p: Values) -> Tensor:
        """1 - d in contact, 1 elsewhere."""
        if self.chosen["edges"] == "switched":
            return 1 - p["depth"] * at.active_branch[IN_MESH]
        return 1 - p["depth"] * (1 + torch.tanh(p["steepness"] * self._inside(at, p))) / 2
