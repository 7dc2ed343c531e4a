"""Coulomb friction in the mesh."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.shapes import friction_width, sign_change_rate
from gear_damping.physics.terms import DampingForce, Values


def _switched_on(rig: Rig) -> tuple[Recipe, ...]:
    within = {"coulomb_friction.width": friction_width(rig)}
    return (Recipe({"force": 0.005}, scanned={"width": 0.05}, within=within, sharpest=("width",)),)


class CoulombFriction(DampingForce):
    """A force of constant size against the motion, smoothed about zero."""

    name = "coulomb_friction"
    equation = "F_d = F_c tanh(delta' / (w V)), V = omega_n F0 / k0 (oscillator: amplitude / characteristic_time)"
    reference = "Threlfall (1978), Mech. Mach. Theory 13(4)"
    parameters: ClassVar = (
        Parameter("force", "N", 20.0, "F_c", 0, 1e18),
        Parameter("width", "1", 0.05, "w, width of the sign change relative to the unit of velocity V", 1e-6, 10),
    )
    dissipative = True
    cause: ClassVar = Cause(
        "a dry friction force",
        _switched_on,
        separated_by="ring_down",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """In natural units V is 1."""
        steepness = 1 / values["width"]
        return {
            "force": values["force"],
            "steepness": steepness,
            "fastest_rate": sign_change_rate(values["force"], values["width"], base["equivalent_mass"]),
        }

    def damping_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        return p["force"] * torch.tanh(at.delta_rate * p["steepness"])
