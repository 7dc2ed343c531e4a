"""What sensors make of the motion of the second rig, and their noise."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter, lsim

from .motion import Motion, Run, simulate
from .pair import Rig

FACTORS = {"m": 1.0, "mm": 1e3, "um": 1e6, "rad/s": 1.0, "rpm": 30 / math.pi, "m/s^2": 1.0, "g": 1 / 9.80665}
COLOUR = 0.9  # correlation of successive samples of noise of first order
RUN_IN = 200  # samples of it that are thrown away
FINER = 8  # samples of the motion for each one that a resonant mount passes on


@dataclass(frozen=True)
class Sensor:
    """One channel.

    channel: as the declaration names it. unit: of the file. shaft: whose. radius: of an accelerometer on the disc
    / m, stated in radius_unit. said: what else the declaration says of it. whole: whether a speed comes with its mean.
    mount: frequency / Hz and damping ratio of the mount of an accelerometer that is not as stiff as it should be.
    """

    channel: str
    unit: str
    shaft: str = "pinion"
    radius: float | None = None
    radius_unit: str = "mm"
    said: tuple[tuple[str, str], ...] = ()
    whole: bool = False
    mount: tuple[float, float] | None = None

    def factor(self, rig: Rig) -> float:
        """From relative motion, or its derivative, to the unit of the file."""
        if self.channel == "transmission_error":
            return FACTORS[self.unit]
        place = ("pinion", "gear").index(self.shaft)
        turned = (1, -1)[place] * rig.shares[place] / rig.radii[place]
        return turned * (self.radius or 1.0) * FACTORS[self.unit]

    def fluctuation(self, rig: Rig, motion: Motion) -> np.ndarray:
        """What the motion shows here, without the mean of a speed, in the unit of the file."""
        path = {"transmission_error": motion.x, "acceleration": motion.a}.get(self.channel, motion.v)
        return path * self.factor(rig)

    def mean(self, rig: Rig, motion: Motion) -> np.ndarray | float:
        """What a speed has beside its fluctuation, in the unit of the file."""
        if not self.whole:
            return 0.0
        turned = 1.0 if self.shaft == "pinion" else rig.radii[0] / rig.radii[1]
        return motion.speed * turned * FACTORS[self.unit]


@dataclass(frozen=True)
class Noise:
    """kind: "white", "pink" or "coloured" (of first order). snr_db: over all records together."""

    kind: str
    snr_db: float

    def std(self, clean: list[np.ndarray]) -> float:
        """For these records, in their unit."""
        return math.sqrt(np.mean([values.var() for values in clean])) * 10 ** (-self.snr_db / 20)

    def drawn(self, rng: np.random.Generator, n: int, std: float) -> np.ndarray:
        """The noise of n samples."""
        if self.kind == "pink":
            spectrum = np.fft.rfft(rng.normal(size=n))
            frequency = np.arange(spectrum.size)
            frequency[0] = 1
            pink = np.fft.irfft(spectrum / np.sqrt(frequency), n)
            return std * pink / pink.std()
        if self.kind == "coloured":
            white = rng.normal(size=n + RUN_IN)
            return std * math.sqrt(1 - COLOUR**2) * lfilter([1], [1, -COLOUR], white)[RUN_IN:]
        return std * rng.normal(size=n)


def shaken(sensor: Sensor, rig: Rig, run: Run) -> np.ndarray:
    """The fluctuation through a resonant mount: w^2 / (s^2 + 2 z w s + w^2) times the acceleration."""
    motion = simulate(rig, replace(run, rate=run.rate * FINER))
    true = sensor.fluctuation(rig, motion)
    frequency, damping = sensor.mount
    w = 2 * math.pi * frequency
    passed = lsim(([w * w], [1, 2 * damping * w, w * w]), true - true[0], motion.t - motion.t[0])[1]
    return passed[::FINER] + true[0]
