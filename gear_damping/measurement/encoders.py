"""Shaft angles from encoders and tachos, and the transmission error from two encoders."""

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.splines import monotone_spline

TURN = 2 * np.pi  # rad
FEWEST_PULSES = 2  # in a record
COUNTERS = (16, 24, 32)  # bits
FROM_ENCODERS = "transmission_error: r_b1 theta_1 - r_b2 theta_2 from the encoders, without its mean"  # a note


def angle_from_counts(counts: NDArray[np.float64], per_revolution: float, direction: int = 1) -> NDArray[np.float64]:
    """(n,) rad from counts per sample; a counter may begin again after each revolution, or at the end of its range."""
    span = float(np.ptp(counts))
    for bits in COUNTERS:
        if span < 2**bits and np.any(np.abs(np.diff(counts)) > 2 ** (bits - 1)):
            counts, span = np.unwrap(counts, period=2**bits), np.inf
            break
    angle = TURN * counts / per_revolution
    return direction * (np.unwrap(angle) if span < per_revolution else angle)


def angle_from_pulses(
    pulses: NDArray[np.float64],
    time: NDArray[np.float64],
    per_revolution: float,
    direction: int,
    key: str,
    source: str,
) -> NDArray[np.float64]:
    """(n,) rad at `time` from the times of equally spaced pulses, monotone between them.

    Args:
        pulses: (m,) the times in s; the first is angle zero.
        time: (n,) the record's times in s.
        per_revolution: Pulses in one turn.
        direction: 1 or -1.
        key: What the pulses are called in messages.
        source: The file that they come from.

    Raises:
        InputError: fewer than two pulses, pulses that go back in time, or a record that begins
            or ends more than one pulse outside them.
    """
    if pulses.size < 2:
        rule = f"{pulses.size} pulse(s) found, at least 2 are needed"
        raise InputError(Problem(key, rule, remedy="check the threshold and the column", source=source))
    steps = np.diff(pulses)
    if np.any(steps <= 0):
        where = int(np.flatnonzero(steps <= 0)[0]) + 1
        rule = f"pulse {where} does not come after the one before"
        raise InputError(Problem(key, rule, remedy="sort the pulses, remove repeated ones", source=source))
    before, after = pulses[0] - time[0], time[-1] - pulses[-1]
    if before > 1.5 * steps[0] or after > 1.5 * steps[-1]:
        rule = f"pulses from {pulses[0]:.6g} to {pulses[-1]:.6g} s do not cover the record"
        rule += f" ({time[0]:.6g} to {time[-1]:.6g} s)"
        raise InputError(Problem(key, rule, remedy="shorten the record with slice", source=source))
    if np.sum((pulses >= time[0]) & (pulses <= time[-1])) < FEWEST_PULSES:
        rule = f"pulses from {pulses[0]:.6g} to {pulses[-1]:.6g} s, and fewer than {FEWEST_PULSES} of them in the"
        rule += f" record ({time[0]:.6g} to {time[-1]:.6g} s)"
        raise InputError(Problem(key, rule, remedy="check the unit of the pulses and the clock", source=source))
    angle = TURN * np.arange(pulses.size) / per_revolution
    return direction * _extended(pulses, angle, time)


def _extended(pulses: NDArray, angle: NDArray, time: NDArray) -> NDArray[np.float64]:
    """Interpolated between the pulses and straight on beyond the first and last."""
    inner = monotone_spline(pulses, angle)(np.clip(time, pulses[0], pulses[-1]))
    slope_first = (angle[1] - angle[0]) / (pulses[1] - pulses[0])
    slope_last = (angle[-1] - angle[-2]) / (pulses[-1] - pulses[-2])
    beyond = np.minimum(time - pulses[0], 0) * slope_first + np.maximum(time - pulses[-1], 0) * slope_last
    return inner + beyond


def rising_edges(signal: NDArray[np.float64], time: NDArray[np.float64], threshold: float) -> NDArray[np.float64]:
    """(m,) the times in s at which a pulse train rises through `threshold`, between samples too."""
    last = np.flatnonzero((signal[:-1] < threshold) & (signal[1:] >= threshold))
    share = (threshold - signal[last]) / (signal[last + 1] - signal[last])
    return time[last] + share * (time[last + 1] - time[last])


def transmission_error(
    pinion: NDArray[np.float64], gear: NDArray[np.float64], radius_pinion: float, radius_gear: float
) -> NDArray[np.float64]:
    """(n,) m: x = r_b1 theta_1 - r_b2 theta_2 along the line of action, without its arbitrary mean."""
    error = radius_pinion * pinion - radius_gear * gear
    return error - error.mean()


def mean_rotation(
    pinion: NDArray[np.float64],
    error: NDArray[np.float64],
    radii: tuple[float, float],
    inertias: tuple[float, float],
) -> NDArray[np.float64]:
    """(n,) rad: the pinion's angle without its share of the transmission error (n,), theta_1 - r_b1 m x / I_1.

    Gear models with one degree of freedom, this package's among them, count the mesh phase along the mean rotation;
    the angle as measured would add the vibration to it once more, some 0.1 % of the response.
    """
    arms = inertias[0] * radii[1] ** 2 + inertias[1] * radii[0] ** 2
    return pinion - radii[0] * inertias[1] / arms * error


def base_radius(n_teeth: float, module: float, pressure_angle: float) -> float:
    """m: half of n_teeth * module * cos(pressure_angle)."""
    return n_teeth * module * float(np.cos(pressure_angle)) / 2
