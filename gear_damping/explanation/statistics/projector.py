"""The orthogonal complement of everything that the free parameters of a fit could do."""

from copy import copy

import torch
from torch import Tensor

from gear_damping.explanation.statistics.tall import tall_svd
from gear_damping.identification.output_error.normal_equations import INDEPENDENT, nuisance_basis, project_out


class Projector:
    """Projects out of a signal what the free parameters of a fit could do.

    A signal has the samples of the records one after another, and behind them one for each free parameter: what
    is expected of it.
    """

    def __init__(self, sensitivity: Tensor, expected: Tensor, slope: Tensor) -> None:
        """Prepare it.

        Args:
            sensitivity: (records, time, shared and own columns).
            expected: Residuals of what is expected of the first shared parameters, (n,).
            slope: Their slopes, (n,).
        """
        self.sensitivity, self.expected, self.slope = sensitivity, expected, slope
        self.own = nuisance_basis(sensitivity, len(slope))
        shared = project_out(sensitivity[..., : len(slope)], self.own).flatten(0, 1)
        jacobian = torch.cat([shared, torch.diag(slope)])
        norms = jacobian.norm(dim=0).clamp(min=1e-300)
        self.basis = torch.linalg.qr(jacobian / norms).Q

    def __call__(self, signal: Tensor) -> Tensor:
        """`signal` (samples + n, m) without its part in the span of the sensitivities."""
        samples = len(signal) - len(self.slope)
        rows = signal[:samples].reshape(*self.own.shape[:2], -1)
        orthogonal = torch.cat([project_out(rows, self.own).flatten(0, 1), signal[samples:]])
        return orthogonal - self.basis @ (self.basis.T @ orthogonal)

    def by_record(self, signals: Tensor, reach: Tensor) -> Tensor:
        """Signals (n, samples) split into those of single records and projected, (samples + n, n * names).

        Nothing but a record's own samples is worked through for its part.

        Args:
            signals: Of all records one after another.
            reach: (names, records), 1 where a row of sensitivities is of the record of that name.
        """
        records, time = self.own.shape[:2]
        own = project_out(signals.unflatten(1, (records, time)).permute(1, 2, 0), self.own)
        shared = self.basis[: records * time].unflatten(0, (records, time))
        taken = torch.einsum("rkn,mr->knm", shared.transpose(1, 2) @ own, reach)
        split = (own.unsqueeze(-1) * reach.T[:, None, None]).reshape(records * time, -1)
        split = torch.nn.functional.pad(split, (0, 0, 0, len(self.slope)))
        return torch.addmm(split, self.basis, taken.flatten(1), alpha=-1)

    @property
    def nuisance(self) -> Tensor:
        """Orthonormal columns of everything that is projected out, (samples + n, m)."""
        rows = torch.block_diag(*self.own)
        rows = rows[:, rows.norm(dim=0) > 0]
        return torch.cat([torch.nn.functional.pad(rows, (0, 0, 0, len(self.slope))), self.basis], 1)

    def taken_by_own(self, columns: Tensor, signal: Tensor) -> float:
        """Sum of squares that columns (records, time, l) of every record take of a signal (samples + n, 1).

        By the normal equations: the columns of different records meet only through what is shared.
        """
        records, width = len(columns), columns.shape[-1]
        own = project_out(columns, self.own)
        samples = records * columns.shape[1]
        rows = signal[:samples].reshape(records, -1, 1)
        pull = (own.transpose(1, 2) @ rows).reshape(-1)
        shared = self.basis[:samples].reshape(records, -1, self.basis.shape[1])
        between = (shared.transpose(1, 2) @ own).permute(1, 0, 2).reshape(-1, records * width)
        gram = torch.block_diag(*(own.transpose(1, 2) @ own)) - between.T @ between
        return float(pull @ (torch.linalg.pinv(gram, rtol=INDEPENDENT, hermitian=True) @ pull))

    def with_nuisance(self, columns: Tensor) -> "Projector":
        """With columns (records, time, l) more that every record has of its own.

        Their part that is orthogonal to it joins the basis: the old part of it need not be worked out again. Of many
        short records they are more than all that is shared, which is then worked out anew with them.
        """
        if not columns.shape[-1]:
            return self
        if len(columns) * columns.shape[-1] > len(self.slope):
            return Projector(torch.cat([self.sensitivity, columns], -1), self.expected, self.slope)
        rows = torch.block_diag(*columns)
        orthogonal = self(torch.nn.functional.pad(rows, (0, 0, 0, len(self.slope))))
        own = orthogonal.norm(dim=0) > INDEPENDENT * rows.norm(dim=0)
        basis, sizes, _ = tall_svd(orthogonal[:, own] / orthogonal[:, own].norm(dim=0))
        more = copy(self)
        more.basis = torch.cat([self.basis, basis[:, sizes > INDEPENDENT]], 1)
        return more
