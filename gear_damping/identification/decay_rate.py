"""The rate at which the logarithm of an amplitude falls, with an interval that knows how straight the fall is."""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from gear_damping.identification.damping_estimate import DampingEstimate

Array = NDArray[np.float64]

BLOCKS = 8  # left out one at a time
LEVEL = 0.95  # probability that an interval states, as is usual


@dataclass(frozen=True)
class DecayRate:
    """A rate in 1/s with its standard error and the degrees of freedom of that."""

    value: float
    error: float
    freedom: int


def decay_rate(time: Array, log_amplitude: Array, deviation: Array) -> DecayRate:
    """The slope of a weighted line, negated; its error by leaving out one block after another (Quenouille & Tukey).

    Neighbouring amplitudes share their noise, and the fall need not be straight: both spread the slopes of blocks.

    Args:
        time: (n,) in s.
        log_amplitude: (n,).
        deviation: (n,) standard deviations of the logarithm, up to a factor.
    """
    weights = 1 / deviation**2
    blocks = np.array_split(np.arange(time.size), min(BLOCKS, time.size // 2))
    whole = -_slope(time, log_amplitude, weights)
    others = []
    for block in blocks:
        kept = np.ones(time.size, dtype=bool)
        kept[block] = False
        others.append(-_slope(time[kept], log_amplitude[kept], weights[kept]))
    return DecayRate(whole, jackknife_error(np.array(others)), len(blocks) - 1)


def jackknife_error(others: Array) -> float:
    """Standard error of a figure, from what it is without each of n parts of the data, (n,)."""
    return float(np.sqrt((others.size - 1) * others.var()))


def half_width(error: float, freedom: int) -> float:
    """Half of the interval of a figure whose standard error has so many degrees of freedom."""
    return float(student.ppf((1 + LEVEL) / 2, freedom)) * error


def _slope(time: Array, values: Array, weights: Array) -> float:
    about = time - weights @ time / weights.sum()
    return float((weights * about) @ values / ((weights * about) @ about))


def estimate_of(rate: DecayRate, frequency_hz: float, amplitudes: tuple[float, float]) -> DampingEstimate:
    """The damping ratio of a vibration of a damped frequency whose amplitude falls at a rate."""
    half = half_width(rate.error, rate.freedom)
    values = ratio_percent(np.array([rate.value, rate.value - half, rate.value + half]), frequency_hz)
    return DampingEstimate(float(values[0]), (float(values[1]), float(values[2])), frequency_hz, amplitudes)


def ratio_percent(rate: Array, frequency_hz: float | Array) -> Array:
    """Damping ratio in % of critical of amplitudes that fall at a rate (1/s) at a damped frequency."""
    return 100 * rate / np.sqrt(rate**2 + (2 * pi * frequency_hz) ** 2)
