"""A spur gear pair in its dynamic transmission error, x = r_b1 theta_1 - r_b2 theta_2.

Özgüven & Houser (1988), J. Sound Vib. 121(3); Kahraman & Singh (1990), J. Sound Vib. 142(1).
"""

from collections.abc import Mapping
from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.kinematics import Kinematics, Rotation
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.scales import Scales
from gear_damping.physics.systems.base import System, Values
from gear_damping.physics.systems.traits import Trait

PRINTED_BASE_CIRCLES = (0.05, 0.11)  # m; the paper's Table 1, truncated base diameters
PRINTED_MASS = 1.0  # kg; the paper's equation 8 has no mass
UNLOADED_LENGTH = 1e-6  # m; the unit of length of a member that carries no load


def teeth_of(values: Mapping[str, float]) -> tuple[float, float]:
    """Teeth of pinion and gear as stated by flat name, or as usual."""
    pinion, gear = (values.get(p.name, p.default) for p in GearPair.parameters[:2])
    return pinion, gear


class GearPair(System):
    """The base of a gear pair; its mesh stiffness and damping are effects."""

    name = "gear_pair"
    response = "transmission_error"
    responses: ClassVar = ("transmission_error", "acceleration", "gear_speed", "pinion_speed")
    traits: ClassVar = frozenset({Trait.SHAFTS, Trait.TEETH, Trait.TORQUE, Trait.PRELOAD, Trait.MASS})
    gains: ClassVar = {"pinion_torque": "torque_gain"}
    parameters: ClassVar = (
        Parameter("n_teeth_pinion", "1", 20, "teeth of the pinion", 5, 500, "paper", whole=True),
        Parameter("n_teeth_gear", "1", 40, "teeth of the gear", 5, 1000, "paper", whole=True),
        Parameter("module", "m", 3e-3, "module", 1e-4, 0.1, "paper"),
        Parameter("pressure_angle", "rad", pi / 9, "pressure angle", 0.1, 0.7, "paper"),
        Parameter("inertia_pinion", "kg*m^2", 2.6e-4, "moment of inertia of the pinion", 1e-9, 1e4, "paper"),
        Parameter("inertia_gear", "kg*m^2", 4.5e-3, "moment of inertia of the gear", 1e-9, 1e5, "paper"),
        Parameter("equivalent_mass", "kg", 0.0, "replaces the inertias where positive", 0, 1e5),
        Parameter("pinion_torque", "N*m", 150.0, "mean torque on the pinion", -1e6, 1e6, "paper"),
        Parameter("torque_gain", "1", 1.0, "true pinion torque over the stated one", -1e3, 1e3),
        Parameter("torque_offset", "N*m", 0.0, "true pinion torque beside that", -1e6, 1e6),
        Parameter("gear_torque", "N*m", 0.0, "torque on the gear, where it is `held`", -1e6, 1e6),
        Parameter("pinion_speed", "rad/s", 4600 * pi / 30, "speed of the pinion, at the start", -1e4, 1e4),
        Parameter("pinion_acceleration", "rad/s^2", 0.0, "rate of the pinion's speed at the start", -1e8, 1e8),
        Parameter("pinion_jerk", "rad/s^3", 0.0, "rate of its acceleration", -1e12, 1e12),
        Parameter("pinion_angle", "rad", 0.0, "pinion angle at the start"),
        Parameter("angle_error", "rad", 0.0, "true pinion angle less the recorded or stated one, at the start"),
        Parameter("angle_error_rate", "rad/s", 0.0, "its rate", -1e4, 1e4),
        Parameter("mesh_phase", "rad", 0.0, "mesh angle at pinion angle zero"),
        Parameter("contact_advance", "1", 0.0, "share of x by which the teeth in mesh have gone on", -2, 2),
        Parameter("gear_phase", "rad", 0.0, "gear angle at pinion angle zero"),
        Parameter("initial_displacement", "m", 0.0, "transmission error at the start"),
        Parameter("initial_velocity", "m/s", 0.0, "its rate at the start"),
    )
    options: ClassVar = (
        Option("gear_torque_mode", ("balanced", "held"), "balanced", "what the gear does when T1 varies"),
        Option("as_printed", (False, True), False, "mass 1 kg and the paper's base circles"),
    )
    inputs: ClassVar = {"pinion_torque": "N*m", "gear_torque": "N*m", "pinion_angle": "rad"}
    derived_units: ClassVar = {
        "base_radius_pinion": "m",
        "base_radius_gear": "m",
        "equivalent_mass": "kg",
        "mean_stiffness": "N/m",
        "natural_frequency": "1/s",
        "load_per_pinion_torque": "1/m",
        "load_per_gear_torque": "1/m",
        "mean_load": "N",
    }

    def derived(self, values: Values, mean_stiffness: Tensor | None) -> dict[str, Tensor]:
        """Base radii, equivalent mass, natural frequency and load, in SI."""
        v = values
        radius_1, radius_2 = self._base_radii(v)
        inertia_1, inertia_2 = v["inertia_pinion"], v["inertia_gear"]
        drawn = inertia_1 * inertia_2 / (inertia_1 * radius_2**2 + inertia_2 * radius_1**2)
        mass = torch.where(v["equivalent_mass"] > 0, v["equivalent_mass"], drawn)
        if self.chosen["as_printed"]:
            mass = torch.full_like(mass, PRINTED_MASS)
        if self.chosen["gear_torque_mode"] == "balanced":
            per_pinion, per_gear = 1 / radius_1, torch.zeros_like(radius_1)
        else:
            # a stated mass scales both inertias, which leaves the load as it is
            per_pinion, per_gear = drawn * radius_1 / inertia_1, drawn * radius_2 / inertia_2
        return {
            "base_radius_pinion": radius_1,
            "base_radius_gear": radius_2,
            "equivalent_mass": mass,
            "mean_stiffness": mean_stiffness,
            "natural_frequency": torch.sqrt(mean_stiffness / mass),
            "load_per_pinion_torque": per_pinion,
            "load_per_gear_torque": per_gear,
            "mean_load": per_pinion * true_torque(v["pinion_torque"], v) + per_gear * v["gear_torque"],
        }

    def _base_radii(self, v: Values) -> tuple[Tensor, Tensor]:
        if self.chosen["as_printed"]:
            one = torch.ones_like(v["module"])
            return one * PRINTED_BASE_CIRCLES[0] / 2, one * PRINTED_BASE_CIRCLES[1] / 2
        per_tooth = v["module"] * torch.cos(v["pressure_angle"]) / 2
        return per_tooth * v["n_teeth_pinion"], per_tooth * v["n_teeth_gear"]

    def scales(self, derived: Values) -> Scales:
        """Equivalent mass, static deflection and 1/omega_n."""
        static = (derived["mean_load"] / derived["mean_stiffness"]).abs()
        length = torch.where(static > 0, static, torch.full_like(static, UNLOADED_LENGTH))
        return Scales(derived["equivalent_mass"], length, 1 / derived["natural_frequency"])

    def load(self, at: Kinematics, p: Values) -> Tensor:
        """F = m_e (r_b1 T1 / I1 + r_b2 T2 / I2), which is T1 / r_b1 when the torques balance."""
        return self._load(at.inputs, p)

    @staticmethod
    def _load(inputs: Values, p: Values) -> Tensor:
        pinion = true_torque(inputs.get("pinion_torque", p["pinion_torque"]), p)
        gear = inputs.get("gear_torque", p["gear_torque"])
        return p["load_per_pinion_torque"] * pinion + p["load_per_gear_torque"] * gear

    def rotations(self, time: Tensor, inputs: Values, p: Values, displacement: Tensor) -> dict[str, Rotation]:
        """The shafts and the mesh at this time; a measured pinion angle replaces the stated speed.

        Which teeth carry goes with the mean rotation, and with a share of x beside it: m_e / (I_1 / r_b1^2) where the
        pinion's own angle says it, as in models of both rotations, -m_e / (I_2 / r_b2^2) where the gear's does. A
        measured angle is one under load: what that deflects it by is in it, and the rest of x alone goes beside it.
        """
        if "pinion_angle" in inputs:
            angle, speed = inputs["pinion_angle"], inputs["pinion_angle_rate"]
            displacement = displacement - self._load(inputs, p) / p["mean_stiffness"]
        else:
            angle, speed = turned(p, time)
        angle, speed = angle + p["angle_error"] + time * p["angle_error_rate"], speed + p["angle_error_rate"]
        ratio = p["n_teeth_pinion"] / p["n_teeth_gear"]
        ahead = p["contact_advance"] * displacement / p["base_radius_pinion"]
        return {
            "pinion": Rotation(angle, speed),
            "gear": Rotation(ratio * angle + p["gear_phase"], ratio * speed),
            "mesh": Rotation(p["n_teeth_pinion"] * (angle + ahead) + p["mesh_phase"], p["n_teeth_pinion"] * speed),
        }

    def begun_later(self, values: Values, seconds: Tensor) -> dict[str, Tensor]:
        """Where the shaft is by then, and how fast it turns."""
        angle, speed = turned(values, seconds)
        faster = values["pinion_acceleration"] + seconds * values["pinion_jerk"]
        later = values["angle_error"] + seconds * values["angle_error_rate"]
        return {"pinion_angle": angle, "pinion_speed": speed, "pinion_acceleration": faster, "angle_error": later}


def turned(p: Values, time: Tensor) -> tuple[Tensor, Tensor]:
    """Angle and speed of the pinion at a time, from what is stated of them at the start."""
    first, second = p["pinion_acceleration"], p["pinion_jerk"]
    speed = p["pinion_speed"] + time * (first + time * second / 2)
    return p["pinion_angle"] + time * (p["pinion_speed"] + time * (first / 2 + time * second / 6)), speed


def true_torque(read: Tensor, values: Values) -> Tensor:
    """The torque on the pinion from the one that was read."""
    return values["torque_gain"] * read + values["torque_offset"]
