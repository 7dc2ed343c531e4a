"""Cross-fitting: what a fit would leave of every fold of the samples if that fold had not been fitted.

Of a linear model the residuals of a fold that is left out follow from one fit to all (Cook & Weisberg 1982, Residuals
and Influence in Regression, 2.2), and of a model that is linear over its errors nearly so: no further simulation.
"""

from dataclasses import dataclass

import torch
from torch import Tensor

LEAST_ELSEWHERE = 0.5  # of the information on a direction, in the other folds: with less a fold judges it by itself


@dataclass(frozen=True)
class LeftOut:
    """Residuals of folds that were left out, and what noise alone would add to them.

    Args:
        residuals: (samples,).
        expected: Mean of what errors of the parameters add to the sum of squares, in noise variances.
        deviation: Its standard deviation at most: errors of folds that share most of the others hang together.
    """

    residuals: Tensor
    expected: float
    deviation: float


def left_out(columns: Tensor, residual: Tensor, folds: Tensor, slope: Tensor, expected: Tensor) -> LeftOut:
    """The residuals of every fold by parameters that are fitted to the others.

    A direction of which a fold holds more than half of the information is not told by the others; it is then weighed
    as if they held as much.

    Args:
        columns: Sensitivities of what is predicted, (samples, p).
        residual: What the fit to all leaves, (samples,).
        folds: Number of each sample's fold, (samples,).
        slope: Of what is expected of each parameter, (p,).
        expected: Its residuals, (p,).
    """
    norms = (columns.square().sum(0) + slope.square()).sqrt()
    told = norms > 0
    columns, slope, expected = columns[:, told] / norms[told], slope[told] / norms[told], expected[told]
    values, vectors = torch.linalg.eigh(columns.T @ columns + torch.diag(slope.square()))
    kept = values > len(values) * torch.finfo(values.dtype).eps * values.amax() if len(values) else values > 0
    white = vectors[:, kept] / values[kept].sqrt()
    columns, pull = columns @ white, white.T @ (slope * expected)
    pull = pull + columns.T @ residual
    found, mean, deviation = residual.clone(), 0.0, 0.0
    for fold in folds.unique():
        own = folds == fold
        inside = columns[own]
        shares, turned = torch.linalg.eigh(inside.T @ inside)
        elsewhere = (1 - shares).clamp(min=LEAST_ELSEWHERE)
        others = turned.T @ (pull - inside.T @ residual[own])
        found[own] = residual[own] - inside @ (turned @ (others / elsewhere))
        added = shares.clamp(0, 1) / elsewhere
        mean, deviation = mean + float(added.sum()), deviation + float((2 * added.square().sum()).sqrt())
    return LeftOut(found, mean, deviation)
