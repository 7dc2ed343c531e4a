"""The instruments of a measurement: which channels there are, in which units, and how each sees the motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from .pair import Rig

FACTORS = {
    "m": 1.0, "mm": 1e3, "um": 1e6, "N*m": 1.0, "rad": 1.0, "deg": 180.0 / math.pi, "rad/s": 1.0,
    "rpm": 30.0 / math.pi, "m/s^2": 1.0, "mm/s^2": 1e3, "gn": 1.0 / 9.80665,
}  # fmt: skip
UNITS = {
    "transmission_error": ("um", "mm", "m"), "pinion_torque": ("N*m",), "gear_torque": ("N*m",),
    "pinion_angle": ("rad", "deg"), "pinion_speed": ("rpm", "rad/s"), "gear_speed": ("rpm", "rad/s"),
    "acceleration": ("m/s^2", "gn", "mm/s^2"),
}  # fmt: skip
ORDERS = {"transmission_error": 0, "pinion_speed": 1, "gear_speed": 1, "acceleration": 2}
# plans of sensors; what is not said is as in `full`
PLANS: dict[str, dict[str, object]] = {
    "full": {},
    "mean_free": {"datum": "arbitrary"},
    "ac": {"coupled": True, "datum": "arbitrary"},
    "encoders": {"counts": True, "datum": "arbitrary", "angle": False},
    "pinion_speed": {"response": "pinion_speed", "angle": False},
    "gear_speed": {"response": "gear_speed"},
    "acceleration": {"response": "acceleration"},
    "speed_condition": {"angle": False, "speed": "known"},
    "speed_uncertain": {"angle": False, "speed": "uncertain"},
    "torque_gain": {"torque": "gain"},
    "torque_condition": {"torque": "condition"},
    "inertia_wrong": {"inertia": 1.1},
    "coloured_noise": {"colour": 0.9},
    "coarse_angle": {"angle_step": 2.0 * math.pi / 4096.0, "colour": 0.0},
    "noisy_torque": {"torque_noise": 0.1, "colour": 0.0},
}  # fmt: skip
ASKED_FOR = ("inertia_wrong", "coloured_noise", "coarse_angle", "noisy_torque")  # by name alone
FREE = tuple(name for name in PLANS if name not in ASKED_FOR)  # that leave the truth to be found
MOVES_THE_SHAFTS = ("bearing_flexibility", "shaft_torsion", "unbalance", "encoder_error")
SPEED_UNCERTAINTY = 0.005


@dataclass(frozen=True)
class Setup:
    """Sensors and units.

    response: the channel that shows the motion; `counts` of two encoders per turn instead of it. datum: absolute or
    arbitrary. corner: Hz, of a first-order high-pass. shaft, radius / m: of an accelerometer. angle: whether there
    is a channel of it. speed: None, or what a condition says of it: known | uncertain. torque: channel | gain |
    condition. torque_gain, torque_offset / N m: true torque = gain * read + offset. inertia: stated over true.
    colour: correlation of the noise from sample to sample. angle_step: rad, of the encoder. torque_noise: white
    noise of the measured torque, as a share of its deviation.
    """

    name: str = "full"
    response: str = "transmission_error"
    datum: str = "absolute"
    corner: float | None = None
    counts: tuple[int, int] | None = None
    shaft: str = "pinion"
    radius: float = 0.0
    angle: bool = True
    speed: str | None = None
    torque: str = "channel"
    torque_gain: float = 1.0
    torque_offset: float = 0.0
    inertia: float = 1.0
    colour: float = 0.0
    angle_step: float = 0.0
    torque_noise: float = 0.0
    units: dict[str, str] = field(default_factory=lambda: {name: units[0] for name, units in UNITS.items()} | {
        "pinion_angle": "rad", "pinion_speed": "rad/s"})  # fmt: skip

    @property
    def order(self) -> int:
        """How many times the motion is differentiated."""
        return ORDERS[self.response]

    def factor(self, rig: Rig) -> float:
        """Reading in SI per derivative of the deflection: how either shaft shares in the motion."""
        if self.order == 0:
            return 1.0
        shaft = self.response.removesuffix("_speed") if self.order == 1 else self.shaft
        index = 0 if shaft == "pinion" else 1
        angle = (1.0, -1.0)[index] * rig.radius[index] * rig.mass / rig.inertia[index]
        return angle * (self.radius if self.order == 2 else 1.0)

    def reading(self, rig: Rig) -> float:
        """A typical reading per deflection."""
        return abs(self.factor(rig)) * (2.0 * math.pi * rig.natural_frequency) ** self.order


def setup_of(wanted: str | Setup | None, rig: Rig, effects: Sequence[str], rng: np.random.Generator) -> Setup:
    """Today's sensors where None; a plan by name; `drawn`: one that can show the effects."""
    if wanted is None or isinstance(wanted, Setup):
        return wanted or Setup()
    if wanted == "drawn":
        wanted = str(rng.choice([name for name in FREE if can_show(name, effects)]))
    if wanted not in PLANS:
        raise ValueError(f"no sensors {wanted!r}; choose one of drawn, {', '.join(PLANS)}")
    given = dict(PLANS[wanted])
    units = {name: str(rng.choice(choices)) for name, choices in UNITS.items()}
    shaft, inner = int(rng.integers(2)), rng.uniform(0.5, 0.9)
    drawn = Setup(
        wanted, colour=float(rng.choice([0.0, 0.0, 0.3, 0.6])), units=units, shaft=("pinion", "gear")[shaft],
        radius=round(0.5 * rig.module * rig.teeth[shaft] * inner, 4),
    )  # fmt: skip
    corner, count = float(rng.uniform(0.002, 0.008)) * rig.natural_frequency, 2 ** int(rng.integers(19, 22))
    gain, offset = 1.0 + float(rng.choice([-1.0, 1.0])) * rng.uniform(0.05, 0.15), float(rng.uniform(-0.02, 0.02))
    if given.pop("coupled", False):
        given["corner"] = round(corner, 2)
    if given.pop("counts", False):
        given["counts"] = (count, count)
    if given.get("torque") == "gain":
        given["torque_gain"] = round(float(gain), 3)
        given["torque_offset"] = float(f"{offset * 150.0 * rig.scale(force=1, radius=1):.3g}")
    return replace(drawn, **given)


def can_show(name: str, effects: Sequence[str]) -> bool:
    """Whether the sensors of a plan, and what is known of the shafts' motion, suit the effects."""
    plan = PLANS[name]
    if plan.get("response", "transmission_error") != "transmission_error":
        return not {*effects} & {*MOVES_THE_SHAFTS, "sensor_offset", "shaft_angle_error", "tooth_friction"}
    if plan.get("datum") and {*effects} & {"sensor_offset", "encoder_error"}:
        return False
    return plan.get("angle", True) or "shaft_angle_error" not in effects
