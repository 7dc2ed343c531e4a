"""Step 2: how much of a record is noise, from the record itself by two estimators."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gear_damping.identification.output_error.problem import FitRecord
from gear_damping.measurement.record import Channel

BANDS = ((0.6, 0.78), (0.78, 0.96))  # of the usable band; above the signal, below the anti-alias corner
AGREEMENT = 1.2  # estimates farther apart than this are said, and widen the threshold
CUT = 5.0  # times the floor: a line above it is signal
BELOW_CUT = 1 - CUT * np.exp(-CUT) / (1 - np.exp(-CUT))  # mean of an exponential distribution below the cut
ALIKE = 3.5  # standard errors within which records have one noise
DEGREES = 2 / 1.94  # of freedom of a periodogram line: under a Hann window neighbours hang together
WEIGHTS = (0.2, 5.0)


@dataclass(frozen=True)
class Scatter:
    """What else chance adds to a mean squared residual, in noise variances: its mean and its deviation."""

    expected: float = 0.0
    deviation: float = 0.0


@dataclass(frozen=True)
class NoiseLevel:
    """Standard deviation of the sensor noise of each record.

    Args:
        by_record: In the unit of the records, by record name.
        method: How it was found.
        degrees_of_freedom: Of the estimate of the variance.
        agree: Whether the estimates are within 20 % of each other.
        correlation: Sum of its squared autocorrelations: samples for one that is independent.
        scatter: What errors of the calibration add on held-out records.
    """

    by_record: dict[str, float]
    method: str
    degrees_of_freedom: float
    agree: bool
    correlation: float = 1.0
    scatter: Scatter = Scatter()

    @property
    def value(self) -> float:
        """Root mean square over the records."""
        return float(np.mean(np.square(list(self.by_record.values())))) ** 0.5


def noise_level(records: Sequence[FitRecord], channel: Channel) -> NoiseLevel:
    """The declared noise, or the floor of the spectrum in two bands above the signal.

    Where the bands differ the lower one counts; records that do not differ share one level.
    """
    nyquist = records[0].sampling_rate / 2
    usable = min(nyquist, channel.lowpass or nyquist)
    correlation = nyquist / usable
    if channel.noise is not None:
        return NoiseLevel({record.name: channel.noise for record in records}, "declared", 1e9, True, correlation)
    found = {r.name: [_floor(r, low * usable, high * usable) for low, high in BANDS] for r in records}
    levels, agree = {}, True
    for name, bands in found.items():
        variances, lines = np.array(bands).T
        apart = variances.max() > AGREEMENT**2 * max(variances.min(), 1e-300)
        agree &= not apart
        levels[name] = variances.min() if apart else float((variances * lines).sum() / max(lines.sum(), 1))
    degrees = {name: DEGREES * sum(lines for _, lines in bands) for name, bands in found.items()}
    said = "spectral floor above the signal"
    pooled = _pooled(levels, degrees)
    if pooled is not None:
        shared, freedom = dict.fromkeys(levels, pooled**0.5), sum(degrees.values())
        return NoiseLevel(shared, f"{said}, of all records", freedom, agree, correlation)
    own = {name: variance**0.5 for name, variance in levels.items()}
    return NoiseLevel(own, said, min(degrees.values()), agree, correlation)


def _pooled(levels: dict[str, float], degrees: dict[str, float]) -> float | None:
    """The one variance of all records; None where they differ by more than chance."""
    variance, freedom = np.array([levels[n] for n in levels]), np.array([degrees[n] for n in levels])
    mean = float((variance * freedom).sum() / max(freedom.sum(), 1e-300))
    error = (2 / np.maximum(freedom, 1)) ** 0.5
    return mean if (np.abs(variance / max(mean, 1e-300) - 1) < ALIKE * error).all() else None


def weighted(records: Sequence[FitRecord], noise: NoiseLevel) -> tuple[FitRecord, ...]:
    """Records that count by their noise, within a range that no estimate of the noise can overturn."""
    typical = max(noise.value, 1e-300)
    low, high = WEIGHTS
    return tuple(
        replace(r, weight=min(max(typical / max(noise.by_record[r.name], 1e-300), low), high)) for r in records
    )


def _floor(record: FitRecord, low: float, high: float) -> tuple[float, int]:
    """Variance of white noise with the level of a band beside its lines of signal, and the number of its lines."""
    values = record.response.numpy()
    window = np.hanning(len(values))
    power = np.abs(np.fft.rfft((values - values.mean()) * window)) ** 2 / (window**2).sum()
    frequency = np.fft.rfftfreq(len(values), 1 / record.sampling_rate)
    band = power[(frequency >= low) & (frequency <= high)]
    if not len(band):
        return 0.0, 0
    level = float(np.median(band) / np.log(2))
    for _ in range(2):
        below = band[band <= CUT * level]
        level = float(below.mean() / BELOW_CUT) if len(below) else level
    return level, len(band)
