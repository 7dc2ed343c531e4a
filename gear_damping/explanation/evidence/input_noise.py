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
from scipy.interpolate import make_interp_spline

from gear_damping.explanation.evidence.noise import floor_variance
from gear_damping.identification.output_error.records import FitRecord

Array = NDArray[np.float64]
# Of a load's variance: a floor that is more of it may be the load itself. A steady torque has no content of its own.
FLOOR_SHARE, OF_A_TORQUE = 0.1, inf
ANGLE = "pinion_angle"  # an input that is no load
LINES = 5  # of the spectrum that its power is averaged over
DEGREE = 5  # of the spline between uneven samples
LEAST = 1e-6  # of a load's variance: a floor below is rounding
FEWEST_SAMPLES = 64  # of a record: fewer tell no floor of its spectrum


def without_input_noise(records: Sequence[FitRecord], is_torque: bool = False) -> tuple[FitRecord, ...] | None:
    """Records whose measured loads are freed of the noise above their content; None where none has any.

    A load that stays at each sample's value was commanded, not measured.

    Args:
        records: As they were measured.
        is_torque: Whether the loads are torques on shafts.
    """
    floor_share = OF_A_TORQUE if is_torque else FLOOR_SHARE
    cleaned = tuple(_cleaned(record, floor_share) for record in records)
    return cleaned if any(one is not record for one, record in zip(cleaned, records, strict=True)) else None


def _cleaned(record: FitRecord, floor_share: float) -> FitRecord:
    if len(record.response) < FEWEST_SAMPLES:
        return record
    found, errors = {}, {}
    for name, series in ((name, one) for name, one in record.inputs.items() if name != ANGLE):
        variance, floor = float(series.var()), floor_variance(replace(record, response=series))
        if name not in record.held and LEAST * variance < floor < floor_share * variance:
            stamps = None if record.stamps is None else record.stamps.numpy()
            found[name] = torch.as_tensor(expected_load(series.numpy(), floor, stamps))
            errors[name] = torch.as_tensor(error_of_load(series.numpy(), floor))
    if not found:
        return record
    return replace(record, inputs={**record.inputs, **found}, input_errors=errors)


def expected_load(series: Array, floor: float, stamps: Array | None = None) -> Array:
    """A load (time,) as it is to be expected where white noise of variance `floor` was measured with it.

    Args:
        series: As measured.
        floor: Variance of the noise.
        stamps: Instants in sampling intervals, where they are not evenly spaced.
    """
    if stamps is None:
        return _filtered(series, floor)
    even = np.linspace(stamps[0], stamps[-1], len(series))
    between = make_interp_spline(stamps, series, DEGREE)(even)
    return make_interp_spline(even, _filtered(between, floor), DEGREE)(stamps)


def error_of_load(series: Array, floor: float) -> Array:
    """Autocovariance (time,) of what the expected load is wrong by, in the unit of the load squared.

    At each frequency that is the noise times the share of the load that is kept. Lags that the length of the record
    does not tell fade out, so that it stays one of a stationary error (Bartlett 1950, Biometrika 37).
    """
    _, _, share = _spectrum(series, floor)
    lags = np.arange(len(series))
    return floor * np.fft.irfft(share, len(series)) * np.clip(1 - 2 * lags / len(series), 0.0, 1.0)


def _filtered(series: Array, floor: float) -> Array:
    ramp, lines, share = _spectrum(series, floor)
    return ramp + np.fft.irfft(share * lines, len(series))


def _spectrum(series: Array, floor: float) -> tuple[Array, NDArray[np.complex128], Array]:
    """The line from start to end, the spectrum beside it, and the share of the load in each of its lines."""
    ramp = np.linspace(series[0], series[-1], len(series))  # without it the jump from end to start would spread
    lines = np.fft.rfft(series - ramp)
    power = np.convolve(np.pad(np.abs(lines) ** 2, LINES // 2, mode="edge"), np.full(LINES, 1 / LINES), mode="valid")
    return ramp, lines, np.clip(1 - floor * len(series) / np.maximum(power, 1e-300), 0.0, 1.0)
