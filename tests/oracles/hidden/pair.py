"""The rig of a hidden case: teeth, inertias and what follows from them, in SI; the usual one by plain names."""

from __future__ import annotations

import math
from dataclasses import dataclass

TEETH = (20, 40)
MODULE = 3e-3  # m
PRESSURE_ANGLE = math.radians(20.0)
INERTIA = (2.6e-4, 4.5e-3)  # kg m^2
RADIUS = tuple(0.5 * MODULE * z * math.cos(PRESSURE_ANGLE) for z in TEETH)  # base circles / m
MASS = 1.0 / (RADIUS[0] ** 2 / INERTIA[0] + RADIUS[1] ** 2 / INERTIA[1])  # kg, 0.2657
BASE_PITCH = 2.0 * math.pi * RADIUS[0] / TEETH[0]  # m along the line of action
MOST_TEETH = 64


def rpm(speed: float) -> float:
    """Revolutions a minute as rad/s."""
    return speed * math.pi / 30.0


@dataclass(frozen=True)
class Rig:
    """A pair of gears on its test bench.

    inertia: kg m^2. one_pair: stiffness of one pair of teeth / (N/m). contact_ratio: its range over the cases.
    rate: Hz, of sampling. deflection: static deflections over those of the usual rig. either_shaft: whether
    faults of single teeth and ripples of high orders are drawn too.
    """

    teeth: tuple[int, int] = TEETH
    module: float = MODULE
    pressure_angle: float = PRESSURE_ANGLE
    inertia: tuple[float, float] = INERTIA
    one_pair: float = 2e8
    contact_ratio: tuple[float, float] = (1.5, 1.7)
    rate: float = 50e3
    deflection: float = 1.0
    either_shaft: bool = False

    @property
    def name(self) -> str:
        """Teeth over teeth."""
        return "{}/{}".format(*self.teeth)

    @property
    def radius(self) -> tuple[float, float]:
        """Base circles / m."""
        return tuple(0.5 * self.module * z * math.cos(self.pressure_angle) for z in self.teeth)

    @property
    def mass(self) -> float:
        """Of both inertias seen along the line of action / kg."""
        return 1.0 / (self.radius[0] ** 2 / self.inertia[0] + self.radius[1] ** 2 / self.inertia[1])

    @property
    def base_pitch(self) -> float:
        """Along the line of action / m."""
        return 2.0 * math.pi * self.radius[0] / self.teeth[0]

    @property
    def pitch_point(self) -> float:
        """Mesh periods from the meeting of a standard pair to the pitch point: path of approach / base pitch."""
        reference, tip = 0.5 * self.module * self.teeth[1], self.module * (0.5 * self.teeth[1] + 1.0)
        root = math.sqrt(tip**2 - self.radius[1] ** 2) - reference * math.sin(self.pressure_angle)
        return root / self.base_pitch

    @property
    def natural_frequency(self) -> float:
        """Hz, at a contact ratio of 1.6."""
        return math.sqrt(1.6 * self.one_pair / self.mass) / (2.0 * math.pi)

    @property
    def gears(self) -> float:
        """Inertia of both at the pinion's shaft / (kg m^2)."""
        return self.inertia[0] + self.inertia[1] * (self.radius[0] / self.radius[1]) ** 2

    def scale(self, **powers: float) -> float:
        """How much larger a quantity of these dimensions is than on the usual rig.

        force: mesh forces; length: deflections; time: natural periods; radius: of the pinion; turn: time in which
        a tooth passes at the same share of the natural frequency, per revolution.
        """
        length, time = self.deflection, USUAL.natural_frequency / self.natural_frequency
        sizes = {"length": length, "time": time, "force": length * self.one_pair / USUAL.one_pair,
                 "radius": self.radius[0] / USUAL.radius[0], "turn": time * self.teeth[0] / USUAL.teeth[0]}  # fmt: skip
        return math.prod(sizes[name] ** power for name, power in powers.items())

    def knobs(self) -> dict[str, float]:
        """What the equations of motion need to know."""
        return {
            "teeth_1": float(self.teeth[0]), "teeth_2": float(self.teeth[1]), "radius_1": self.radius[0],
            "radius_2": self.radius[1], "inertia_1": self.inertia[0], "inertia_2": self.inertia[1],
            "joint_mass": self.mass, "base_pitch": self.base_pitch, "pitch_point": self.pitch_point,
            "pressure_slope": math.tan(self.pressure_angle), "rate_scale": self.scale(length=1, time=-1),
        }  # fmt: skip


USUAL = Rig()


def pitch_point() -> float:
    """Of the usual rig."""
    return USUAL.pitch_point
