"""Which of two predictions is nearer: the gain of squared residuals, with its t statistic over blocks."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import torch
from scipy.stats import t as student
from torch import Tensor

from gear_damping.identification.output_error.uncertainty import long_run

UPPER = 0.975  # share below the upper end of a two-sided 95 % interval
FEW_BLOCKS = 9.0  # effective ones: the t of a gain over n blocks is sqrt(n) at most, 3 of nine


def paired_gain(before: Sequence[Tensor], after: Sequence[Tensor], blocks: Sequence[int]) -> tuple[float, float]:
    """Mean gain of squared residuals per sample and its t statistic over blocks of so many samples, by record.

    The gain is tested as it is and relative to what either leaves of a block, and the clearer answer counts:
    in a decay the first blocks hold nearly all of it, which is no reason to doubt the others. Where all that differs
    happens in a few blocks, as a tooth that passes twice, no t over blocks can be large, and the gain is tested for
    what differs as it is (`_t_of_events`). A prediction that is not finite is worse than any other.
    """
    lost = _is_lost(after) - _is_lost(before)
    if lost or _is_lost(before):
        return -inf * lost if lost else 0.0, -inf * lost if lost else 0.0
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
    if _are_few(size):
        tested.append(_t_of_events(before, after, blocks))
    return float(found.mean()), max(tested, key=abs)


def confirmation(before: Sequence[Tensor], after: Sequence[Tensor], blocks: Sequence[int]) -> float:
    """The t statistic of what a second prediction adds to the first, on what the first leaves, over blocks.

    Of two predictions of which one contains the other the difference of squares is blunt: what the larger one adds is
    compared with the residual itself (Clark & West 2007, Journal of Econometrics 138). Over n blocks this t is sqrt(n)
    at most; where what is added lies in a few of them, its variance is that of what the second one leaves.
    A prediction that is not finite is worse than any other.
    """
    if _is_lost(before) or _is_lost(after):
        return paired_gain(before, after, blocks)[1]
    sums, sizes = [], []
    for old, new, block in zip(before, after, blocks, strict=True):
        added = old - new
        count = max(1, len(added) // block)
        sums += [part.sum() for part in (added * old)[: count * block].chunk(count)]
        sizes += [part.sum() for part in added.square()[: count * block].chunk(count)]
    total, size = torch.stack(sums), torch.stack(sizes)
    if _are_few(size):
        return float(total.sum()) / max(_deviation(before, after, blocks), 1e-300)
    return float(total.sum() / total.square().sum().sqrt().clamp(min=1e-300))


@dataclass(frozen=True)
class Share:
    """A share of squared residuals, with its 95 % interval."""

    value: float
    interval95: tuple[float, float]


def share_taken(before: Sequence[Tensor], after: Sequence[Tensor], blocks: Sequence[int]) -> Share:
    """Share of the squared residuals of a first prediction that a second one takes.

    A ratio of sums over blocks: its error is that of what it misses in each of them (Cochran 1977, Sampling
    Techniques, 2.11).
    """
    sums = []
    for old, new, block in zip(before, after, blocks, strict=True):
        count = max(1, len(old) // block)
        parts = zip(*(residual.square().chunk(count) for residual in (old, new)), strict=True)
        sums += [torch.stack([part.sum() for part in both]) for both in parts]
    left, taken = torch.stack(sums)[:, 0], torch.stack(sums) @ torch.tensor([1.0, -1.0], dtype=torch.float64)
    total = float(left.sum().clamp(min=1e-300))
    value, count = float(taken.sum()) / total, len(sums)
    missed = (taken - value * left).square().sum() * count / max(count - 1, 1)
    half = float(student.ppf(UPPER, max(count - 1, 1)) * missed.sqrt()) / total
    return Share(value, (value - half, min(value + half, 1.0)))


def _is_lost(residuals: Sequence[Tensor]) -> bool:
    """Whether a prediction is not finite."""
    return not all(bool(residual.isfinite().all()) for residual in residuals)


def _are_few(sizes: Tensor) -> bool:
    """Whether what two predictions differ by, (blocks,), lies in a few blocks."""
    return float(sizes.sum() ** 2) < FEW_BLOCKS * float(sizes.square().sum())


def _t(values: Tensor) -> float:
    error = values.std() / len(values) ** 0.5 if len(values) > 1 else values.abs().mean()
    return float(values.mean() / error.clamp(min=1e-300))


def _t_of_events(before: Sequence[Tensor], after: Sequence[Tensor], blocks: Sequence[int]) -> float:
    """The t statistic of a gain, given where and how much the two predictions differ.

    With d their difference and e what the second leaves, the gain is d (2 e + d): only e is random. Its covariance
    is estimated at every lag up to a block (Newey & West 1987), and the largest of these variances counts.
    """
    gain = sum(float((old.square() - new.square()).sum()) for old, new in zip(before, after, strict=True))
    return gain / max(2 * _deviation(before, after, blocks), 1e-300)


def _deviation(before: Sequence[Tensor], after: Sequence[Tensor], blocks: Sequence[int]) -> float:
    """Standard deviation of what a second prediction adds times what it leaves, summed."""
    longest = max(blocks)
    lags = [0, *(2**k for k in range(longest.bit_length()) if 2**k <= longest)]
    products = [(old - new) * new for old, new in zip(before, after, strict=True)]
    variance = max(sum(float(long_run(product.unsqueeze(1), lag)) for product in products) for lag in lags)
    return max(variance, 0.0) ** 0.5
