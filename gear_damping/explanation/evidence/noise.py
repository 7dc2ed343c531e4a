"""Step 2: how much of a record is noise, from the record itself by two estimators."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from torch import Tensor

from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.measurement.record import Channel, Measurement
from gear_damping.measurement.resolution import step_of

DECLARED = "declared"  # how a noise was found that the file states for every record
BANDS = ((0.6, 0.78), (0.78, 0.96))  # of the usable band; above the signal, below the anti-alias corner
AGREEMENT = 1.2  # estimates farther apart than this are said, and widen the threshold
CUT = 5.0  # times the floor: a line above it is signal
BELOW_CUT = 1 - CUT * np.exp(-CUT) / (1 - np.exp(-CUT))  # mean of an exponential distribution below the cut
ALIKE = 3.5  # standard errors within which records have one noise
DEGREES = 2 / 1.94  # of freedom of a periodogram line: under a Hann window neighbours hang together
WEIGHTS = (0.2, 5.0)  # of a record against the others: a noisier one counts less, none alone


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
        scatter: What errors of the calibration add to residuals of records that were not fitted.
        channels: The first channel of each record, where they differ; its noise is in the unit of that.
    """

    by_record: dict[str, float]
    method: str
    degrees_of_freedom: float
    agree: bool
    correlation: float = 1.0
    scatter: Scatter = Scatter()
    channels: Mapping[str, str] = field(default_factory=dict)

    @property
    def value(self) -> float:
        """Root mean square over the records that have the channel of the first one."""
        return self.typical(next(iter(self.by_record)))

    def typical(self, record: str) -> float:
        """Root mean square over the records that have the channel of this one."""
        own = self.channels.get(record)
        alike = [level for name, level in self.by_record.items() if self.channels.get(name) == own]
        return float(np.mean(np.square(alike))) ** 0.5

    def elsewhere(self, floor: "NoiseLevel", own: float) -> float:
        """The level of a record that was not fitted, of which the floor of its spectrum is known.

        What looks random and is more than the floors of the fitted records, as noise of another colour is, goes with
        these where that makes the records more alike; else it is as large everywhere, as what a load makes.
        """
        if self.by_record == floor.by_record:
            return own
        floors, levels = (
            np.maximum([one.by_record[name] for name in floor.by_record], 1e-300) for one in (floor, self)
        )
        shares = levels / floors
        goes_with_floors = shares.max() / shares.min() < levels.max() / levels.min()
        return max(own, self.value, own * float(np.median(shares)) if goes_with_floors else 0.0)


def noise_level(records: Sequence[FitRecord], channels: Mapping[str, Channel]) -> NoiseLevel:
    """What each record declares of its noise, or the floor of its spectrum in two bands above the signal.

    Where the bands differ the lower one counts; records that do not differ share one level. A channel that was
    recorded in steps has at least the noise of their rounding.

    Args:
        records: Of one channel, which is their first.
        channels: The channel as it was declared, by record.
    """
    usable = {r.name: min(r.sampling_rate / 2, channels[r.name].lowpass or r.sampling_rate / 2) for r in records}
    correlation = max(r.sampling_rate / 2 / usable[r.name] for r in records)
    declared = {r.name: channels[r.name].noise for r in records if channels[r.name].noise is not None}
    if len(declared) == len(records):
        return NoiseLevel(declared, DECLARED, 1e9, True, correlation)
    floors = _floors([record for record in records if record.name not in declared], usable, channels)
    method = f"{floors.method}; declared of {', '.join(declared)}" if declared else floors.method
    levels = {record.name: (declared | floors.by_record)[record.name] for record in records}
    return replace(floors, by_record=levels, method=method, correlation=correlation)


def _floors(records: Sequence[FitRecord], usable: Mapping[str, float], channels: Mapping[str, Channel]) -> NoiseLevel:
    """The floors of spectra, up to a frequency that is usable of each record, or the variance that rounding leaves."""
    found = {r.name: [_floor(r, low * usable[r.name], high * usable[r.name]) for low, high in BANDS] for r in records}
    rounding = {record.name: _rounding(record, channels[record.name]) for record in records}
    levels, agree = {}, True
    for name, bands in found.items():
        variances, lines = np.array(bands).T
        apart = variances.max() > AGREEMENT**2 * max(variances.min(), 1e-300)
        agree &= not apart
        level = variances.min() if apart else float((variances * lines).sum() / max(lines.sum(), 1))
        levels[name] = max(float(level), rounding[name])
    degrees = {name: DEGREES * sum(lines for _, lines in bands) for name, bands in found.items()}
    said = "spectral floor above the signal"
    pooled = _pooled(levels, degrees)
    if pooled is not None:
        shared, freedom = dict.fromkeys(levels, pooled**0.5), sum(degrees.values())
        return NoiseLevel(shared, f"{said}, of all records", freedom, agree)
    own = {name: variance**0.5 for name, variance in levels.items()}
    return NoiseLevel(own, said, min(degrees.values()), agree)


def floor_variance(record: FitRecord) -> float:
    """Variance of the noise of a record's first channel: the lower of the two bands above the signal."""
    half = record.sampling_rate / 2
    return min(_floor(record, low * half, high * half)[0] for low, high in BANDS)


def _rounding(record: FitRecord, channel: Channel) -> float:
    """Variance that the steps of the converter leave."""
    return max(step_of(record.response.numpy()) ** 2 / 12, channel.rounding**2)


def _pooled(levels: dict[str, float], degrees: dict[str, float]) -> float | None:
    """The one variance of all records; None where they differ by more than chance."""
    variance, freedom = np.array([levels[n] for n in levels]), np.array([degrees[n] for n in levels])
    mean = float((variance * freedom).sum() / max(freedom.sum(), 1e-300))
    error = (2 / np.maximum(freedom, 1)) ** 0.5
    return mean if (np.abs(variance / max(mean, 1e-300) - 1) < ALIKE * error).all() else None


def noise_of(
    fit: Sequence[FitRecord], holdout: Sequence[FitRecord], measurement: Measurement
) -> tuple[list[FitRecord], list[FitRecord], NoiseLevel]:
    """The noise of the first channel, and records whose further channels count by their own."""
    records = (*fit, *holdout)
    declared = {record.name: _declared(record, measurement) for record in records}
    first = _of_first_channels(records, declared)
    others: dict[str, NoiseLevel] = {}
    for name in dict.fromkeys(channel.name for record in records for channel, _ in record.others):
        alone = [replace(r, response=values) for r in records for channel, values in r.others if channel.name == name]
        others[name] = noise_level(alone, {record.name: declared[record.name][name] for record in alone})
    return scaled(fit, first, others), scaled(holdout, first, others), first


def _declared(record: FitRecord, measurement: Measurement) -> Mapping[str, Channel]:
    """The channels of the record that this one is, or is a part of."""
    own = [one for one in measurement.records if one.name in (record.name, record.record)]
    own = own or [one for one in measurement.records if record.name.startswith(f"{one.name} (")]
    return own[0].channels


def _of_first_channels(records: Sequence[FitRecord], declared: Mapping[str, Mapping[str, Channel]]) -> NoiseLevel:
    """The noise of records by their first channels, each in its own unit."""
    names = {record.name: record.observed.name for record in records}
    found = []
    for name in dict.fromkeys(names.values()):
        alike = [record for record in records if record.observed.name == name]
        found.append(noise_level(alike, {record.name: declared[record.name][name] for record in alike}))
    first, *others = found
    if not others:
        return first
    return replace(
        first,
        by_record={name: level for one in found for name, level in one.by_record.items()},
        degrees_of_freedom=min(one.degrees_of_freedom for one in found),
        agree=all(one.agree for one in found),
        correlation=max(one.correlation for one in found),
        channels=names,
    )


def scaled(records: Sequence[FitRecord], first: NoiseLevel, others: Mapping[str, NoiseLevel]) -> list[FitRecord]:
    """Records whose further channels count by their noise: in the unit of the first, at its noise."""

    def scaled_channel(channel: Observed, record: FitRecord, values: Tensor) -> Observed:
        own, whole = others[channel.name].by_record.get(record.name, others[channel.name].value), first.by_record
        if own <= 0 or whole[record.name] <= 0:  # of a record too short to tell: each counts by what it shows
            return replace(channel, scale=_size(record.response) / _size(values))
        return replace(channel, scale=whole[record.name] / own)

    return [replace(r, others=tuple((scaled_channel(c, r, values), values) for c, values in r.others)) for r in records]


def _size(values: Tensor) -> float:
    return float(values.square().mean().sqrt()) or 1.0


def weighted(records: Sequence[FitRecord], noise: NoiseLevel) -> tuple[FitRecord, ...]:
    """Records that count by their noise, those of one channel within a range that no estimate of it can overturn."""
    low, high = WEIGHTS

    def weight(record: FitRecord) -> float:
        typical = noise.typical(record.name)
        if noise.value <= 0 or typical <= 0:  # of records too short to tell
            return _size(records[0].response) / _size(record.response) if noise.channels else 1.0
        return noise.value / typical * min(max(typical / max(noise.by_record[record.name], 1e-300), low), high)

    return tuple(replace(record, weight=weight(record)) for record in records)


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
