"""The signal cut into mesh cycles, and the parts of it that repeat with the mesh, the pinion and the gear.

Cycle n begins where the pinion has turned n / z1 times; from there on it is sampled in time, because what rings in a
casing rings in time, however the speed varies. Each sample of a cycle, over the cycles, is then

    slow part of the mesh + pattern of z1 pinion teeth + pattern of z2 gear teeth + what is not synchronous,

one linear regression with the same regressors for all samples. It separates the two shafts exactly, also where a
record holds few turns of the gear; the slow part follows the speed, with which a path makes every mesh line vary.
"""

from dataclasses import dataclass
from math import gcd

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter

from gear_damping.explanation.casing.heard import Heard

Array = NDArray[np.float64]
SHAFTS = ("pinion", "gear")
SPEED_POWERS = 3  # of the slow part: a mesh line that crosses a resonance is bent
SLOWEST = 0.5  # of the slower shaft's order: below, a variation is no pattern of teeth
MEMORY = 1e-3  # s of the prediction filter: it shortens the ringing of the path
RIDGE = 1e-3  # of the power: bands that a filter has emptied are not raised above it


@dataclass(frozen=True, eq=False)
class Patterns:
    """What repeats.

    Args:
        teeth: Of pinion and gear.
        first: Number of the first cycle, counted from the zero of the angle.
        cut: (cycles, t) the signal cycle by cycle.
        mesh: (t,) the mean mesh cycle.
        pinion: (z1 // 2, t) complex: pattern of the pinion's teeth by tooth frequency 1 … z1 // 2.
        gear: (z2 // 2, t) the same of the gear.
        asynchronous: (cycles, t) what is not synchronous.
        rate: Samples per second within a cycle.
    """

    teeth: tuple[int, int]
    first: int
    cut: Array
    mesh: Array
    pinion: NDArray[np.complex128]
    gear: NDArray[np.complex128]
    asynchronous: Array
    rate: float

    @property
    def cycles(self) -> int:
        """How many mesh cycles were used."""
        return len(self.cut)

    @property
    def number(self) -> NDArray[np.int_]:
        """(cycles,) number of each cycle."""
        return self.first + np.arange(self.cycles)

    def shaft(self, name: str) -> NDArray[np.complex128]:
        """The pattern of one shaft."""
        return self.pinion if name == "pinion" else self.gear

    def without_mesh(self) -> Array:
        """(cycles, t) all but the mesh and its slow variation."""
        own = [series(self.shaft(s), z)[self.number % z] for s, z in zip(SHAFTS, self.teeth, strict=True)]
        return self.asynchronous + sum(own)


def patterns(heard: Heard, whiten: bool = True) -> Patterns:
    """The repeating parts of a record.

    Args:
        heard: The record.
        whiten: Shorten the ringing of the path first, by a linear prediction of what is not mesh.
    """
    cut, speed, samples = _cut(heard, heard.values)
    first = int(np.ceil(heard.turn[0] * heard.teeth[0]))
    design = Design.of(heard.teeth, speed, first)
    if whiten:
        slow = design.slow @ np.linalg.lstsq(design.slow, cut, rcond=None)[0]
        cut, _, _ = _cut(heard, whitened(heard.values, (cut - slow).ravel(), heard.rate))
    found = design.solve(cut)
    rate = samples * heard.speed * heard.teeth[0]
    return Patterns(heard.teeth, first, cut, cut.mean(0), found["pinion"], found["gear"], found["asynchronous"], rate)


def _cut(heard: Heard, values: Array) -> tuple[Array, Array, int]:
    """(cycle, sample) values, the relative speed (cycle,) of each cycle, samples in a cycle."""
    time = np.arange(len(values)) / heard.rate
    teeth = heard.teeth[0]
    first, last = np.ceil(heard.turn[0] * teeth), np.floor(heard.turn[-1] * teeth)
    starts = np.interp(np.arange(first, last + 1) / teeth, heard.turn, time)
    period = 1 / (heard.speed * teeth)
    starts = starts[starts + period * 1.05 < time[-1]]
    samples = max(round(period * heard.rate), 8)
    places = starts[:, None] + np.arange(samples) * (period / samples)
    speed = period / np.gradient(starts) - 1
    return _between(values, places * heard.rate), speed, samples


def _between(values: Array, place: Array) -> Array:
    """Values between samples by cubic convolution."""
    whole = np.clip(np.floor(place).astype(int), 1, len(values) - 3)
    u = place - whole
    before, here, after, beyond = (values[whole + k] for k in (-1, 0, 1, 2))
    return here + 0.5 * u * (
        after - before + u * (2 * before - 5 * here + 4 * after - beyond + u * (3 * (here - after) + beyond - before))
    )


def whitened(values: Array, like: Array, rate: float) -> Array:
    """Values through the prediction-error filter of `like`, which has the same rate."""
    order = max(8, round(MEMORY * rate))
    spectrum = np.abs(np.fft.rfft(like, 2 * len(like))) ** 2
    covariance = np.fft.irfft(spectrum)[: order + 1]
    covariance[0] *= 1 + RIDGE
    weights = solve_toeplitz(covariance[:-1], covariance[1:])
    return lfilter(np.concatenate([[1.0], -weights]), [1.0], values)


@dataclass(frozen=True, eq=False)
class Design:
    """The regressors: slow part of the mesh, tooth frequencies of the pinion, those of the gear alone."""

    slow: Array
    pinion: Array
    gear: Array
    gear_alone: NDArray[np.int_]
    teeth: tuple[int, int]

    @classmethod
    def of(cls, teeth: tuple[int, int], speed: Array, first: int) -> "Design":
        """For cycles of these relative speeds, numbered from `first`."""
        count = len(speed)
        number = first + np.arange(count)
        slowest = SLOWEST / max(teeth)  # cycles^-1
        waves = np.cos(np.pi * np.outer(np.arange(count) + 0.5, np.arange(int(2 * slowest * count) + 1)) / count)
        scaled = speed / max(np.abs(speed).max(), 1e-12)
        slow = np.column_stack([waves, *(scaled**power for power in range(1, SPEED_POWERS + 1))])
        common = teeth[1] // gcd(*teeth)  # every so many tooth frequencies of the gear are also the pinion's
        alone = np.array([j for j in range(1, teeth[1] // 2 + 1) if j % common], dtype=int)
        pinion = _waves(number, np.arange(1, teeth[0] // 2 + 1), teeth[0])
        return cls(slow, pinion, _waves(number, alone, teeth[1]), alone, teeth)

    def solve(self, cut: Array) -> dict[str, Array]:
        """Complex patterns by tooth frequency and the rest; cycles at the ends count less."""
        every = np.column_stack([self.slow, self.pinion, self.gear])
        weight = np.sin(np.pi * (np.arange(len(cut)) + 0.5) / len(cut))[:, None]
        fitted = np.linalg.lstsq(every * weight, cut * weight, rcond=1e-8)[0]
        a, b = self.slow.shape[1], self.slow.shape[1] + self.pinion.shape[1]
        gear = np.zeros((self.teeth[1] // 2, cut.shape[1]), complex)
        if len(self.gear_alone):
            gear[self.gear_alone - 1] = _complex(fitted[b:], self.gear_alone, self.teeth[1])
        pinion = _complex(fitted[a:b], np.arange(1, self.teeth[0] // 2 + 1), self.teeth[0])
        return {"pinion": pinion, "gear": gear, "asynchronous": cut - every @ fitted}


def _waves(number: NDArray, frequencies: NDArray, teeth: int) -> Array:
    """Cosines, then the sines that are not zero."""
    angle = 2 * np.pi * np.outer(number, frequencies) / teeth
    sines = np.sin(angle)[:, 2 * frequencies != teeth]
    return np.column_stack([np.cos(angle), sines])


def _complex(fitted: Array, frequencies: NDArray, teeth: int) -> NDArray[np.complex128]:
    """Coefficients c of Re(c exp(i 2 pi h n / z))."""
    count = len(frequencies)
    found = fitted[:count].astype(complex)
    found[2 * frequencies != teeth] -= 1j * fitted[count:]
    return found


def series(pattern: NDArray[np.complex128], teeth: int, least: int = 1) -> Array:
    """(teeth, t) a pattern tooth by tooth, from tooth frequency `least` on."""
    full = np.zeros((teeth // 2 + 1, pattern.shape[1]), complex)
    full[least:] = pattern[least - 1 :] * (teeth / 2)
    if teeth % 2 == 0:
        full[-1] *= 2
    return np.fft.irfft(full, teeth, axis=0)
