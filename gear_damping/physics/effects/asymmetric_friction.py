"""Friction that differs by the direction of motion."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.shapes import friction_width, sign_change_rate
from gear_damping.physics.terms import DampingForce, Values

# Where a fit begins, in natural units: small beside the static load and a damping ratio of some percent.
DRY = {"force_forward": 0.005, "force_backward": 0.005}
VISCOUS = {"damping_forward": 0.01, "damping_backward": 0.01}  # where a fit begins, as above


def _switched_on(rig: Rig) -> tuple[Recipe, ...]:
    """Dry friction alone, and with a viscous part that differs too; of motion in one direction neither is told."""
    if rig.one_way:
        return ()
    within = {"asymmetric_friction.width": friction_width(rig)}
    return tuple(
        Recipe(strengths, scanned={"width": 0.05, "rest_share": 0.5}, within=within, sharpest=("width",))
        for strengths in (DRY, DRY | VISCOUS)
    )


class AsymmetricFriction(DampingForce):
    """Dry and viscous friction, each with a value for every direction of motion.

    F_m is half the sum of both dry forces and F_h half their difference: what is there at rest where they change over
    by a convex combination (r = 1), and is not where nothing rubs before it moves (r = 0).
    """

    name = "asymmetric_friction"
    equation = "F_d = F_m t + F_h (r + (1 - r) t^2) + c(t) delta', t = tanh(delta' / (w V)), c from backward to forward"
    reference = "Armstrong-Hélouvry, Dupont & Canudas de Wit (1994), Automatica 30(7); r = 1: Filippov (1988), Kluwer"
    parameters: ClassVar = (
        Parameter("force_forward", "N", 20.0, "dry friction where the deflection grows", 0, 1e18),
        Parameter("force_backward", "N", 10.0, "dry friction where it falls", 0, 1e18),
        Parameter("damping_forward", "N*s/m", 0.0, "viscous coefficient where the deflection grows", 0, 1e12),
        Parameter("damping_backward", "N*s/m", 0.0, "viscous coefficient where it falls", 0, 1e12),
        Parameter("rest_share", "1", 0.0, "r, share of F_h that is there at rest", 0, 2),
        Parameter("width", "1", 0.05, "w, width of the sign change relative to the unit of velocity V", 1e-6, 10),
    )
    dissipative = True
    cause: ClassVar = Cause(
        "a friction force that differs between the two directions of motion",
        _switched_on,
        separated_by="reversal",
        simpler="coulomb_friction",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Means and halves of the differences of the two directions."""
        found = {"steepness": 1 / values["width"], "rest_share": values["rest_share"]}
        for kind in ("force", "damping"):
            forward, backward = values[f"{kind}_forward"], values[f"{kind}_backward"]
            found |= {f"{kind}_mean": (forward + backward) / 2, f"{kind}_half": (forward - backward) / 2}
        force, damping = (torch.maximum(values[f"{k}_forward"], values[f"{k}_backward"]) for k in ("force", "damping"))
        turning = sign_change_rate(force, values["width"], base["equivalent_mass"])
        return found | {"fastest_rate": torch.maximum(turning, damping / base["equivalent_mass"])}

    def damping_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        direction = torch.tanh(at.delta_rate * p["steepness"])
        even = p["rest_share"] + (1 - p["rest_share"]) * direction.square()
        dry = direction * p["force_mean"] + p["force_half"] * even
        return dry + at.delta_rate * (p["damping_mean"] + direction * p["damping_half"])
