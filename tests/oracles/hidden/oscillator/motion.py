"""All members at once in fixed steps of sixth order, and how a sensor sees them at any instants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfilt, sosfilt_zi

from ..runge_kutta import NODES, step
from .inputs import Input
from .laws import YIELD_RATIOS, Params, damping, restoring

STEPS = 60  # a natural period
STEP = 2.0 * np.pi / STEPS
KNEE = 24.0  # sharpness of the amplifier's saturation


@dataclass
class Motion:
    """Natural time (n,), and displacement, rate and acceleration (3, n, member)."""

    time: np.ndarray
    state: np.ndarray


def move(p: dict[str, np.ndarray], forces: Sequence[Input], start: np.ndarray, length: float) -> Motion:
    """Motion from 0 to at least `length`. start: (2, member); forces: one a member."""
    count = int(np.ceil(length / STEP)) + 2
    time = STEP * np.arange(count)
    kept = np.empty((3, count, start.shape[1]))
    hysteretic = bool(np.any(p["hysteresis"]))
    y = np.concatenate([start, np.zeros((3, start.shape[1]))]) if hysteretic else np.array(start, dtype=float)
    table = _table(forces, time)
    slopes = np.empty((7, *y.shape))
    with np.errstate(over="ignore", invalid="ignore"):  # members that run away are the caller's affair
        for i in range(count):
            end = step(lambda node, z, i=i: rates(p, z, table[i, node]), y, STEP, slopes)
            kept[:, i] = y[0], y[1], slopes[0, 1]
            y = end
    return Motion(time, kept)


def _table(forces: Sequence[Input], time: np.ndarray) -> np.ndarray:
    """(step, node, member)"""
    at = time[:, None] + STEP * NODES
    seen: dict[int, np.ndarray] = {}
    for force in forces:
        if id(force) not in seen:
            seen[id(force)] = force(at)
    return np.stack([seen[id(force)] for force in forces], axis=-1)


def rates(p: dict[str, np.ndarray], y: np.ndarray, force: np.ndarray) -> np.ndarray:
    """u' and u'' of (2 or 5, member); the further rows are hysteretic deflections."""
    out = np.empty_like(y)
    out[0], out[1] = y[1], force - restoring(p, y[0]) - damping(p, y[0], y[1])
    if len(y) > 2:
        out[1] -= p["hysteresis"] * y[2:].mean(axis=0)
        out[2:] = y[1] - np.abs(y[1]) * y[2:] / (p["yield"] * YIELD_RATIOS)
    return out


def between(motion: Motion, member: int, t: np.ndarray, order: int) -> np.ndarray:
    """A derivative of the displacement at any instants: quintic between two steps."""
    place = np.clip(t / STEP, 0.0, motion.time.size - 1.000001)
    i = np.floor(place).astype(int)
    s = place - i
    x, v, a = motion.state[0, :, member], motion.state[1, :, member] * STEP, motion.state[2, :, member] * STEP**2
    rise, speed, bend = x[i + 1] - x[i] - v[i] - 0.5 * a[i], v[i + 1] - v[i] - a[i], a[i + 1] - a[i]
    c = [10 * rise - 4 * speed + 0.5 * bend, -15 * rise + 7 * speed - bend, 6 * rise - 3 * speed + 0.5 * bend]
    if order == 0:
        return x[i] + s * (v[i] + s * (0.5 * a[i] + s * (c[0] + s * (c[1] + s * c[2]))))
    if order == 1:
        return (v[i] + s * (a[i] + s * (3 * c[0] + s * (4 * c[1] + s * 5 * c[2])))) / STEP
    return (a[i] + s * (6 * c[0] + s * (12 * c[1] + s * 20 * c[2]))) / STEP**2


def reading(motion: Motion, p: Params, member: int, t: np.ndarray, order: int, noise: np.ndarray | float = 0.0):
    """What the sensor gives at instants t, with its own faults; `noise` comes before it saturates."""
    delay, cutoff, limit, drift = (float(p[name][member]) for name in ("delay", "lowpass", "limit", "drift"))
    if np.isfinite(cutoff):
        y = _slow(motion, member, order, cutoff)
        y = CubicSpline(motion.time, y)(t)
    else:
        y = between(motion, member, np.maximum(t - delay, 0.0), order)
        y = y + np.minimum(t - delay, 0.0) * between(motion, member, np.zeros(1), min(order + 1, 2))
    y = y + drift * t + noise
    return y / (1.0 + np.abs(y / limit) ** KNEE) ** (1.0 / KNEE) if np.isfinite(limit) else y


def _slow(motion: Motion, member: int, order: int, cutoff: float) -> np.ndarray:
    """Behind a Butterworth filter of two poles; cutoff over the natural frequency."""
    poles = butter(2, cutoff / (2.0 * np.pi), fs=1.0 / STEP, output="sos")
    y = motion.state[order, :, member]
    return sosfilt(poles, y, zi=sosfilt_zi(poles) * y[0])[0]
