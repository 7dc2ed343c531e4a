"""Mesh stiffness as a rectangular wave."""

from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import MeshStiffness, Switch, Values

DOUBLE = "rectangular_mesh_stiffness.double"


class RectangularMeshStiffness(MeshStiffness, Switch):
    """Jumps between one and two tooth pairs; the solver splits its step at each jump."""

    name = "rectangular_mesh_stiffness"
    equation = "k = k_max where theta_M mod 2 pi < 2 pi (eps - 1), else k_min"
    reference = "Lin & Parker (2002), J. Sound Vib. 249(1)"
    parameters: ClassVar = (
        Parameter("maximum", "N/m", 4e8, "stiffness with two tooth pairs in contact", 0, 1e14, "paper"),
        Parameter("minimum", "N/m", 2e8, "stiffness with one tooth pair in contact", 0, 1e14, "paper"),
        Parameter("contact_ratio", "1", 1.6, "contact ratio", 1.0, 2.0, "paper"),
    )

    def mean(self, values: Values) -> Tensor:
        """Mean over a mesh period."""
        return values["minimum"] + (values["maximum"] - values["minimum"]) * (values["contact_ratio"] - 1)

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The centre of the double contact and the cosine of half its width."""
        half = pi * (values["contact_ratio"] - 1)
        centre = half - base["contact_lead"]
        edge = {"centre_cos": torch.cos(centre), "centre_sin": torch.sin(centre), "edge": torch.cos(half)}
        return dict(values) | edge

    def switches(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """Positive in double contact: cos(theta_M - centre) - cos(half width)."""
        cosine = at.mesh.cos * p["centre_cos"] + at.mesh.sin * p["centre_sin"]
        return {DOUBLE: cosine - p["edge"]}

    def stiffness(self, at: Kinematics, p: Values) -> Tensor:
        """The value on the active branch."""
        return p["minimum"] + (p["maximum"] - p["minimum"]) * at.active_branch[DOUBLE]
