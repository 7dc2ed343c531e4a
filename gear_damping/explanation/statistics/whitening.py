"""The random part of residuals as an autoregression, and the filter that whitens it.

Burg would fit each record; the covariance method pools all rows, which short records need. The order is the one with
the least BIC (Schwarz 1978).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import log

import torch
from torch import Tensor

MOST_ORDER = 8  # coefficients: more would swallow a resonance as well as the effect that drives it
SAMPLES_PER_ORDER = 8  # of the shortest row, for each coefficient
LAGS = 4000  # over which autocorrelations are summed
SETTLED = 1e-9  # of an autocorrelation: what is left of it no longer counts


@dataclass(frozen=True)
class Autoregression:
    """x_t = sum_k a_k x_(t-k) + e_t.

    Args:
        coefficients: a_1 to a_p, (p,).
        innovation: Variance of e.
    """

    coefficients: Tensor
    innovation: float

    @property
    def order(self) -> int:
        """Number of coefficients."""
        return len(self.coefficients)

    @property
    def variance(self) -> float:
        """Variance of x."""
        return self.innovation * float(self._impulse.square().sum())

    @property
    def correlation(self) -> float:
        """Sum of the squared autocorrelations over all lags: so many samples count as one of a variance."""
        impulse = self._impulse
        spectrum = torch.fft.rfft(impulse, n=2 * len(impulse)).abs().square()
        covariance = torch.fft.irfft(spectrum)[: len(impulse)]
        squares = (covariance / covariance[0]).square()
        return float(2 * squares.sum() - 1)

    @property
    def _impulse(self) -> Tensor:
        """Response to one innovation, until nothing is left of it, (lags,)."""
        p, memory = self.order, [0.0] * self.order
        found, weights = [1.0], self.coefficients.tolist()
        memory = [1.0, *memory][:p]
        while p and len(found) < LAGS and max(map(abs, memory)) > SETTLED:
            value = sum(a * x for a, x in zip(weights, memory, strict=True))
            found.append(value)
            memory = [value, *memory][:p]
        return torch.tensor(found, dtype=torch.float64)

    def whitened(self, rows: Tensor) -> Tensor:
        """The innovations of rows (..., time); 0 for the first `order` samples, which have no full past."""
        found = rows.clone()
        for lag, a in enumerate(self.coefficients.tolist(), 1):
            found[..., lag:] -= a * rows[..., :-lag]
        found[..., : self.order] = 0.0
        return found


def autoregression(rows: Sequence[Tensor], taken: float = 0.0) -> Autoregression:
    """The autoregression of several rows (time,) that share one law.

    Args:
        rows: Residuals without mean, each of one record.
        taken: Degrees of freedom that a regression took out of them before.

    Raises:
        ValueError: there is no sample.
    """
    samples = sum(len(row) for row in rows)
    if not samples:
        raise ValueError("an autoregression needs samples")
    most = min(MOST_ORDER, min(len(row) for row in rows) // SAMPLES_PER_ORDER)
    left = samples / max(samples - taken, 1.0)
    fits = [_of_order(rows, order, most) for order in range(most + 1)]
    rows_used = sum(len(row) - most for row in rows)
    best = min(fits, key=lambda fit: rows_used * log(max(fit.innovation, 1e-300)) + fit.order * log(max(rows_used, 2)))
    return Autoregression(best.coefficients, best.innovation * left)


def _of_order(rows: Sequence[Tensor], order: int, most: int) -> Autoregression:
    """The fit of one order over the samples that every order predicts; shrunk until it is stable."""
    target = torch.cat([row[most:] for row in rows])
    if not order:
        return Autoregression(torch.zeros(0, dtype=torch.float64), float(target.square().mean()))
    past = torch.cat([torch.stack([row[most - k : len(row) - k] for k in range(1, order + 1)], 1) for row in rows])
    found = torch.linalg.lstsq(past, target.unsqueeze(1), rcond=1e-12, driver="gelsd").solution[:, 0]
    found = _stable(found)
    return Autoregression(found, float((target - past @ found).square().mean()))


def _stable(coefficients: Tensor) -> Tensor:
    """Coefficients whose poles lie inside the unit circle; poles outside are drawn in."""
    companion = torch.zeros(len(coefficients), len(coefficients), dtype=torch.float64)
    companion[0] = coefficients
    companion[1:, :-1] += torch.eye(len(coefficients) - 1, dtype=torch.float64)
    radius = float(torch.linalg.eigvals(companion).abs().max())
    if radius < 1:
        return coefficients
    shrink = (1 - 1e-3) / radius
    return coefficients * shrink ** torch.arange(1, len(coefficients) + 1, dtype=torch.float64)
