"""Which of two predictions is nearer: the gain of squared residuals, with its t statistic over blocks."""

from collections.abc import Sequence

import torch
from torch import Tensor

from gear_damping.identification.output_error.uncertainty import long_run

FEW_BLOCKS = 9.0  # effective ones: the t of a gain over n blocks is sqrt(n) at most, 3 of nine


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
