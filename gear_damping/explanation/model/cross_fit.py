"""A fitted model judged on every operating condition by parameters that were fitted to the others."""

from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.explanation.evidence.noise import Scatter
from gear_damping.explanation.evidence.records import condition_of
from gear_damping.explanation.statistics.folds import left_out
from gear_damping.identification.output_error.least_squares import Fitted
from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.problem import OutputErrorProblem


@dataclass(frozen=True)
class CrossFit:
    """What is left of the fitted records where each fold is left out.

    Args:
        residuals: Weighted, (records, channels * time), as the problem has them.
        scatter: What errors of the parameters add to their mean square, in noise variances.
    """

    residuals: Tensor
    scatter: Scatter


def cross_fitted(problem: OutputErrorProblem, fitted: Fitted) -> CrossFit:
    """The residuals of a fit with its folds left out; those of the fit itself where it ran away."""
    residual, sensitivity = fitted.prediction.residual[0], fitted.prediction.sensitivity[0]
    if not bool(sensitivity.isfinite().all() & residual.isfinite().all()):
        return CrossFit(residual, Scatter())
    own = nuisance_basis(sensitivity, problem.n_shared)
    columns = project_out(sensitivity[..., : problem.n_shared], own).flatten(0, 1)
    orthogonal = project_out(residual.unsqueeze(-1), own).flatten()
    expected, slope = problem.expectation(fitted.shared, residual)
    free = (problem.unknowns.at_bound(fitted.shared) == 0).to(columns.dtype)  # what a bound holds is held for all
    folds = folds_of(problem).unsqueeze(1).expand(-1, len(problem.response.channels), -1).flatten()
    found = left_out(columns * free, orthogonal, folds, slope * free, expected)
    samples = max(float((problem.response.weights > 0).sum()), 1.0)
    scatter = Scatter(found.expected / samples, found.deviation / samples)
    return CrossFit(found.residuals.reshape(residual.shape), scatter)


def folds_of(problem: OutputErrorProblem) -> Tensor:
    """Fold of every sample, (records, time): that of its operating condition."""
    keys = [condition_of(record) for record in problem.records]
    names = list(dict.fromkeys(keys))
    return torch.tensor([names.index(key) for key in keys]).unsqueeze(1).expand(-1, problem.response.length)
