"""Step 4: is anything wrong? The excess of held-out residuals over the noise, with its uncertainty."""

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.explanation.noise import NoiseLevel
from gear_damping.identification.output_error.records import FitRecord

SMALLEST = 0.03  # % of the channel's AC variance; less is never called significant
ERRORS = 3.0  # standard errors
REST = 0.02  # of the first excess: less is the form of an effect that is right,
CLOSE = 1.2  # where it leaves no more than so many noise variances
PART = 0.05  # of the first excess: more, if noise alone would not leave it, is a part without a name


@dataclass(frozen=True)
class Excess:
    """Held-out mean squared residual beyond the noise, in % of the channel's AC variance.

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


def is_settled(left: Excess, first: Excess) -> bool:
    """Whether nothing is left of a first excess that is worth another cause."""
    return not left.significant or (left.percent <= REST * first.percent and left.misfit <= CLOSE)


def is_all(left: Excess, first: Excess) -> bool:
    """Whether causes explain a first excess: what they leave is settled, and noise or a small part of it."""
    return is_settled(left, first) and left.percent <= max(left.chance, PART * first.percent)


def excess(residuals: Sequence[Tensor], records: Sequence[FitRecord], noise: NoiseLevel) -> Excess:
    """D of these residuals, beside what chance would leave if they were noise alone."""
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
    spread = (widened**2 + (noise.scatter.deviation * floor) ** 2) ** 0.5
    each = {
        record.name: float(residual.square().mean()) / max(floors[record.name], 1e-300)
        for record, residual in zip(records, residuals, strict=True)
    }
    chance = float(100 * (noise.scatter.expected * floor + ERRORS * spread) / variance)
    return Excess(100 * (mean_square - floor) / variance, max(SMALLEST, chance), chance, relative, each)


def ac_energy(record: FitRecord) -> float:
    """Sum of squares of a record's channels about their means, in the unit of the first."""
    channels = record.stacked.unflatten(0, (len(record.channels), -1))
    return float((channels - channels.mean(1, keepdim=True)).square().sum())


def paired_gain(before: Sequence[Tensor], after: Sequence[Tensor], blocks: Sequence[int]) -> tuple[float, float]:
    """Mean gain of squared residuals per sample and its t statistic over blocks of so many samples, by record.

    The gain is tested as it is and relative to what either leaves of a block, and the clearer answer counts:
    in a decay the first blocks hold nearly all of it, which is no reason to doubt the others.
    """
    gains, shares = [], []
    for old, new, block in zip(before, after, blocks, strict=True):
        count = max(1, len(old) // block)
        pairs = zip(*(r[: count * block].square().chunk(count) for r in (old, new)), strict=True)
        means = torch.stack([torch.stack([a.mean(), b.mean()]) for a, b in pairs])
        gains.append(means[:, 0] - means[:, 1])
        shares.append(gains[-1] / means.sum(1).clamp(min=1e-300))
    found = torch.cat(gains)
    return float(found.mean()), max(_t(found), _t(torch.cat(shares)), key=abs)


def _t(values: Tensor) -> float:
    error = values.std() / len(values) ** 0.5 if len(values) > 1 else values.abs().mean()
    return float(values.mean() / error.clamp(min=1e-300))
