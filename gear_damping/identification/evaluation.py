"""Estimates of many runs held against the truth, and against the bound of what their records hold."""

from collections.abc import Mapping
from dataclasses import replace
from math import sqrt

import torch
from torch import Tensor

from gear_damping.identification.known_model.estimate import Estimates
from gear_damping.identification.metrics import median_relative_error, rmse_percent, skill
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.runs import Runs
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

FINER = 1e-2  # of the accuracy: of the computation that a run is held against
PARTED = 1e-3  # of a run's deviation by which two computations of it may part


def is_repeatable(runs: Runs, solver: Solver) -> Tensor:
    """Which runs have a bound, (runs,): those that a finer computation repeats.

    Where flanks part and meet again, a motion can be chaotic. A change of its damping by any small amount then makes
    another motion: the sensitivities grow without end, and the bound that they give is nobody's to reach.

    Args:
        runs: As simulated.
        solver: What they were simulated with.
    """
    finer = replace(solver, accuracy=FINER * solver.accuracy, progress=None)
    inputs = Driven(dict(runs.inputs))
    again = simulate(
        runs.model,
        runs.values,
        sampling_rate=runs.sampling_rate,
        n_samples=runs.response.shape[-1],
        inputs=inputs,
        solver=finer,
    )
    apart = (again.response - runs.response).square().mean(-1).sqrt()
    return apart <= PARTED * runs.response.std(-1)


def with_prior(bound: Tensor, ends: tuple[float, float]) -> Tensor:
    """Standard deviation that the bound leaves of a ratio which was uniform beforehand, % (van Trees 1968).

    Args:
        bound: Of the data alone, %, (runs,).
        ends: Smallest and largest ratio.
    """
    before = (ends[1] - ends[0]) / sqrt(12)
    return (1 / (bound**-2 + before**-2)).sqrt()


def scores(true: Tensor, said: Estimates, limit: Tensor | None, mean: float) -> Mapping[str, float | None]:
    """How good estimates are.

    Args:
        true: Damping ratios in %, (runs,).
        said: The estimates.
        limit: Standard deviations that the bound leaves, (runs,); None where there is no bound.
        mean: Of the labels: what knows nothing says.

    Returns:
        `rmse_percent`; `median_relative_error` and `p90_relative_error`; `ratio_to_bound`, the root mean square of the
        error over the limit, `typical_ratio`, the same from its median, as of a normal distribution, which a few runs
        do not rule, and `rmse_to_bound`, over the root mean square of the limits (these None without a limit); `skill`
        against the mean; `coverage90`, None without intervals.
    """
    error = (said.ratio - true).double()
    over = None if limit is None else error / limit
    held = ((said.low <= true) & (true <= said.high)).double().mean()
    relative = (error.abs() / true).double()
    return {
        "rmse_percent": rmse_percent(true, said.ratio),
        "median_relative_error": median_relative_error(true, said.ratio),
        "p90_relative_error": float(relative.quantile(0.9)),
        "ratio_to_bound": None if over is None else float(over.square().mean().sqrt()),
        "rmse_to_bound": None if limit is None else float((error.square().mean() / limit.square().mean()).sqrt()),
        "typical_ratio": None if over is None else float(over.abs().median()) / NORMAL_MEDIAN,
        "skill": skill(true, said.ratio, mean),
        "coverage90": None if bool(torch.isnan(said.low).any()) else float(held),
    }


NORMAL_MEDIAN = 0.6744897501960817  # of the size of a standard normal number
