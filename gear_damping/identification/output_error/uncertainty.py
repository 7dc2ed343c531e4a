"""How far a fitted parameter can be trusted.

The covariance is the sandwich (J'J)^-1 S (J'J)^-1 with S the long-run covariance of the scores J_t r_t
(Newey & West 1987): it holds for coloured residuals, which is what a model that misses something leaves.
"""

from collections.abc import Callable, Sequence

import torch
from torch import Tensor

from gear_damping.identification.output_error.least_squares import Fitted
from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.problem import OutputErrorProblem

QUANTILE = 1.959964  # of a normal variable: 95 % lie within as many standard deviations
ROUNDING = 1e-15  # of an eigenvalue beside the largest, of products in double precision
LEAST_INFORMATION = 1e-30  # beside 1: products of two of them are still numbers
SPOKEN_OF = 1e-8  # of the information of all records: a direction with less in the others is not known without one
WIDEST = 1e6  # times the variance of coloured residuals: more is no matter of colour


def covariance(
    problem: OutputErrorProblem, fitted: Fitted, correlated_s: float, mean_free: Sequence[Sequence[int]] = ()
) -> Tensor:
    """Covariance of the coordinates of the shared parameters, (n_shared, n_shared).

    Args:
        problem: What was fitted.
        fitted: The fit.
        correlated_s: Seconds over which residuals may be correlated, some natural periods.
        mean_free: Places of parameters whose mean acts on nothing and is 0.
    """
    residual = fitted.prediction.residual[0]
    expected = problem.expected_information(fitted.shared, residual)
    orthogonal, information = _information(problem, fitted, expected, mean_free)
    inverse = _inverse(information)
    scores = orthogonal * residual.unsqueeze(-1)
    lags = [round(correlated_s * record.sampling_rate) for record in problem.records]
    meat = sum(long_run(one, lag) for one, lag in zip(scores, lags, strict=True))
    parameters = problem.n_shared + len(problem.records) * len(problem.local)
    samples = float((problem.response.weights > 0).sum())
    sandwich = inverse @ meat @ inverse * samples / max(samples - parameters, 1.0)
    plain = inverse * residual.square().sum() / max(samples - parameters, 1.0)
    wide = torch.maximum(sandwich.diagonal(), plain.diagonal()) / sandwich.diagonal().clamp(min=1e-300)
    scale = wide.clamp(1, WIDEST).sqrt()
    scaled = sandwich * scale.unsqueeze(0) * scale.unsqueeze(1)
    missing = plain.diagonal() - scaled.diagonal()  # of what no score speaks of at all
    return scaled + torch.diag(missing.clamp(min=0))


def noise_covariance(problem: OutputErrorProblem, fitted: Fitted) -> Tensor:
    """The same where nothing but white noise is left, (n_shared, n_shared)."""
    expected = problem.expected_information(fitted.shared, fitted.prediction.residual[0])
    return _inverse(_information(problem, fitted, expected)[1]) * problem.noise**2


def without_one(
    problem: OutputErrorProblem, fitted: Fitted, groups: Sequence[int], mean_free: Sequence[Sequence[int]] = ()
) -> Tensor:
    """By how much the shared coordinates move when one group of records is left out, linearised, (groups, n_shared).

    Along what no other record speaks of, as a phase of that record alone, they stay where they are.

    Args:
        problem: What was fitted.
        fitted: The fit.
        groups: The group of every record of the problem, from 0 on.
        mean_free: Places of parameters whose mean acts on nothing and is 0.
    """
    expected = problem.expectation(fitted.shared, fitted.prediction.residual[0])[1].square()  # as the fit weighed it
    orthogonal, information = _information(problem, fitted, expected, mean_free)
    pull = torch.einsum("rtn,rt->rn", orthogonal, fitted.prediction.residual[0])
    own = orthogonal.transpose(1, 2) @ orthogonal
    of_group = torch.nn.functional.one_hot(torch.tensor(groups)).double()
    size = information.diagonal().sqrt().clamp(min=LEAST_INFORMATION)
    rest = (information - torch.einsum("rg,rij->gij", of_group, own)) / size / size.unsqueeze(1)
    inverse = torch.linalg.pinv(rest, rtol=SPOKEN_OF, hermitian=True)
    return (inverse @ (of_group.T @ pull / size).unsqueeze(2))[..., 0] / size


def _information(
    problem: OutputErrorProblem, fitted: Fitted, expected: Tensor, mean_free: Sequence[Sequence[int]] = ()
) -> tuple[Tensor, Tensor]:
    """Sensitivities, the records' own projected out, (records, time, n_shared), and the sum of their products.

    With the information of what is expected, (n_shared,), in it.
    """
    sensitivity = fitted.prediction.sensitivity[0]
    orthogonal = project_out(sensitivity[..., : problem.n_shared], nuisance_basis(sensitivity, problem.n_shared))
    known = orthogonal.isfinite().all(1).all(0) & orthogonal.square().sum((0, 1)).isfinite()
    orthogonal = torch.where(known, orthogonal, 0.0)  # of a fit that runs away with any change nothing is known
    jacobian = orthogonal.flatten(0, 1)
    information = jacobian.T @ jacobian + torch.diag(expected)
    for places in map(torch.tensor, mean_free):  # a mean that is known as well as all of the differences together
        information[places.unsqueeze(1), places] += information.diagonal()[places].sum() / len(places)
    return orthogonal, information


def _inverse(information: Tensor) -> Tensor:
    """The inverse of a symmetric information matrix, large and not nothing along what it says nothing of.

    A pseudo-inverse gives such a direction a variance of zero: the figure that is known worst looks known best.
    """
    size = information.diagonal().sqrt().clamp(min=LEAST_INFORMATION)
    values, vectors = torch.linalg.eigh(information / size.unsqueeze(0) / size.unsqueeze(1))
    inverse = vectors / values.clamp(min=ROUNDING * len(values)) @ vectors.T
    return inverse / size.unsqueeze(0) / size.unsqueeze(1)


def long_run(scores: Tensor, lags: int) -> Tensor:
    """Bartlett-weighted sum of the autocovariances of (time, p), (p, p).

    A triangle is a box convolved with itself: the products of the moving sums over `lags` + 1 samples, with nothing
    before and behind the record, are the same sum at the price of a single lag.
    """
    whole = scores.sum(0)
    within = min(lags, len(scores))  # more only repeats the sum of all
    sums = torch.nn.functional.pad(scores.cumsum(0), (0, 0, 0, within))
    sums[len(scores) :] = whole
    sums[within + 1 :] = sums[within + 1 :] - sums[: -within - 1]
    return (sums.T @ sums + (lags - within) * torch.outer(whole, whole)) / (lags + 1)


def interval(
    function: Callable[[Tensor], Tensor], shared: Tensor, covariances: Tensor
) -> tuple[float, tuple[float, float]]:
    """Value and 95 % interval of a quantity that depends on the shared coordinates (delta method)."""
    with torch.enable_grad():
        point = shared.clone().requires_grad_()
        value = function(point)
        (slope,) = torch.autograd.grad(value, point)
    half = QUANTILE * float((slope @ covariances @ slope).clamp(min=0).sqrt())
    middle = float(value.detach())
    return middle, (middle - half, middle + half)
