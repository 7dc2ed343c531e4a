"""The gears of the second rig: discs of steel with hubs, and a stiffness that is built of single pairs of teeth."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

STEEL = 7850.0  # kg/m^3
PRESSURE_ANGLE = 20.0  # degrees
ONE_PAIR = 13.5e9  # N/m of one pair of teeth for each m of face width, about that of ISO 6336
EDGE = 0.1  # mesh periods over which a pair takes up its load
HARMONICS = 8  # of the mesh that a stiffness written as a Fourier series has
PLACES = (-1, 0, 1, 2)  # pairs that may carry, relative to the one that met last


@dataclass(frozen=True)
class Rig:
    """A pair of gears in SI.

    teeth, inertias (kg m^2): of pinion and gear. module, width: m. one_pair, two_pairs: stiffness / (N/m) while so
    many carry. damping_ratio: c / (2 sqrt(mean stiffness * mass)). law: of the stiffness, "trapezoid" or "fourier".
    """

    teeth: tuple[int, int]
    module: float
    inertias: tuple[float, float]
    contact_ratio: float
    one_pair: float
    two_pairs: float
    damping_ratio: float
    law: str = "trapezoid"

    @property
    def radii(self) -> tuple[float, float]:
        """Base circles / m."""
        return tuple(self.module * z / 2 * math.cos(math.radians(PRESSURE_ANGLE)) for z in self.teeth)

    @property
    def mass(self) -> float:
        """Of both inertias seen along the line of action / kg."""
        return 1.0 / sum(r**2 / inertia for r, inertia in zip(self.radii, self.inertias, strict=True))

    @property
    def shares(self) -> tuple[float, float]:
        """What each gear moves along the line of action for 1 m of relative motion."""
        return tuple(self.mass * r**2 / inertia for r, inertia in zip(self.radii, self.inertias, strict=True))

    @property
    def mean_stiffness(self) -> float:
        """Mean over time / (N/m): two pairs carry for contact_ratio - 1 of a mesh period."""
        return self.one_pair + (self.two_pairs - self.one_pair) * (self.contact_ratio - 1.0)

    @property
    def natural_frequency(self) -> float:
        """Undamped, at the mean stiffness / Hz."""
        return math.sqrt(self.mean_stiffness / self.mass) / (2.0 * math.pi)

    @property
    def viscous(self) -> float:
        """Damping coefficient c / (N s/m)."""
        return 2.0 * self.damping_ratio * math.sqrt(self.mean_stiffness * self.mass)

    def speed_at(self, tuning: float) -> float:
        """Speed of the pinion / rpm at which the mesh has `tuning` times the natural frequency."""
        return self.natural_frequency * 60.0 / self.teeth[0] * tuning


def steel_rig(
    teeth: tuple[int, int],
    module: float,
    width: float,
    hubs: tuple[float, float],
    damping_ratio: float,
    gain: float = 1.5,
    law: str = "trapezoid",
) -> Rig:
    """Standard gears of steel; what a drawing would state is rounded as a drawing would round it.

    module, width: m. hubs: inertia / (kg m^2) of what turns with each disc. gain: stiffness of two pairs over one.
    """  # fmt: skip
    pitch = [module * z / 2 for z in teeth]
    discs = [0.5 * STEEL * math.pi * r**4 * width for r in pitch]
    inertias = tuple(_rounded(disc + hub) for disc, hub in zip(discs, hubs, strict=True))
    one_pair = _rounded(ONE_PAIR * width)
    overlap = round(contact_ratio(pitch, module), 3)
    return Rig(teeth, module, inertias, overlap, one_pair, _rounded(gain * one_pair), damping_ratio, law)


def contact_ratio(pitch: list[float], module: float) -> float:
    """Path of contact over base pitch of gears without profile shift; pitch: radii of their pitch circles / m."""
    angle = math.radians(PRESSURE_ANGLE)
    roots = sum(math.sqrt((r + module) ** 2 - (r * math.cos(angle)) ** 2) for r in pitch)
    return (roots - sum(pitch) * math.sin(angle)) / (math.pi * module * math.cos(angle))


def smooth_step(u: np.ndarray) -> np.ndarray:
    """0 below u = 0, 1 above u = 1, one continuous derivative."""
    u = np.clip(u, 0.0, 1.0)
    return u * u * (3.0 - 2.0 * u)


def pair_stiffness(rig: Rig, place: np.ndarray) -> np.ndarray:
    """Stiffness / (N/m) of one pair of teeth at `place` mesh periods behind its meeting point.

    A pair carries half of what two pairs have while two carry, and all while it is alone.
    """

    def risen(at: float) -> np.ndarray:
        return smooth_step((place - at) / EDGE + 0.5)

    half, alone, overlap = rig.two_pairs / 2, rig.one_pair, rig.contact_ratio
    return (
        half * risen(0.0) + (alone - half) * risen(overlap - 1.0) + (half - alone) * risen(1.0) - half * risen(overlap)
    )


def mesh_stiffness(rig: Rig, phase: np.ndarray) -> np.ndarray:
    """Stiffness / (N/m) of all pairs at `phase` mesh periods; two pairs carry for 0 < phase < contact_ratio - 1."""
    if rig.law == "fourier":
        return _fourier(rig, phase)
    turn = np.mod(phase, 1.0)
    return sum(pair_stiffness(rig, turn + place) for place in PLACES)


def tooth_stiffness(rig: Rig, teeth_passed: np.ndarray, z: int, tooth: int) -> np.ndarray:
    """Stiffness / (N/m) of the pair to which one tooth of a gear with z teeth belongs; 0 while it is out of mesh."""
    return pair_stiffness(rig, np.mod(teeth_passed - tooth + 1.0, z) - 1.0)


def _fourier(rig: Rig, phase: np.ndarray) -> np.ndarray:
    """The first harmonics of the rectangle that jumps between one and two pairs."""
    stiffness = np.full_like(phase, rig.mean_stiffness)
    double = rig.contact_ratio - 1.0
    for h in range(1, HARMONICS + 1):
        size = 2.0 * (rig.two_pairs - rig.one_pair) / (h * math.pi) * math.sin(h * math.pi * double)
        stiffness += size * np.cos(2.0 * math.pi * h * (phase - double / 2))
    return stiffness


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")
