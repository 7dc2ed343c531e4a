"""Torsion of the shaft or coupling between a gear and the machine on its shaft."""

from collections.abc import Mapping
from math import inf, pi
from typing import Any, ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import SHAFTS, Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.shapes import share_of_shaft
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import ExtraStates, LoadPath, Values

TWIST, RATE = "shaft_torsion.twist", "shaft_torsion.twist_rate"
SOFTNESS = (0.012, 0.04, 0.12, 0.4)  # of the mesh as the shaft feels it
SOFTEST = 1e-4  # of it: what twists by a radian under its load is no shaft but a slow change of the torque
INERTIAS = (2.9, 10.8)  # of both gears as the shaft feels them
LIGHTEST = 0.1  # of them: what carries the torque weighs more than a hub, and a lighter one is any linear memory
MOST_DAMPED = 0.3  # twice what rubber couplings reach: a relative damping of 2 (DIN 740) is a ratio of 2 / 4 pi


def _on_either_shaft(rig: Rig) -> tuple[Recipe, ...]:
    """Of several softnesses, and of the one with which it rings where most is left."""
    return tuple(
        Recipe(
            {"stiffness": k},
            non_nested=True,
            scanned={"motor_inertia": j * _inertia(rig, shaft), "damping_ratio": 0.02},
            in_si=True,
            options={"shaft": shaft},
            within=_of_a_machine(rig, shaft),
        )
        for shaft in SHAFTS
        for j in INERTIAS
        for k in (
            *(soft * _mesh_stiffness(rig, shaft) for soft in SOFTNESS),
            *(_ringing(frequency, j, _inertia(rig, shaft)) for frequency in rig.frequencies),
        )
    )


def _ringing(frequency: float, ratio: float, gears: float) -> float:
    """The stiffness with which a machine of so many times the inertia of both gears swings against them, in N*m/rad."""
    return (2 * pi * frequency) ** 2 * gears / (1 + 1 / ratio)


def _of_a_machine(rig: Rig, shaft: str) -> dict[str, tuple[float, float]]:
    """What a shaft with a machine on it can be."""
    return {
        "shaft_torsion.stiffness": (SOFTEST * _mesh_stiffness(rig, shaft), inf),
        "shaft_torsion.motor_inertia": (LIGHTEST * _inertia(rig, shaft), inf),
        "shaft_torsion.damping_ratio": (0.0, MOST_DAMPED),
    }


def _mesh_stiffness(rig: Rig, shaft: str) -> float:
    return rig.values["mean_stiffness"] * rig.values[f"base_radius_{shaft}"] ** 2


def _inertia(rig: Rig, shaft: str) -> float:
    other = SHAFTS[1 - SHAFTS.index(shaft)]
    ratio = rig.values[f"base_radius_{shaft}"] / rig.values[f"base_radius_{other}"]
    return rig.values[f"inertia_{shaft}"] + rig.values[f"inertia_{other}"] * ratio**2


def _on_the_other_shaft(options: Mapping[str, Any], values: Mapping[str, float], base: Mapping[str, float]) -> str:
    """The shaft and machine on the other side that answer to the mesh in the same way.

    A twist u about that of a steady torque follows u'' = -(1/J + 1/I) k u + r (N - N_0) / I, and pulls with
    m_e r k u / I: k (r / I)^2 and k (1/J + 1/I) are all that the teeth feel of it.
    """
    own = options["shaft"]
    other = SHAFTS[1 - SHAFTS.index(own)]
    share, wheel = share_of_shaft(own, base), {shaft: _wheel(shaft, base) for shaft in SHAFTS}
    scale = (share * base[f"base_radius_{other}"] / ((1 - share) * base[f"base_radius_{own}"])) ** 2
    machine = (1 / values["motor_inertia"] + 1 / wheel[own]) / scale - 1 / wheel[other]
    if machine <= 0:  # no machine is heavy enough
        return ""
    return (
        f"Where the torques are steady, a shaft of the {other} of {scale * values['stiffness']:.3g} N*m/rad before a "
        f"machine of {1 / machine:.3g} kg*m^2 would do the same as that of the {own} (`shaft_torsion`)."
    )


def _wheel(own: str, base: Mapping[str, Any]) -> Any:
    """Inertia of the gear on a shaft, which is scaled where an equivalent mass was given."""
    return base["equivalent_mass"] * base[f"base_radius_{own}"] ** 2 / share_of_shaft(own, base)


class ShaftTorsion(ExtraStates, LoadPath):
    """The torque acts on a motor, and reaches the pinion through a shaft; or a brake holds the gear through one.

    With the twist q of the shaft, T_s = k_s q + c_s q' in place of T1 at the pinion. The load
    F = m_e (r_b1 T1 / I1 + r_b2 T2 / I2) changes by m_e r_b1 / I1 (T_s - T1), whatever holds the gear. On the
    gear's shaft the same with 2 in place of 1; a balanced gear torque is T2 = r_b2 T1 / r_b1.
    """

    name = "shaft_torsion"
    equation = "F + m_e r_b1 (T_s - T1) / I1, T_s = k_s q + c_s q', q'' = (T1 - T_s) / J - (T_s - r_b1 N) / I1"
    reference = "Özgüven (1991), J. Sound Vib. 145(2)"
    parameters: ClassVar = (
        Parameter("stiffness", "N*m/rad", 2000.0, "k_s", 1e-3, 1e12),
        Parameter("motor_inertia", "kg*m^2", 0.01, "J, moment of inertia of the motor, or of the brake", 1e-9, 1e6),
        Parameter("damping_ratio", "1", 0.02, "zeta_s, of the machine against the gears with a rigid mesh", 0, 10),
    )
    needs: ClassVar = (Trait.SHAFTS, Trait.TEETH, Trait.TORQUE)
    options: ClassVar = (Option("shaft", SHAFTS, "pinion", "whose: a motor on the pinion's, a brake on the gear's"),)
    states: ClassVar = {"twist": "rad", "twist_rate": "rad/s"}
    cause: ClassVar = Cause(
        "the torsion of a shaft or coupling",
        _on_either_shaft,
        separated_by="bearing",
        also=_on_the_other_shaft,
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The shaft between the inertias, which are scaled where an equivalent mass was given."""
        own = self.chosen["shaft"]
        stiffness, motor, radius = values["stiffness"], values["motor_inertia"], base[f"base_radius_{own}"]
        share, wheel = share_of_shaft(own, base), _wheel(own, base)
        gears = wheel + wheel * share / (1 - share)  # the other gear as this shaft feels it
        damping = 2 * values["damping_ratio"] * torch.sqrt(stiffness / (1 / motor + 1 / gears))
        mesh_rate = base["mean_stiffness"] / base["equivalent_mass"]
        return {
            "stiffness": stiffness,
            "damping": damping,
            "motor": motor,
            "wheel": wheel,
            "radius": radius,
            "load_per_torque": share / radius,
            "per_pinion_torque": base["load_per_pinion_torque"],
            "per_gear_torque": base["load_per_gear_torque"],
            "gear_torque": base["gear_torque"],
            "balanced": (base["load_per_gear_torque"] == 0).to(radius),
            "slowest_rate": torch.sqrt(stiffness * (1 / motor + 1 / gears)),
            "fastest_rate": torch.sqrt(mesh_rate + stiffness * (1 / motor + 1 / wheel)),
        }

    @property
    def turned_shaft(self) -> str:
        """Its own."""
        return str(self.chosen["shaft"])

    def initial(self, p: Values, base: Values) -> dict[str, Tensor]:
        """Twisted by the mean torque."""
        twist = self._machine_torque(base["mean_load"], 0.0, base["gear_torque"], p) / p["stiffness"]
        return {"twist": twist, "twist_rate": torch.zeros_like(twist)}

    def transmitted_load(self, at: Kinematics, p: Values) -> Tensor:
        """The load with the shaft's torque in place of the motor's."""
        motor, shaft = self._torques(at, p)
        return at.drive_load + p["load_per_torque"] * (shaft - motor)

    def state_rates(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """The twist between the machine and its gear."""
        motor, shaft = self._torques(at, p)
        acceleration = (motor - shaft) / p["motor"] - (shaft - p["radius"] * at.mesh_force) / p["wheel"]
        return {"twist": at.extra[RATE], "twist_rate": acceleration}

    def _torques(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """Torque on the machine, from the load of the torques, and torque of the shaft."""
        gear = at.inputs.get("gear_torque", p["gear_torque"])
        motor = self._machine_torque(at.drive_load, at.unbalanced_load, gear, p)
        return motor, p["stiffness"] * at.extra[TWIST] + p["damping"] * at.extra[RATE]

    def _machine_torque(self, load: Tensor, unbalanced: Tensor | float, held: Tensor, p: Values) -> Tensor:
        """The torque of the brake: what balances the load, or what is held; or that of the motor, which is the rest.

        What is `unbalanced` in the load is the force of a torque on the pinion alone.
        """
        if self.chosen["shaft"] == "gear":
            return p["balanced"] * p["radius"] * (load - unbalanced) + (1 - p["balanced"]) * held
        both = (load - unbalanced - p["per_gear_torque"] * held) / p["per_pinion_torque"]
        return both + unbalanced / p["load_per_torque"]
