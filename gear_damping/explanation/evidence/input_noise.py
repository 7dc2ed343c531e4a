"""A measured load without the noise of its own sensor.

A simulation that is driven by a noisy load moves with that noise, and its fit then leans towards it (errors in
variables: Fuller 1987). Taking the load by its expectation given what was measured, the Wiener filter, leaves an error
that is independent of what drives the simulation (regression calibration: Carroll & Stefanski 1990).
"""

from collections.abc import Sequence
from dataclasses import replace
from math import inf

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.stats import chi2

from gear_damping.explanation.evidence.noise import floor_variance
from gear_damping.identification.output_error.records import FitRecord

Array = NDArray[np.float64]
# Of a load's variance: a floor that is more of it may be the load itself. A steady torque has no content of its own.
FLOOR_SHARE, OF_A_TORQUE = 0.1, inf
ANGLE = "pinion_angle"  # an input that is no load
LINES = 5  # of the spectrum that its power is averaged over
WIDER, SCALES = 4, 6  # the content of a torque may be so many times as wide, so often: a weak one shows over many lines
JUMP = 4.0  # standard deviations of noise, which it makes of end and start once in 16 000 records
LEAST = 1e-6  # of a load's variance: a floor below is rounding
FEWEST_SAMPLES = 64  # of a record: fewer tell no floor of its spectrum


def without_input_noise(records: Sequence[FitRecord], is_torque: bool = False) -> tuple[FitRecord, ...] | None:
    """Records whose measured loads are freed of the noise above their content; None where none has any.

    A load that stays at each sample's value was commanded, not measured.

    Args:
        records: As they were measured.
        is_torque: Whether the loads are torques on shafts.
    """
    cleaned = tuple(_cleaned(record, is_torque) for record in records)
    return cleaned if any(one is not record for one, record in zip(cleaned, records, strict=True)) else None


def _cleaned(record: FitRecord, is_torque: bool) -> FitRecord:
    if len(record.response) < FEWEST_SAMPLES:
        return record
    found, errors = {}, {}
    floor_share = OF_A_TORQUE if is_torque else FLOOR_SHARE
    for name, series in ((name, one) for name, one in record.inputs.items() if name != ANGLE):
        variance, floor = float(series.var()), floor_variance(replace(record, response=series))
        if name not in record.held and LEAST * variance < floor < floor_share * variance:
            found[name] = torch.as_tensor(expected_load(series.numpy(), floor, is_torque))
            errors[name] = torch.as_tensor(error_of_load(series.numpy(), floor, is_torque))
    if not found:
        return record
    return replace(record, inputs={**record.inputs, **found}, input_errors=errors)


def expected_load(series: Array, floor: float, is_torque: bool = False) -> Array:
    """A load (time,) as it is to be expected where white noise of variance `floor` was measured with it.

    Args:
        series: As measured, at even instants.
        floor: Variance of the noise.
        is_torque: Whether it is a torque on a shaft, which has no content in most lines of its spectrum.
    """
    ramp, lines, share = _spectrum(series, floor, is_torque)
    return ramp + np.fft.irfft(share * lines, len(series))


def error_of_load(series: Array, floor: float, is_torque: bool = False) -> Array:
    """Autocovariance (time,) of what the expected load is wrong by, in the unit of the load squared.

    At each frequency that is the noise times the share of the load that is kept. Lags that the length of the record
    does not tell fade out, so that it stays one of a stationary error (Bartlett 1950, Biometrika 37).
    """
    _, _, share = _spectrum(series, floor, is_torque)
    lags = np.arange(len(series))
    return floor * np.fft.irfft(share, len(series)) * np.clip(1 - 2 * lags / len(series), 0.0, 1.0)


def _spectrum(series: Array, floor: float, is_torque: bool) -> tuple[Array, NDArray[np.complex128], Array]:
    """The line from start to end, the spectrum beside it, and the share of the load in each of its lines."""
    ramp = np.linspace(series[0], series[-1], len(series))  # without it the jump from end to start would spread
    if is_torque and abs(series[-1] - series[0]) < JUMP * (2 * floor) ** 0.5:
        ramp = np.full(len(series), np.mean(series))
    lines = np.fft.rfft(series - ramp)
    share_of = _share_beyond_chance if is_torque else _share_of_lines
    return ramp, lines, share_of(np.abs(lines) ** 2 / (floor * len(series)))


def _share_of_lines(power: Array) -> Array:
    """The share of a load in each line of a spectrum, of which every neighbourhood may hold some.

    Args:
        power: Of the lines, over that of the noise.
    """
    near = np.convolve(np.pad(power, LINES // 2, mode="edge"), np.full(LINES, 1 / LINES), mode="valid")
    return np.clip(1 - 1 / np.maximum(near, 1e-300), 0.0, 1.0)


def _share_beyond_chance(power: Array) -> Array:
    """The same of a load that has no content in most of its lines: none where noise alone would hold as much.

    What lies above the floor by chance would drive a resonance as a load does. A neighbourhood counts where its mean is
    above what noise reaches in one line of the record (chi square, of two degrees of freedom a line), a wider one by
    what the narrower ones leave.
    """
    share, left = np.zeros(len(power)), power
    for width in (LINES * WIDER**scale for scale in range(SCALES)):
        if width > len(power):
            break
        mean = uniform_filter1d(left, width, mode="nearest")
        holds = (mean > chi2.isf(1 / len(power), 2 * width) / (2 * width)) & (share == 0.0)
        share[holds] = 1 - 1 / mean[holds]
        left = np.where(share > 0.0, 1.0, left)
    return share
