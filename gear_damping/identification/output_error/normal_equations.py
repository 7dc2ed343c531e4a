"""J'J and J'r in blocks, and the span of what every record has of its own."""

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from gear_damping.identification.output_error.problem import Prediction

INDEPENDENT = 1e-9  # of the largest: a direction that counts


@dataclass(frozen=True)
class NormalEquations:
    """J'J and J'r of several starts, in blocks: what a record has of its own meets only that record.

    Args:
        shared: Of the shared parameters, (starts, p, p).
        between: Of these and every record's own, (starts, records, p, l).
        own: Of every record's own, (starts, records, l, l).
        pull: J'r of the shared parameters, (starts, p).
        own_pull: J'r of every record's own, (starts, records, l).
    """

    shared: Tensor
    between: Tensor
    own: Tensor
    pull: Tensor
    own_pull: Tensor

    def only(self, free: Tensor) -> "NormalEquations":
        """With the shared parameters held that are not free, (starts, p)."""
        kept = free.to(self.pull.dtype)
        shared = self.shared * kept.unsqueeze(-1) * kept.unsqueeze(-2)
        return replace(self, shared=shared, between=self.between * kept[:, None, :, None], pull=self.pull * kept)

    def beside(self, slope: Tensor) -> "NormalEquations":
        """With what is expected of each shared parameter, by its slope, (starts, p)."""
        return replace(self, shared=self.shared + torch.diag_embed(slope.square()))

    def beyond(self, held: Tensor) -> "NormalEquations":
        """What is left to be done once the shared parameters have gone `held`, (starts, p)."""
        pull = self.pull - (self.shared @ held.unsqueeze(-1)).squeeze(-1)
        own_pull = self.own_pull - (self.between.transpose(-1, -2) @ held[:, None, :, None]).squeeze(-1)
        return replace(self, pull=pull, own_pull=own_pull)

    def step(self, damping: Tensor) -> tuple[Tensor, Tensor]:
        """The damped step, (starts, p) and (starts, records, l), by elimination of what is the records' own."""
        diagonals = self.shared.diagonal(dim1=-2, dim2=-1), self.own.diagonal(dim1=-2, dim2=-1)
        largest = torch.cat([d.flatten(1) for d in diagonals], 1).amax(1).clamp(min=1e-30)
        ridges = [_like(damping, d) * d + _like(1e-12 * largest, d) for d in diagonals]
        own = self.own + torch.diag_embed(ridges[1])
        right = torch.cat([self.between.transpose(-1, -2), self.own_pull.unsqueeze(-1)], -1)
        solved = torch.linalg.solve(own, right)
        reduced = (self.between @ solved).sum(1)
        matrix = self.shared + torch.diag_embed(ridges[0]) - reduced[..., :-1]
        shared = torch.linalg.solve(matrix, self.pull - reduced[..., -1])
        return shared, solved[..., -1] - (solved[..., :-1] @ shared[:, None, :, None]).squeeze(-1)


def normal_equations(prediction: Prediction, n_shared: int) -> NormalEquations:
    """J'J and J'r of a linearisation: one product of all columns of each record, of which the shared ones add up."""
    sensitivity, residual = prediction.sensitivity, prediction.residual.unsqueeze(-1)
    turned = sensitivity.transpose(-1, -2)
    products = (turned @ sensitivity).nan_to_num(0, 0, 0)
    pulls = (turned @ residual).squeeze(-1).nan_to_num(0, 0, 0)
    return NormalEquations(
        products[..., :n_shared, :n_shared].sum(1),
        products[..., :n_shared, n_shared:],
        products[..., n_shared:, n_shared:],
        pulls[..., :n_shared].sum(1),
        pulls[..., n_shared:],
    )


def nuisance_basis(sensitivity: Tensor, n_shared: int) -> Tensor:
    """Orthonormal columns that span what every record has of its own, (records, time, l); zero where it is less.

    Args:
        sensitivity: Of one start, (records, time, n_shared + l).
        n_shared: Number of shared parameters.
    """
    own = sensitivity[..., n_shared:].nan_to_num(0, 0, 0)  # a motion that runs away with any change tells nothing
    columns = own / own.norm(dim=1, keepdim=True).clamp(min=1e-300)
    basis, sizes, _ = torch.linalg.svd(columns, full_matrices=False)
    return basis * (sizes > INDEPENDENT * sizes.amax(-1, keepdim=True)).unsqueeze(1)


def project_out(signal: Tensor, basis: Tensor) -> Tensor:
    """`signal` (records, time, n) in the orthogonal complement of what the records' own columns could do."""
    return signal - basis @ (basis.transpose(-1, -2) @ signal)


def _like(value: Tensor, other: Tensor) -> Tensor:
    """(starts,) with the number of dimensions of another."""
    return value.reshape(-1, *[1] * (other.ndim - 1))
