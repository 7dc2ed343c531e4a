"""The singular value decomposition of a few columns of many samples."""

import torch
from torch import Tensor

INDEPENDENT = 1e-8  # of the largest eigenvalue: above it the Gram matrix tells directions to eight digits


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
