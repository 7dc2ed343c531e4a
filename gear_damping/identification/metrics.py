"""How a prediction is scored. True and predicted damping ratios are in % of critical, (windows,)."""

from collections.abc import Sequence

import torch
from torch import Tensor

RESAMPLES = 1000  # of a bootstrap: the ends of its interval to some per cent of its width


def rmse_percent(true: Tensor, predicted: Tensor) -> float:
    """Root of the mean squared error, sqrt(1/N sum e^2), in % of critical."""
    return float((predicted.double() - true.double()).square().mean().sqrt())


def rmse_paper(true: Tensor, predicted: Tensor) -> float:
    """The error as Yousfi et al. (2026), equation 7, print it: sqrt(1/2 sum e^2), in % of critical.

    It grows with the root of the number of windows, so it compares only equal test sets.
    """
    return float((0.5 * (predicted.double() - true.double()).square().sum()).sqrt())


def median_relative_error(true: Tensor, predicted: Tensor) -> float:
    """Median of |e| / true over the windows, a fraction (not finite where true is 0)."""
    return float(((predicted.double() - true.double()).abs() / true.double()).quantile(0.5))


def skill(true: Tensor, predicted: Tensor, mean_prediction: float) -> float | None:
    """1 - MSE / MSE of always saying `mean_prediction` (the mean of the training labels).

    1 is perfect, 0 is no better than the mean, below 0 is worse. None where the mean predictor makes no
    error at all: with one label there is nothing to learn and no skill to have.
    """
    reference = (mean_prediction - true.double()).square().mean()
    if reference <= (1e-6 * true.double().abs().max()) ** 2:
        return None
    return float(1 - (predicted.double() - true.double()).square().mean() / reference)


def epochs_to_convergence(validation_errors: Sequence[float]) -> int:
    """First epoch, counted from 1, with a validation error within 5 % of the best one (0: no epochs)."""
    if not validation_errors:
        return 0
    limit = 1.05 * min(validation_errors)
    return next(epoch for epoch, error in enumerate(validation_errors, start=1) if error <= limit)


def interval_of_rmse(true: Tensor, predicted: Tensor, runs: Tensor) -> list[float] | None:
    """95 % interval of `rmse_percent` by the bootstrap over runs, whose windows are no independent witnesses.

    None for one run, which says nothing of others (Efron 1979; percentiles).
    """
    _, row = runs.unique(return_inverse=True)
    count = torch.bincount(row).double()
    if len(count) < 2:
        return None
    squares = torch.zeros(len(count), dtype=torch.float64)
    squares.index_add_(0, row, (predicted.double() - true.double()).square())
    generator = torch.Generator().manual_seed(0)
    drawn = torch.randint(len(count), (RESAMPLES, len(count)), generator=generator)
    errors = (squares[drawn].sum(1) / count[drawn].sum(1)).sqrt()
    return errors.quantile(torch.tensor([0.025, 0.975], dtype=torch.float64)).tolist()


def means_over_runs(true: Tensor, predicted: Tensor, runs: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """True value, mean and standard deviation of the predictions over the windows of each run, (runs,)."""
    _, row, count = runs.unique(return_inverse=True, return_counts=True)
    sums = torch.zeros(3, len(count), dtype=torch.float64)
    values = torch.stack([true.double(), predicted.double(), predicted.double().square()])
    label, mean, square = sums.index_add_(1, row, values) / count
    return label, mean, (square - mean.square()).clamp_min(0).sqrt()


def scores(true: Tensor, predicted: Tensor, runs: Tensor, mean_prediction: float) -> dict[str, float | None]:
    """Every score of one estimator on one test set; the last one scores the mean over each run's windows."""
    label, mean, _ = means_over_runs(true, predicted, runs)
    return {
        "rmse_percent": rmse_percent(true, predicted),
        "rmse_paper": rmse_paper(true, predicted),
        "median_relative_error": median_relative_error(true, predicted),
        "skill": skill(true, predicted, mean_prediction),
        "rmse_percent_per_run": rmse_percent(label, mean),
    }
