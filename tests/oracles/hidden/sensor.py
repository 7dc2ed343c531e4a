"""What the instruments make of the motion: encoders, gain, filters, delay, rounding; noise comes last."""

from __future__ import annotations

import numpy as np
from scipy.signal import bilinear, butter, lfilter, lfilter_zi, sosfilt, sosfilt_zi

from .excitation import measured_torques, turning
from .integrate import Trajectory
from .knobs import any_on
from .stiffness import Arrays

FINER = 8  # times the sampling rate at which the low-pass runs
KNEE = 24.0  # sharpness of the amplifier's saturation


def between(path: Trajectory, member: int, t: np.ndarray, order: int = 0) -> np.ndarray:
    """x / m, or a derivative, of a member at times within its path: quintic through x, x', x'' of both neighbours."""
    h = path.time[1] - path.time[0]
    place = np.clip((t - path.time[0]) / h, 0.0, path.time.size - 1.000001)
    first = np.floor(place).astype(int)
    u = place - first
    x, v, a = path.x[:, member], path.v[:, member] * h, path.a[:, member] * h * h
    (x0, v0, a0), (x1, v1, a1) = ((x[i], v[i], a[i]) for i in (first, first + 1))
    rise, speed, bend = x1 - x0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0
    c3, c4, c5 = 10 * rise - 4 * speed + 0.5 * bend, -15 * rise + 7 * speed - bend, 6 * rise - 3 * speed + 0.5 * bend
    if order == 1:
        return (v0 + u * (a0 + u * (3 * c3 + u * (4 * c4 + u * 5 * c5)))) / h
    if order == 2:
        return (a0 + u * (6 * c3 + u * (12 * c4 + u * 20 * c5))) / h**2
    return x0 + u * (v0 + u * (0.5 * a0 + u * (c3 + u * (c4 + u * c5))))


def transmission_error(knobs: Arrays, path: Trajectory, noise: np.ndarray | float = 0.0) -> np.ndarray:
    """The channel / m from t = 0 on, (n, member); `noise` is added before saturation and rounding."""
    return response(knobs, path, noise)


def response(
    knobs: Arrays,
    path: Trajectory,
    noise: np.ndarray | float = 0.0,
    order: int = 0,
    factor: float = 1.0,
    corner: float | None = None,
) -> np.ndarray:
    """A channel that sees `factor` times a derivative of x, behind a high-pass where it has a corner / Hz."""
    begin = int(np.sum(path.time < -1e-12))
    t = path.time[begin:, None]
    y = (path.x, path.v, path.a)[order][begin:].copy()
    late = np.flatnonzero((knobs["delay"] != 0.0) | np.isfinite(knobs["lowpass"]))
    for member in late:
        y[:, member] = _slow_sensor(path, member, begin, knobs["delay"][member], knobs["lowpass"][member], order)
    y *= factor
    at = turning(knobs, t, wobble=False)
    if order == 0 and any_on(knobs, "encoder_1", "encoder_2"):
        y = y + knobs["radius_1"] * knobs["encoder_1"] * np.cos(at.pinion + knobs["encoder_1_phase"])
        y = y - knobs["radius_2"] * knobs["encoder_2"] * np.cos(at.gear + knobs["encoder_2_phase"])
    y = y * knobs["gain"] + knobs["offset"] + knobs["drift"] * t
    if any_on(knobs, "mains"):
        turn = 100.0 * np.pi * t + knobs["mains_phase"]
        y = y + knobs["mains"] * (np.cos(turn) + 0.4 * np.cos(3.0 * turn))
    if corner is not None:
        y = coupled(y, corner, 1.0 / (path.time[1] - path.time[0]))
    return _digitised(knobs, y + noise)


def coupled(y: np.ndarray, corner: float, rate: float) -> np.ndarray:
    """y (n, ...) behind a first-order high-pass that had settled on its mean."""
    numerator, denominator = bilinear([1.0, 0.0], [1.0, 2.0 * np.pi * corner], fs=rate)
    start = np.multiply.outer(lfilter_zi(numerator, denominator), y.mean(axis=0))
    return lfilter(numerator, denominator, y, axis=0, zi=start)[0]


def coloured(white: np.ndarray, correlation: float) -> np.ndarray:
    """Unit noise (n, member) whose neighbours are so correlated, from white unit noise."""
    if correlation == 0.0:
        return white
    level = np.sqrt(1.0 - correlation**2)
    return lfilter([level], [1.0, -correlation], white, axis=0, zi=correlation * white[:1])[0]


def _slow_sensor(path: Trajectory, member: int, begin: int, delay: float, cutoff: float, order: int) -> np.ndarray:
    if not np.isfinite(cutoff):
        return between(path, member, path.time[begin:] - delay, order)
    h = (path.time[1] - path.time[0]) / FINER
    fine = between(path, member, path.time[0] + h * np.arange((path.time.size - 1) * FINER + 1) - delay, order)
    filtered_by = butter(2, cutoff, fs=1.0 / h, output="sos")
    return sosfilt(filtered_by, fine, zi=sosfilt_zi(filtered_by) * fine[0])[0][begin * FINER :: FINER]


def _digitised(knobs: Arrays, y: np.ndarray) -> np.ndarray:
    if any_on(knobs, "limit"):
        y = y / (1.0 + np.abs(y / knobs["limit"]) ** KNEE) ** (1.0 / KNEE)
    if any_on(knobs, "step"):
        size = np.where(knobs["step"] > 0.0, knobs["step"], 1.0)
        y = np.where(knobs["step"] > 0.0, size * np.floor(y / size + 0.5), y)
    return y


def others(knobs: Arrays, path: Trajectory) -> dict[str, np.ndarray]:
    """The channels beside the transmission error from t = 0 on, (n, member) in SI."""
    t = path.time[path.time > -1e-12][:, None]
    angle = turning(knobs, t, wobble=False).pinion
    torque, gear_torque = measured_torques(knobs, t)
    angle = angle + knobs["angle_error"] * np.cos(angle + knobs["angle_error_phase"])
    return {"pinion_torque": torque, "gear_torque": gear_torque, "pinion_angle": angle}
