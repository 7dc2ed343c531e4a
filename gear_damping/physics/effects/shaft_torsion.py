"""Torsion of the shaft or coupling between motor and pinion."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.moment import Moment
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import ExtraStates, LoadPath, Values

TWIST, RATE = "shaft_torsion.twist", "shaft_torsion.twist_rate"


class ShaftTorsion(ExtraStates, LoadPath):
    """The torque acts on a motor, and reaches the pinion through a shaft.

    With the twist q of the shaft, T_s = k_s q + c_s q' in place of T1 at the pinion. The load
    F = m_e (r_b1 T1 / I1 + r_b2 T2 / I2) changes by m_e r_b1 / I1 (T_s - T1), whatever holds the gear.
    """

    name = "shaft_torsion"
    equation = "F + m_e r_b1 (T_s - T1) / I1, T_s = k_s q + c_s q', q'' = (T1 - T_s) / J - (T_s - r_b1 N) / I1"
    reference = "Özgüven (1991), J. Sound Vib. 145(2)"
    parameters: ClassVar = (
        Parameter("stiffness", "N*m/rad", 2000.0, "k_s", 1e-3, 1e12),
        Parameter("motor_inertia", "kg*m^2", 0.01, "J, moment of inertia of the motor", 1e-9, 1e6),
        Parameter("damping_ratio", "1", 0.02, "zeta_s, of the motor against the gears with a rigid mesh", 0, 10),
    )
    systems: ClassVar = ("gear_pair",)
    states: ClassVar = {"twist": "rad", "twist_rate": "rad/s"}
    cause: ClassVar = Cause(
        "the torsion of a shaft or coupling",
        tuple(
            Recipe({"stiffness": k}, presence=True, scanned={"motor_inertia": j, "damping_ratio": 0.02}, in_si=True)
            for k in (3e3, 1e4, 3e4, 1e5)
            for j in (4e-3, 1.5e-2)
        ),
        separated_by="bearing",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The shaft between the inertias, which are scaled where an equivalent mass was given."""
        stiffness, motor, radius = values["stiffness"], values["motor_inertia"], base["base_radius_pinion"]
        pinion_part = radius**2 / base["inertia_pinion"]
        gear_part = base["base_radius_gear"] ** 2 / base["inertia_gear"]
        share = pinion_part / (pinion_part + gear_part)
        pinion = base["equivalent_mass"] * radius**2 / share
        gears = pinion + pinion * pinion_part / gear_part  # the gear as the pinion's shaft feels it
        damping = 2 * values["damping_ratio"] * torch.sqrt(stiffness / (1 / motor + 1 / gears))
        mesh_rate = base["mean_stiffness"] / base["equivalent_mass"]
        return {
            "stiffness": stiffness,
            "damping": damping,
            "motor": motor,
            "pinion": pinion,
            "radius": radius,
            "load_per_torque": share / radius,
            "per_pinion_torque": base["load_per_pinion_torque"],
            "per_gear_torque": base["load_per_gear_torque"],
            "gear_torque": base["gear_torque"],
            "slowest_rate": torch.sqrt(stiffness * (1 / motor + 1 / gears)),
            "fastest_rate": torch.sqrt(mesh_rate + stiffness * (1 / motor + 1 / pinion)),
        }

    def initial(self, p: Values, base: Values) -> dict[str, Tensor]:
        """Twisted by the mean torque."""
        twist = base["pinion_torque"] / p["stiffness"]
        return {"twist": twist, "twist_rate": torch.zeros_like(twist)}

    def transmitted_load(self, now: Moment, p: Values) -> Tensor:
        """The load with the shaft's torque in place of the motor's."""
        motor, shaft = self._torques(now, p)
        return now.drive_load + p["load_per_torque"] * (shaft - motor)

    def state_rates(self, now: Moment, p: Values) -> dict[str, Tensor]:
        """The twist between motor and pinion."""
        motor, shaft = self._torques(now, p)
        acceleration = (motor - shaft) / p["motor"] - (shaft - p["radius"] * now.mesh_force) / p["pinion"]
        return {"twist": now.extra[RATE], "twist_rate": acceleration}

    def _torques(self, now: Moment, p: Values) -> tuple[Tensor, Tensor]:
        """Torque on the motor, from the load of the torques, and torque of the shaft."""
        gear = now.inputs.get("gear_torque", p["gear_torque"])
        motor = (now.drive_load - p["per_gear_torque"] * gear) / p["per_pinion_torque"]
        return motor, p["stiffness"] * now.extra[TWIST] + p["damping"] * now.extra[RATE]
