"""Step 4: is anything wrong? The excess of held-out residuals over the noise, with its uncertainty."""

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.explanation.noise import NoiseLevel
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.uncertainty import long_run

SMALLEST = 0.03  # % of the channel's AC variance; less is never called significant
ERRORS = 3.0  # standard errors
REST = 0.02  # of the first excess: less is the form of an effect that is right,
CLOSE = 1.2  # where it leaves no more than so many noise variances
FEW_BLOCKS = 9.0  # effective ones: the t of a gain over n blocks is sqrt(n) at most, 3 of nine
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
    in a decay the first blocks hold nearly all of it, which is no reason to doubt the others. Where all that differs
    happens in a few blocks, as a tooth that passes twice, no t over blocks can be large, and the gain is tested for
    what differs as it is (`_t_of_events`).
    """
    gains, shares, sizes = [], [], []
    for old, new, block in zip(before, after, blocks, strict=True):
        count = max(1, len(old) // block)
        parts = (r[: count * block].square().chunk(count) for r in (old, new, old - new))
        means = torch.stack([torch.stack([part.mean() for part in three]) for three in zip(*parts, strict=True)])
        gains.append(means[:, 0] - means[:, 1])
        shares.append(gains[-1] / means[:, :2].sum(1).clamp(min=1e-300))
        sizes.append(means[:, 2])
    found, size = torch.cat(gains), torch.cat(sizes)
    tested = [_t(found), _t(torch.cat(shares))]
    if float(size.sum() ** 2) < FEW_BLOCKS * float(size.square().sum()):
        tested.append(_t_of_events(before, after, blocks))
    return float(found.mean()), max(tested, key=abs)


def _t(values: Tensor) -> float:
    error = values.std() / len(values) ** 0.5 if len(values) > 1 else values.abs().mean()
    return float(values.mean() / error.clamp(min=1e-300))


def _t_of_events(before: Sequence[Tensor], after: Sequence[Tensor], blocks: Sequence[int]) -> float:
    """The t statistic of a gain, given where and how much the two predictions differ.

    With d their difference and e what the second leaves, the gain is d (2 e + d): only e is random. Its covariance
    is estimated at every lag up to a block (Newey & West 1987), and the largest of these variances counts.
    """
    gain = sum(float((old.square() - new.square()).sum()) for old, new in zip(before, after, strict=True))
    longest = max(blocks)
    lags = [0, *(2**k for k in range(longest.bit_length()) if 2**k <= longest)]
    products = [(old - new) * new for old, new in zip(before, after, strict=True)]
    variance = max(sum(float(long_run(product.unsqueeze(1), lag)) for product in products) for lag in lags)
    return gain / max(2 * variance**0.5, 1e-300)
