"""The singular value decomposition of a few columns of many samples."""

import torch
from torch import Tensor

INDEPENDENT = 1e-8  # of the largest eigenvalue: above it the Gram matrix tells directions to eight digits


def directions(columns: Tensor, least: float) -> tuple[Tensor, Tensor]:
    """U (samples, n) and S (n,) of columns (samples, m) brought to one length, without those shorter than a share.

    Args:
        columns: They are read twice and never copied, unless they are nearly dependent.
        least: Of the longest.
    """
    gram = columns.T @ columns
    norms = gram.diagonal().clamp(min=0).sqrt()
    kept = norms > least * norms.max().clamp(min=1e-300)
    if not bool(kept.all()):
        columns, norms, gram = columns[:, kept], norms[kept], gram[kept][:, kept]
    if not columns.shape[1]:
        return columns, norms
    squares, turned = torch.linalg.eigh(gram / norms / norms.unsqueeze(1))
    if bool(squares[0] > INDEPENDENT * squares[-1]) and len(columns) >= len(squares):
        squares, turned = squares.flip(0), turned.flip(1)
        return columns @ (turned / norms.unsqueeze(1) / squares.sqrt()), squares.sqrt()
    basis, sizes, _ = tall_svd(columns / columns.norm(dim=0))
    return basis, sizes


def tall_svd(columns: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """U (samples, n), S (n,) and V^T (n, n) of columns (samples, n).

    By the Gram matrix, which takes a quarter of the time; the few directions in which columns are nearly dependent,
    as the errors of all teeth of a gear are, by what is left of them without the others.
    """
    squares, turned = torch.linalg.eigh(columns.T @ columns)
    squares, turned = squares.flip(0), turned.flip(1)
    told = squares > INDEPENDENT * squares[:1]
    if not len(squares) or 2 * int(told.sum()) < len(told) or len(columns) < len(squares):
        return torch.linalg.svd(columns, full_matrices=False)
    sizes = squares[told].sqrt()
    basis = columns @ (turned[:, told] / sizes)
    if bool(told.all()):
        return basis, sizes, turned.T
    rest = columns @ turned[:, ~told]
    more, smaller, among = torch.linalg.svd(rest - basis @ (basis.T @ rest), full_matrices=False)
    turned = torch.cat([turned[:, told].T, among @ turned[:, ~told].T])
    return torch.cat([basis, more], 1), torch.cat([sizes, smaller]), turned
