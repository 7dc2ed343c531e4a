"""Sliding friction between the tooth flanks."""

from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import MeshForceFactor, Switch, Values

DOUBLE, APPROACH = "tooth_friction.double", "tooth_friction.approach"


class ToothFriction(MeshForceFactor, Switch):
    """The direction of sliding follows from kinematics: it turns where a pair passes the pitch point.

    A pair is at u mesh periods, 0 where it meets and the contact ratio where it parts (unloaded); the
    pair behind it is at u + 1. Where two pairs carry, each carries half. The sums are smooth in every
    region of the switches and continue smoothly beyond it. The coast flanks take the drive side's arms.
    While the sense of rotation stays, a factor on the mesh force of the mesh angle alone is what another shape
    of the mesh stiffness is, but for the damping: where that shape is fitted, friction has nothing left to take.
    """

    name = "tooth_friction"
    equation = (
        "(N + F_d) (1 - mu sum_i sh_i s_i L_i), L_i = m_e (r_b1 rho_1i / I1 + r_b2 rho_2i / I2), "
        "s_i = 1 before the pitch point, -1 behind it"
    )
    reference = "Vaishya & Singh (2003), J. Mech. Des. 125(2)"
    parameters: ClassVar = (
        Parameter("friction_coefficient", "1", 0.05, "mu", 0, 1),
        Parameter("pitch_point_shift", "1", 0.0, "mesh periods from the pitch point of standard teeth", -1, 1),
    )
    needs: ClassVar = (Trait.SHAFTS, Trait.TEETH)
    cause: ClassVar = Cause(
        "the sliding friction of the teeth, which turns round at the pitch point",
        (Recipe({"friction_coefficient": None}),),
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Lever arms and zones, as angles and their cosines and sines."""
        radius_1, radius_2 = base["base_radius_pinion"], base["base_radius_gear"]
        arm_1, arm_2 = radius_1 / base["inertia_pinion"], radius_2 / base["inertia_gear"]
        slope = 2 * pi * radius_1 / base["n_teeth_pinion"] * (arm_1 - arm_2) / (arm_1 * radius_1 + arm_2 * radius_2)
        pitch = _approach(base) + values["pitch_point_shift"]
        lead, half = base["contact_lead"], pi * (base["contact_ratio"] - 1)
        beyond = (2 * pi * pitch + lead >= 2 * pi).to(half)  # the pair behind passes the pitch point
        half_approach = pi * (pitch - beyond) + lead / 2
        return {
            "friction": values["friction_coefficient"],
            "pitch": pitch,
            "slope": slope,
            "arm_at_pitch": torch.tan(base["pressure_angle"]),
            "beyond": beyond,
            "zone": half / pi,  # mesh periods of double contact
            "lead": base["contact_lead"] / (2 * pi),
            "pitch_angles": 2 * pi / base["n_teeth_pinion"] + 2 * pi / base["n_teeth_gear"],
            **_zone("double", half - lead, half),
            **_zone("approach", half_approach - lead, half_approach),
        }

    def switches(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """Positive in double contact, and before the pitch point."""
        double, approach = (_turned(at, p, zone)[0] - p[f"{zone}_edge"] for zone in ("double", "approach"))
        return {DOUBLE: double, APPROACH: approach}

    def force_factor(self, at: Kinematics, p: Values) -> Tensor:
        """The factor on the active branch."""
        double, approach = at.active_branch[DOUBLE], at.active_branch[APPROACH]
        side = 2 * double - 1  # about the centre of double contact, or of single contact opposite to it
        cosine, sine = (side * part for part in _turned(at, p, "double"))
        offset = 2 * torch.atan(sine / (1 + cosine).clamp(min=1e-12))
        front = (p["double_centre"] + pi * (1 - double) + offset) / (2 * pi)
        arm = p["arm_at_pitch"] + p["slope"] * (front - p["pitch"])
        sign = p["beyond"] + (1 - p["beyond"]) * (2 * approach - 1)
        sign_behind = 2 * p["beyond"] * approach - 1
        arms = (1 - double / 2) * sign * arm + double / 2 * sign_behind * (arm + p["slope"])
        return 1 - p["friction"] * torch.sign(at.pinion.speed) * arms

    def common_share(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """Off the pitch point the friction turns one shaft more than it holds the other.

        At the pitch point its arms are r_b1 tan(alpha) and r_b2 tan(alpha), and its torques balance over the teeth as
        those of the normal force do; a length s behind it one arm is s longer and the other s shorter.
        """
        met = (at.mesh.angle / (2 * pi) + p["lead"]).remainder(1)
        double, front = (met < p["zone"]).to(met), met - p["lead"] - p["pitch"]
        away = (1 - double / 2) * front.abs() + double / 2 * (front + 1).abs()
        size = -p["friction"] * torch.sign(at.pinion.angle[-1] - at.pinion.angle[0]) * p["pitch_angles"]
        return size * away, size * _mean_away(p)


def _mean_away(p: Values) -> Tensor:
    """Mean over a pitch of how many pitches the pairs that carry are from the pitch point."""
    first, zone = -p["lead"] - p["pitch"], p["zone"]

    def up_to(place: Tensor) -> Tensor:
        return place * place.abs() / 2

    alone, behind = up_to(first + 1) - up_to(first), up_to(first + zone + 1) - up_to(first + 1)
    return alone + (behind - up_to(first + zone) + up_to(first)) / 2


def _approach(base: Values) -> Tensor:
    """Path of approach of standard teeth, whose tips are one module above the pitch circle, in mesh periods."""
    radius = base["base_radius_gear"]
    tip = base["module"] * (base["n_teeth_gear"] / 2 + 1)
    base_pitch = 2 * pi * base["base_radius_pinion"] / base["n_teeth_pinion"]
    return (torch.sqrt(tip**2 - radius**2) - radius * torch.tan(base["pressure_angle"])) / base_pitch


def _zone(name: str, centre: Tensor, half: Tensor) -> dict[str, Tensor]:
    return {
        f"{name}_centre": centre,
        f"{name}_cos": torch.cos(centre),
        f"{name}_sin": torch.sin(centre),
        f"{name}_edge": torch.cos(half),
    }


def _turned(at: Kinematics, p: Values, zone: str) -> tuple[Tensor, Tensor]:
    """Cosine and sine of the mesh angle from the centre of a zone."""
    cosine, sine = p[f"{zone}_cos"], p[f"{zone}_sin"]
    return at.mesh.cos * cosine + at.mesh.sin * sine, at.mesh.sin * cosine - at.mesh.cos * sine
