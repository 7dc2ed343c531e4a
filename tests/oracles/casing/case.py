"""Cases by seed: a rig, a path, a sensor and a tacho, with or without a cracked tooth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .mesh import Array, Gears
from .motion import mesh_force
from .path import Mode, heard, noise, sampled

RATE = 100e3  # Hz of the integration
SETTLING = 0.05  # s left out at the start
MODULE, PRESSURE_ANGLE = 3e-3, np.radians(20)
TEETH = ((17, 20, 25, 37), (43, 53))


@dataclass(frozen=True)
class CasingCase:
    """What was recorded, and the truth.

    Args:
        hidden: `healthy`, `pinion` or `gear`: whose tooth is cracked.
        gears: The pair.
        rate: Hz of the record.
        acceleration: (n,) m/s^2.
        pulses: Times of the tacho's pulses / s, counted from the first sample.
        per_turn: Pulses in one turn.
        speed: Mean speed of the pinion / rad/s.
    """

    hidden: str
    gears: Gears
    rate: float
    acceleration: Array
    pulses: Array
    per_turn: int
    speed: float


def draw_case(
    seed: int, hidden: str, teeth: tuple[int, int] | None = None, seconds: float | None = None, run: int = 0
) -> CasingCase:
    """The case of a seed; teeth and length are drawn where they are not given.

    Another `run` has the same gears, path and mean speed, but its own fluctuation, noise and start.
    """
    rng = np.random.default_rng([seed, 4711])
    teeth = teeth or (int(rng.choice(TEETH[0])), int(rng.integers(TEETH[1][0], TEETH[1][1] + 1)))
    gears = _gears(rng, teeth, hidden)
    rpm, length = rng.uniform(600, 3000), float(rng.uniform(1, 3))
    length = seconds or length
    modes = tuple(
        Mode(float(np.exp(rng.uniform(np.log(500), np.log(8000)))), float(rng.uniform(0.01, 0.05)), float(rng.normal()))
        for _ in range(rng.integers(2, 7))
    )
    factor, level = int(rng.choice([2, 4, 5])), 10 ** (-rng.uniform(10, 30) / 20)
    colour, per_turn = float(rng.choice([0.0, 0.6, 0.9])), int(rng.choice([1, 2, 6, 12, 24, 60]))
    rng = np.random.default_rng([seed, 4711, run])  # from here on what differs from run to run
    count = round((length + SETTLING) * RATE)
    time = np.arange(2 * count + 1) / (2 * RATE)
    turn = _angle(rng, rpm / 60, time) / (2 * np.pi)
    load = gears.load * (1 + 0.01 * np.sin(2 * np.pi * rng.uniform(0.2, 2) * time + rng.uniform(0, 6)))
    force = mesh_force(gears, turn, load, 1 / RATE) * (100 / gears.load)  # a casing shakes with some m/s^2
    clean = sampled(heard(force, modes, RATE)[round(SETTLING * RATE) :], factor)
    values = clean + level * clean.std() * noise(rng, len(clean), colour)
    pulses = _pulses(rng, time, turn, per_turn)
    ends = (-0.5 / per_turn / (rpm / 60), len(values) / (RATE / factor) + 0.5 / per_turn / (rpm / 60))
    pulses = pulses[(pulses > ends[0]) & (pulses < ends[1])]
    return CasingCase(hidden, gears, RATE / factor, values, pulses, per_turn, rpm * np.pi / 30)


def _gears(rng: np.random.Generator, teeth: tuple[int, int], hidden: str) -> Gears:
    """Errors of ordinary gears; a crack takes a third to two thirds of a tooth's stiffness."""
    radius = [0.5 * MODULE * z * np.cos(PRESSURE_ANGLE) for z in teeth]
    stiffness = 3e8 * rng.uniform(0.8, 1.2)
    crack = float(rng.uniform(0.3, 0.6))
    shaft = 1 if hidden == "gear" else 0
    quality = rng.uniform(0.1, 0.5) * 1e-6  # m, standard deviation of the single pitch
    return Gears(
        teeth=teeth,
        mass=0.27 * (teeth[0] / 20) ** 2 * rng.uniform(0.7, 1.3),
        damping_ratio=float(rng.uniform(0.02, 0.08)),
        pair_stiffness=stiffness,
        contact_ratio=float(rng.uniform(1.4, 1.8)),
        edge=float(rng.uniform(0.1, 0.3)),
        load=float(rng.uniform(100, 200) / radius[0] * teeth[0] / 20),
        pitch=(quality * rng.normal(size=teeth[0]), quality * rng.normal(size=teeth[1])),
        profile=np.array([1.0, 0.5, 0.2]) * rng.uniform(0, 2e-6) * rng.normal(size=3),
        runout=tuple((float(rng.uniform(2e-6, 1e-5)), float(rng.uniform(0, 6.28))) for _ in range(2)),
        first=int(rng.integers(teeth[1])),
        crack=0.0 if hidden == "healthy" else crack,
        cracked=(shaft, int(rng.integers(teeth[shaft]))),
    )


def _angle(rng: np.random.Generator, frequency: float, time: Array) -> Array:
    """rad: a mean speed with a slow fluctuation of up to 2 %."""
    size, slow = rng.uniform(0.002, 0.02) * rng.dirichlet(np.ones(3)), rng.uniform(0.2, 2.0, 3)
    angle = 2 * np.pi * frequency * time + rng.uniform(0, 6.28)
    for share, rate in zip(size, slow, strict=True):
        angle += frequency * share / rate * np.sin(2 * np.pi * rate * time + rng.uniform(0, 6.28))
    return angle


def _pulses(rng: np.random.Generator, time: Array, turn: Array, per_turn: int) -> Array:
    """Times of the pulses counted from the first kept sample, with a jitter of some microseconds."""
    numbers = np.arange(np.ceil(turn[0] * per_turn), np.floor(turn[-1] * per_turn) + 1)
    found = np.interp(numbers / per_turn, turn, time)
    return found + rng.uniform(0.5e-6, 4e-6) * rng.normal(size=len(found)) - SETTLING
