"""Backlash: clearance between the flanks, with contact on both sides."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Contact, Values

DRIVE, COAST = "backlash.drive", "backlash.coast"

GAPS = (0.01, 0.02, 0.04, 0.08)  # in modules: those of usual gears, from which fits begin


def _gaps_of_teeth(rig: Rig) -> tuple[Recipe, ...]:
    """What is lost in impacts passes for damping as long as the flanks cannot part; teeth alone have flanks."""
    sizes = [share * rig.values["module"] for share in GAPS] if rig.has(Trait.TEETH) else []
    restart_scaling = {"viscous_damping.damping_coefficient": 0.02}
    return tuple(Recipe({"gap": size}, non_nested=True, in_si=True, restart_scaling=restart_scaling) for size in sizes)


class Backlash(Contact):
    """The drive flank touches where delta > 0, the coast flank where delta < -gap."""

    name = "backlash"
    refinement = 1.45  # of the steps, measured by step halving: the force bends where flanks part
    equation = "deflection = delta for delta > 0, delta + gap for delta < -gap, else 0; damping only in contact"
    reference = "Kahraman & Singh (1990), J. Sound Vib. 142(1)"
    parameters: ClassVar = (Parameter("gap", "m", 1e-4, "whole clearance; the drive flank is at 0", 0, 0.01),)
    options: ClassVar = (
        Option("as_printed", (False, True), False, "flanks at -gap/2 and gap/2, damping also in free flight"),
    )
    cause: ClassVar = Cause(
        "the gap between the flanks",
        _gaps_of_teeth,
        separated_by="reversal",
    )

    def _datum(self, p: Values) -> Tensor:
        return p["gap"] / 2 if self.chosen["as_printed"] else torch.zeros_like(p["gap"])

    def switches(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """Depth of the drive flank and of the coast flank."""
        depth = at.delta - self._datum(p)
        return {DRIVE: depth, COAST: -depth - p["gap"]}

    def clearances(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """Distances of the drive flanks and of the coast flanks."""
        depth = at.delta - self._datum(p)
        return -depth * (1 - at.active_branch[DRIVE]), (depth + p["gap"]) * (1 - at.active_branch[COAST])

    def deflect(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """Deflection and contact on the active branch."""
        depth, drive, coast = at.delta - self._datum(p), at.active_branch[DRIVE], at.active_branch[COAST]
        deflection = drive * depth + coast * (depth + p["gap"])
        if self.chosen["as_printed"]:
            return deflection, torch.ones_like(depth)
        return deflection, drive + coast
