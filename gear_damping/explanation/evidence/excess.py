"""Step 4: is anything wrong? The excess of residuals over the noise, with its uncertainty."""

from collections.abc import Sequence
from dataclasses import dataclass

from torch import Tensor

from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.explanation.settings import SearchSettings
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.running_integral import about_its_line

WHOLE = 100.0  # %, all of the signal


@dataclass(frozen=True)
class Excess:
    """Mean squared residual of records left out of the fit, beyond the noise, in % of the channel's variance.

    Args:
        percent: D.
        threshold: Above it D is significant.
        chance: What noise alone may leave of it.
        misfit: Mean squared residual over the noise variance.
        per_record: The same by record name.
    """

    percent: float
    threshold: float
    chance: float
    misfit: float
    per_record: dict[str, float]

    @property
    def significant(self) -> bool:
        """Whether the data show that something is missing."""
        return self.percent > self.threshold

    @property
    def of_signal(self) -> float:
        """How much of the signal is missing, in %: at most all of it, however wrong a prediction is."""
        return min(self.percent, WHOLE)


def is_settled(left: Excess, first: Excess, settings: SearchSettings) -> bool:
    """Whether nothing is left of a first excess that is worth another cause."""
    return is_form(left, first, settings) or not left.significant


def is_form(left: Excess, first: Excess, settings: SearchSettings) -> bool:
    """Whether what is left of a first excess is no more than the form of an effect that is right may leave."""
    return left.percent <= settings.settled_share * first.of_signal and left.misfit <= settings.settled_misfit


def is_all(left: Excess, first: Excess, settings: SearchSettings) -> bool:
    """Whether causes explain a first excess: what they leave is settled, and noise or a small part of it."""
    part = max(left.chance, settings.named_share * first.of_signal)
    return is_settled(left, first, settings) and left.percent <= part


def excess(
    residuals: Sequence[Tensor], records: Sequence[FitRecord], noise: NoiseLevel, settings: SearchSettings | None = None
) -> Excess:
    """D of these residuals, beside what chance would leave if they were noise alone."""
    settings = settings or SearchSettings()
    total = sum(len(r) for r in residuals)
    mean_square = sum(float(r.square().sum()) for r in residuals) / total
    variance = sum(ac_energy(record) for record in records) / total
    floors = {record.name: noise.by_record[record.name] ** 2 for record in records}
    floor = sum(floors[r.name] * len(r.stacked) for r in records) / total
    effective = total / noise.correlation
    relative = mean_square / max(floor, 1e-300)
    beyond = max(mean_square - floor, 0.0) / variance
    error = (1 + beyond) * (2 / effective + 2 / noise.degrees_of_freedom) ** 0.5 * floor
    widened = error if noise.agree else 2 * error
    standard_error = (widened**2 + (noise.scatter.deviation * floor) ** 2) ** 0.5
    each = {
        record.name: float(residual.square().mean()) / max(floors[record.name], 1e-300)
        for record, residual in zip(records, residuals, strict=True)
    }
    chance = float(100 * (noise.scatter.expected * floor + settings.standard_errors * standard_error) / variance)
    return Excess(100 * (mean_square - floor) / variance, max(settings.least_excess, chance), chance, relative, each)


def ac_energy(record: FitRecord) -> float:
    """Sum of squares of a record's channels, in the unit of the first, about what nothing but its beginning tells.

    That is the mean; and of a displacement that runs on where nothing acts, the straight line in each segment that has
    a state of its own: of a drive that turns slowly it would be nearly all, and whatever is missed nothing beside it.
    """
    energy, rows = 0.0, record.stacked.unflatten(0, (len(record.channels), -1))
    for channel, values in zip(record.channels, rows, strict=True):
        pieces = record.pieces or ((0, len(values)),)
        about = [about_its_line(values[a:b]) for a, b in pieces] if channel.drifts else [values - values.mean()]
        energy += sum(float(one.square().sum()) for one in about)
    return energy


def is_mostly_left(residual: Tensor, record: FitRecord, noise: float, share: float) -> bool:
    """Whether a model leaves more than a share of what a record holds beyond its noise.

    Args:
        residual: (n,) weighted residuals.
        record: What they are of.
        noise: Its standard deviation where the weight is one.
        share: Of the variance.
    """
    of_noise = len(residual) * (noise / record.weight) ** 2
    return float(residual.square().sum()) - of_noise > share * (ac_energy(record) - of_noise)
