"""What tests tell of what they share: information matrices, without what each test has of its own.

With the slopes J of a record, the noise s and the prior precision P of a test's own unknowns (its start, its errors),
what it tells of the shared ones is F_ss - F_st (F_tt + P)^-1 F_ts with F = J'J / s^2 (the Schur complement). Tests add
up; what is known of shared unknowns beforehand is added once.
"""

import torch
from torch import Tensor

QUANTILE = 1.959963984540054  # of the normal distribution, for 95 % on both sides
UNSEEN = 1e-13  # of an unknown's own information, which stands for none: far below what rounding leaves
UNKNOWN = 1e4  # % of the value; half an interval beyond it says nothing


def information(slopes: Tensor, noise: Tensor, lengths: list[int]) -> Tensor:
    """Information of records and of their beginnings.

    Args:
        slopes: (channels, batch, unknowns, time).
        noise: Standard deviation of each channel, (channels, batch).
        lengths: Samples of the records, ascending.

    Returns:
        (channels, batch, lengths, unknowns, unknowns).
    """
    whitened = slopes / noise[..., None, None]
    found, total, before = [], 0.0, 0
    for length in lengths:
        part = whitened[..., before:length]
        total = total + part @ part.mT
        found.append(total)
        before = length
    return torch.stack(found, 2)


def shared_information(whole: Tensor, shared: int, prior: Tensor) -> Tensor:
    """What is left for the shared unknowns, which stand first, (…, shared, shared).

    Args:
        whole: (…, unknowns, unknowns).
        shared: How many are shared.
        prior: Precision of the others beforehand, 0 for none, (…, others).
    """
    own = whole[..., shared:, shared:] + torch.diag_embed(prior.expand(*whole.shape[:-2], -1))
    across = whole[..., :shared, shared:]
    return whole[..., :shared, :shared] - across @ inverse(own) @ across.mT


def inverse(matrices: Tensor) -> Tensor:
    """Of information matrices; an unknown that nothing is told of gets a variance beyond all bounds."""
    size = matrices.diagonal(dim1=-2, dim2=-1).clamp(min=0).sqrt()
    size = torch.where(size > 0, size, size.amax(-1, keepdim=True) * UNSEEN)
    size = torch.where(size > 0, size, 1.0)
    both = size.unsqueeze(-1) * size.unsqueeze(-2)
    ridge = UNSEEN * torch.eye(matrices.shape[-1], dtype=matrices.dtype)
    return torch.linalg.inv(matrices / both + ridge) / both


def half_intervals(total: Tensor, gradient: Tensor) -> Tensor:
    """Half of the 95 % interval of a quantity.

    Args:
        total: Information of what is shared, priors included, (…, n, n).
        gradient: Of the quantity by the shared unknowns, (n,).
    """
    variance = ((inverse(total) @ gradient) * gradient).sum(-1)
    return QUANTILE * variance.clamp(min=0).sqrt()
