"""Unbalance of the pinion or the gear."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import SHAFTS, Cause, Recipe
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import BearingForce, Values


class Unbalance(BearingForce):
    """The centre of mass runs beside the shaft: a force on the bearing that grows with the speed squared."""

    name = "unbalance"
    equation = "m_b y'' + … = N + F_d + U omega^2 cos(theta + phi), angle and speed of the shaft"
    reference = "ISO 21940-11:2016, balance quality of rotors"
    parameters: ClassVar = (
        Parameter("unbalance", "kg*m", 2e-5, "U; quality G6.3 allows 1.3e-5 per kg at 4600 rpm", 0, 1),
        Parameter("phase", "rad", 0.0, "phi"),
    )
    options: ClassVar = (Option("shaft", SHAFTS, "pinion", "which of the two gears; the bearing is that gear's"),)
    needs: ClassVar = (Trait.SHAFTS,)
    requires: ClassVar = ("bearing_flexibility",)
    cause: ClassVar = Cause(
        "an unbalance",
        tuple(Recipe({"unbalance": None}, {"unbalance": "phase"}, options={"shaft": shaft}) for shaft in SHAFTS),
        turns_with="shaft",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Cosine and sine parts."""
        size, phase = values["unbalance"], values["phase"]
        return {"in_phase": size * torch.cos(phase), "quadrature": -size * torch.sin(phase)}

    def bearing_force(self, at: Kinematics, p: Values) -> Tensor:
        """The part along the line of action of the turning force."""
        turn = getattr(at, self.chosen["shaft"])
        part = p["in_phase"] * turn.cos + p["quadrature"] * turn.sin
        return part * turn.speed * turn.speed
