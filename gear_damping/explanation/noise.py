"""Step 2: how much of a record is noise, from the record itself by two estimators."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gear_damping.identification.output_error.problem import FitRecord
from gear_damping.measurement.record import Channel

BANDS = ((0.6, 0.78), (0.78, 0.96))  # of the usable band; above the signal, below the anti-alias corner
AGREEMENT = 1.2  # estimates farther apart than this are said, and widen the threshold
DEGREES = 2.0  # of freedom of a periodogram line


@dataclass(frozen=True)
class NoiseLevel:
    """Standard deviation of the sensor noise of one channel.

    Args:
        value: In the unit of the records.
        method: How it was found.
        estimates: The single estimates.
        degrees_of_freedom: Of the estimate of its square.
        agree: Whether the estimates are within 20 % of each other.
    """

    value: float
    method: str
    estimates: tuple[float, ...]
    degrees_of_freedom: float
    agree: bool


def noise_level(records: Sequence[FitRecord], channel: Channel) -> NoiseLevel:
    """The declared noise, or the floor of the spectrum in two bands above the signal; the lower one counts."""
    if channel.noise is not None:
        return NoiseLevel(channel.noise, "declared", (channel.noise,), 1e9, True)
    nyquist = records[0].sampling_rate / 2
    usable = min(nyquist, channel.lowpass or nyquist)
    estimates, lines = [], 0
    for low, high in BANDS:
        found = [_floor(record, low * usable, high * usable) for record in records]
        estimates.append(float(np.mean([variance for variance, _ in found])) ** 0.5)
        lines = max(lines, sum(count for _, count in found))
    low, high = min(estimates), max(estimates)
    agree = high <= AGREEMENT * max(low, 1e-300)
    return NoiseLevel(low, "spectral floor above the signal", tuple(estimates), DEGREES * lines / 2, agree)


def _floor(record: FitRecord, low: float, high: float) -> tuple[float, int]:
    """Variance of white noise with the median level of a band, and the number of lines in it."""
    values = record.response.numpy()
    window = np.hanning(len(values))
    power = np.abs(np.fft.rfft((values - values.mean()) * window)) ** 2 / (window**2).sum()
    frequency = np.fft.rfftfreq(len(values), 1 / record.sampling_rate)
    band = power[(frequency >= low) & (frequency <= high)]
    return float(np.median(band) / np.log(2)) if len(band) else 0.0, len(band)
