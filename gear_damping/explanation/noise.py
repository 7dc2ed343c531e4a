"""Step 2: how much of a record is noise, from the record itself by two estimators."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gear_damping.identification.output_error.problem import FitRecord
from gear_damping.measurement.record import Channel

BANDS = ((0.6, 0.78), (0.78, 0.96))  # of the usable band; above the signal, below the anti-alias corner
AGREEMENT = 1.2  # estimates farther apart than this are said, and widen the threshold
DEGREES = 2.0  # of freedom of a periodogram line
WEIGHTS = (0.2, 5.0)


@dataclass(frozen=True)
class NoiseLevel:
    """Standard deviation of the sensor noise of each record.

    Args:
        by_record: In the unit of the records, by record name.
        method: How it was found.
        degrees_of_freedom: Of the estimate of one record's variance.
        agree: Whether the estimates are within 20 % of each other.
    """

    by_record: dict[str, float]
    method: str
    degrees_of_freedom: float
    agree: bool

    @property
    def value(self) -> float:
        """Root mean square over the records."""
        return float(np.mean(np.square(list(self.by_record.values())))) ** 0.5


def noise_level(records: Sequence[FitRecord], channel: Channel) -> NoiseLevel:
    """The declared noise, or the floor of the spectrum in two bands above the signal; the lower one counts."""
    if channel.noise is not None:
        return NoiseLevel({record.name: channel.noise for record in records}, "declared", 1e9, True)
    nyquist = records[0].sampling_rate / 2
    usable = min(nyquist, channel.lowpass or nyquist)
    found = {r.name: [_floor(r, low * usable, high * usable) for low, high in BANDS] for r in records}
    levels = {name: min(variance for variance, _ in bands) ** 0.5 for name, bands in found.items()}
    agree = all(
        max(v for v, _ in bands) <= AGREEMENT**2 * max(min(v for v, _ in bands), 1e-300) for bands in found.values()
    )
    lines = min(count for bands in found.values() for _, count in bands)
    return NoiseLevel(levels, "spectral floor above the signal", DEGREES * lines / 2, agree)


def weighted(records: Sequence[FitRecord], noise: NoiseLevel) -> tuple[FitRecord, ...]:
    """Records that count by their noise, within a range that no estimate of the noise can overturn."""
    typical = max(noise.value, 1e-300)
    low, high = WEIGHTS
    return tuple(
        replace(r, weight=min(max(typical / max(noise.by_record[r.name], 1e-300), low), high)) for r in records
    )


def _floor(record: FitRecord, low: float, high: float) -> tuple[float, int]:
    """Variance of white noise with the median level of a band, and the number of lines in it."""
    values = record.response.numpy()
    window = np.hanning(len(values))
    power = np.abs(np.fft.rfft((values - values.mean()) * window)) ** 2 / (window**2).sum()
    frequency = np.fft.rfftfreq(len(values), 1 / record.sampling_rate)
    band = power[(frequency >= low) & (frequency <= high)]
    return float(np.median(band) / np.log(2)) if len(band) else 0.0, len(band)
