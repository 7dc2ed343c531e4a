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

IN_MESH, ALONE = "tooth_crack.in_mesh", "tooth_crack.alone"
SHORTEST = 0.02  # pitches: a contact ratio of 2 leaves nothing to a pair alone
EDGE, EDGES = 0.32, (0.064, 1.9)  # where it begins and its bounds, in angles from tooth to tooth


def _every_tooth(rig: Rig) -> tuple[Recipe, ...]:
    """Both forms for every tooth of either shaft; for all teeth at once where they have no numbers."""
    counts = {shaft: rig.teeth(shaft) if rig.indexed else 1 for shaft in SHAFTS}
    return tuple(
        _one_tooth(2 * pi * i + rig.values.get("mesh_phase", 0.0), shaft, rig.teeth(shaft), halved)
        for shaft in SHAFTS
        for halved in (False, True)
        for i in range(counts[shaft])
    )


def _one_tooth(mesh: float, shaft: str, teeth: int, halved: bool) -> Recipe:
    """Of the tooth that enters where the mesh has turned by minus this angle."""
    pitch = 2 * pi / teeth
    return Recipe(
        {"depth": None},
        scanned={"phase": mesh / teeth, "extent": 1.0 if halved else 0.8, "edge": EDGE * pitch},
        within={"tooth_crack.edge": (EDGES[0] * pitch, EDGES[1] * pitch), "tooth_crack.extent": (0.2, 1.2)},
        in_si=True,
        sharpest=("edge",),
        options={"shaft": shaft, "halved": halved},
    )


class ToothCrack(StiffnessFactor, Switch):
    """The mesh is softer while one tooth is in contact, once per turn of its shaft.

    Of two pairs that carry, only one is softer: there the mesh loses half as much, where `halved` says so.
    """

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
        Option("halved", (False, True), False, "half of d while two pairs carry"),
    )
    needs: ClassVar = (Trait.SHAFTS, Trait.TEETH)
    cause: ClassVar = Cause(
        "a tooth that is softer than the others",
        _every_tooth,
        turns_with="tooth",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The centre of the contact and the cosine of half the width of what is softer, and of single contact."""
        teeth, ratio = base[f"n_teeth_{self.chosen['shaft']}"], base["contact_ratio"]
        contact = pi * ratio / teeth
        centre = contact - values["phase"]
        found = {"depth": values["depth"], "centre_cos": torch.cos(centre), "centre_sin": torch.sin(centre)}
        found |= self._window("", values["extent"] * contact, values["edge"])
        if self.chosen["halved"]:
            single = torch.clamp(pi * (2 - ratio) / teeth, min=SHORTEST * pi / float(teeth.max()))
            found |= self._window("single_", single, values["edge"])
        return found

    def _window(self, name: str, half: Tensor, edge: Tensor) -> dict[str, Tensor]:
        """Where it ends, how steeply, and by how much edges that meet leave less than all of it in the middle."""
        limit, steepness = torch.cos(half), 2 / (edge * torch.sin(half))
        height = torch.ones_like(limit)
        if self.chosen["edges"] == "smooth":
            height = 2 / (1 + torch.tanh(steepness * (1 - limit)))
        return {f"{name}limit": limit, f"{name}steepness": steepness, f"{name}height": height}

    def _inside(self, at: Kinematics, p: Values, name: str = "") -> Tensor:
        """Positive while the tooth is in contact; with `single_` while it carries alone."""
        turn = getattr(at, self.chosen["shaft"])
        return turn.cos * p["centre_cos"] + turn.sin * p["centre_sin"] - p[f"{name}limit"]

    def switches(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """One function for each window where the edges are jumps."""
        if self.chosen["edges"] != "switched":
            return {}
        alone = {ALONE: self._inside(at, p, "single_")} if self.chosen["halved"] else {}
        return {IN_MESH: self._inside(at, p)} | alone

    def factor(self, at: Kinematics, p: Values) -> Tensor:
        """1 - d in contact, 1 elsewhere; where halved 1 - d / 2 beside another pair."""
        share = self._share(at, p, "", IN_MESH)
        if self.chosen["halved"]:
            share = (share + self._share(at, p, "single_", ALONE)) / 2
        return 1 - p["depth"] * share

    def _share(self, at: Kinematics, p: Values, name: str, branch: str) -> Tensor:
        if self.chosen["edges"] == "switched":
            return at.active_branch[branch]
        rising = torch.tanh(p[f"{name}steepness"] * self._inside(at, p, name))
        return p[f"{name}height"] * (1 + rising) / 2
