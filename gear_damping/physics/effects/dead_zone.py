"""A dead zone of the drive: below a threshold nothing of what is asked for reaches the oscillator."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.swinging import FORCE
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Load, Values

GAIN = "force_gain"  # of a system whose measured force has one
NOTHING = 1e-120  # of the eighth power of a force: so that no force through no zone is no force, and not undefined


def _where_a_force_is_measured(rig: Rig) -> tuple[Recipe, ...]:
    return (Recipe({"width": 0.005}),) if FORCE in rig.inputs else ()


class DeadZone(Load):
    """What a motor's driver, a valve or a belt with play keeps back of either sign; rounded at its edge.

    At its edge it lets a twelfth of the threshold through, where one with sharp edges lets nothing through. A constant
    force beside the measured one does not pass the drive, and is not kept back.
    """

    name = "dead_zone"
    equation = "F -> F - w F / (F^8 + w^8)^(1/8)"
    reference = "Tao & Kokotovic (1994), IEEE Trans. Autom. Control 39(1), with rounded edges"
    parameters: ClassVar = (Parameter("width", "N", 1.0, "w, the force that is kept back", 0, 1e18),)
    needs: ClassVar = (Trait.REST,)
    cause: ClassVar = Cause(
        "a dead zone of the drive, which keeps small forces back", _where_a_force_is_measured, separated_by="amplitude"
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """With the gain of the measured force; 1 where the system has none."""
        return {"width": values["width"], "gain": base.get(GAIN, torch.ones_like(values["width"]))}

    def load_force(self, at: Kinematics, p: Values) -> Tensor:
        """What is kept back, against the force that is asked for; nothing where none is."""
        if FORCE not in at.inputs:
            return torch.zeros_like(at.displacement)
        asked = p["gain"] * at.inputs[FORCE]
        return -p["width"] * asked / torch.sqrt(torch.sqrt(torch.sqrt(asked**8 + p["width"] ** 8 + NOTHING)))
