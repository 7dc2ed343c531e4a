"""From the mesh force to the accelerometer: a sum of modes, and the noise of the sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import decimate, lfilter

Array = np.ndarray


@dataclass(frozen=True)
class Mode:
    """A mode of the casing: frequency / Hz, damping ratio, acceleration per force."""

    frequency: float
    damping_ratio: float
    size: float


def heard(force: Array, modes: tuple[Mode, ...], rate: float) -> Array:
    """Acceleration / (m/s^2) at the sensor, by the bilinear transform with each mode's frequency kept."""
    found = np.zeros_like(force)
    for mode in modes:
        omega = 2 * np.pi * mode.frequency
        warp = omega / np.tan(omega / (2 * rate))
        b = np.array([1.0, -2.0, 1.0]) * warp**2
        a0 = warp**2 + 2 * mode.damping_ratio * omega * warp + omega**2
        a2 = warp**2 - 2 * mode.damping_ratio * omega * warp + omega**2
        a = np.array([1.0, 2 * (omega**2 - warp**2) / a0, a2 / a0])
        found += mode.size * lfilter(b / a0, a, force)
    return found


def sampled(values: Array, factor: int) -> Array:
    """Every `factor`-th value behind an anti-alias filter."""
    return decimate(values, factor, ftype="fir", zero_phase=True) if factor > 1 else values


def noise(rng: np.random.Generator, count: int, colour: float) -> Array:
    """Unit variance; white for colour 0, else of a first-order filter with that memory."""
    white = rng.normal(size=count + 500)
    return (lfilter([np.sqrt(1 - colour**2)], [1.0, -colour], white))[500:]
