"""Whether the records tell the size of an effect from none.

A law that bends to what another leaves may lower the cost while its own size is anybody's guess.
"""

from collections.abc import Collection, Sequence

import torch
from scipy.stats import chi2
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.covariance import CORRELATED_PERIODS, SILENT, covariance_of
from gear_damping.explanation.model.hypothesis import Outcome, time_scale
from gear_damping.explanation.trials.refit import Refit
from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.records import SEPARATOR
from gear_damping.identification.output_error.uncertainty import QUANTILE, long_run

WITHIN = 1.0  # of a logarithm: the half of its 95 % interval, beyond which no size is known
INDEPENDENT = 1e-3  # of the largest singular value: less is a direction in which strengths do nothing but rounding


def is_told(outcome: Outcome, refit: Refit, evidence: Evidence) -> bool:
    """Whether the strengths of a cause are told from none, together and, where each does something, one at least alone.

    A Wald test along the strengths that were found: what they change of the prediction, everything else that is free
    projected out, against what coloured residuals would do in its direction. The shape of the cause (an exponent, a
    width) is taken as it was found: beside it a strength may be any and the law still be certain.

    Args:
        outcome: The model with the cause.
        refit: The fit with which the cause was accepted.
        evidence: The records.
    """
    candidate = refit.score.candidate
    neutral = {candidate.hypothesis.common[i].name: candidate.hypothesis.common[i].start for i in candidate.strengths}
    problem, shared = outcome.problem, outcome.fitted.shared
    places = [i for i, parameter in enumerate(problem.free) if parameter.name in neutral]
    if not places:
        return True
    if candidate.non_nested:
        shape = [i for i, p in enumerate(problem.free) if p.name.startswith(f"{refit.name}.") and i not in places]
        return _are_sized(outcome, places, shape if candidate.replaced else [], evidence)
    away = [float(problem.free[i].value(shared[i])) - neutral[problem.free[i].name] for i in places]
    free = [problem.free[i] for i in places]
    size = torch.tensor([1.0 if p.logarithmic else a / p.scale for p, a in zip(free, away, strict=True)])
    size = size.to(torch.float64)
    columns = _orthogonal_columns(outcome, places, refit.name)
    singular_values = torch.linalg.svdvals(columns / columns.norm(dim=0).clamp(min=1e-300))
    rank = int((singular_values > INDEPENDENT * singular_values[0]).sum())
    seconds = CORRELATED_PERIODS * time_scale(outcome.hypothesis, evidence)
    lags = [round(seconds * record.sampling_rate) for record in problem.records]
    if _statistic(outcome, columns @ size, lags) < float(chi2.ppf(1 - evidence.settings.told_level, max(rank, 1))):
        return False
    if rank < len(places):
        return True
    each = range(len(places))
    alone = [_without(columns[:, [k]], columns[:, [o for o in each if o != k]])[:, 0] * size[k] for k in each]
    limit = float(chi2.ppf(1 - evidence.settings.told_alone_level, 1))
    return max(_statistic(outcome, column, lags) for column in alone) > limit


def has_figure(outcome: Outcome, refit: Refit, evidence: Evidence) -> bool:
    """Whether one figure at least of a cause is known within itself, by the noise, or the cause has none."""
    phases = refit.score.candidate.names_of_phases
    return not without_a_figure(outcome, [refit.name], covariance_of(outcome, evidence), evidence, phases)


def without_a_figure(
    outcome: Outcome, names: Sequence[str], covariances: Tensor, evidence: Evidence, phases: Collection[str] = ()
) -> str:
    """The first of several causes that has figures and not one of them known within itself; empty where none has.

    It bends to any motion. What a figure does not move any more (a gap whose far flank is never touched) bends to none:
    flanks part, however wide it is.

    Args:
        outcome: The model with the causes.
        names: The causes.
        covariances: How well its coordinates are known.
        evidence: The records.
        phases: Names of what is no size: from where an angle counts is anybody's choice.
    """
    free, shared = outcome.problem.free, outcome.fitted.shared
    half = QUANTILE * covariances.diagonal().clamp(min=0).sqrt()

    def is_known(i: int) -> bool:
        within = WITHIN if free[i].logarithmic else abs(float(free[i].value(shared[i]))) / free[i].scale
        return float(half[i]) < within

    moves = _moving(outcome, evidence)
    sizes = [i for i, p in enumerate(free) if moves[i] and p.name.partition(SEPARATOR)[0] not in phases]
    own = {name: [i for i in sizes if free[i].name.startswith(f"{name}.")] for name in names}
    return next((name for name, places in own.items() if places and not any(map(is_known, places))), "")


def _are_sized(outcome: Outcome, places: list[int], shape: list[int], evidence: Evidence) -> bool:
    """Whether the sizes of what is tried as a whole are known at all, each within a factor.

    There is no none of it to compare with: an absorber without mass, a stop out of reach, a stiff bearing are at the
    end of a logarithm. What a size does not move any more (a gap whose far flank is never touched) is no size. What
    took the place of a linear spring is that spring again where nothing of its `shape` (a length) does anything.
    """
    singular_values, free = covariance_of(outcome, evidence), outcome.problem.free
    half = QUANTILE * singular_values.diagonal().clamp(min=0).sqrt()
    moves = _moving(outcome, evidence)
    if shape and not any(moves[i] and half[i] <= WITHIN for i in shape):
        return False
    return not any(free[i].logarithmic and moves[i] and half[i] > WITHIN for i in places)


def _moving(outcome: Outcome, evidence: Evidence) -> list[bool]:
    """By coordinate, whether it changes the prediction by more than nothing."""
    columns = outcome.fitted.prediction.sensitivity.unbind(-1)
    return [float(column.norm()) >= SILENT * evidence.noise for column in columns]


def _orthogonal_columns(outcome: Outcome, places: list[int], cause: str) -> Tensor:
    """What the strengths change, (samples + n, strengths), all that is free but the cause's own shape projected out.

    The last n rows are what is known of the n shared parameters: a strength may trade against a stiffness and an
    inertia together, and these are stated.
    """
    problem, prediction = outcome.problem, outcome.fitted.prediction
    sensitivity = prediction.sensitivity[0]
    orthogonal = project_out(
        sensitivity[..., : problem.n_shared], nuisance_basis(sensitivity, problem.n_shared)
    ).flatten(0, 1)
    _, slope = problem.expectation(outcome.fitted.shared, prediction.residual[0])
    orthogonal = torch.cat([orthogonal, torch.diag(slope)])
    others = [i for i, p in enumerate(problem.free) if i not in places and not p.name.startswith(cause + ".")]
    return _without(orthogonal[:, places], orthogonal[:, others])


def _without(columns: Tensor, others: Tensor) -> Tensor:
    """Columns (samples, n) without what other ones (samples, m) could do."""
    return project_out(columns, torch.linalg.qr(others / others.norm(dim=0).clamp(min=1e-300)).Q)


def _statistic(outcome: Outcome, change: Tensor, lags: list[int]) -> float:
    """Square of the energy of a change over the variance of its product with the residuals; coloured or white.

    Its last rows, beyond the samples, are what is known of the parameters, which is as noise.
    """
    residual = outcome.fitted.prediction.residual[0]
    shown, known = change[: residual.numel()], change[residual.numel() :]
    products = (shown.reshape(residual.shape) * residual).unsqueeze(-1)
    of_known = float(known.square().sum()) * float(outcome.problem.level(residual)) ** 2
    energy = float(change.square().sum())
    power = float(residual.square().sum()) / max(float((outcome.problem.response.weights > 0).sum()), 1.0)
    coloured = sum(float(long_run(one, lag)) for one, lag in zip(products, lags, strict=True)) + of_known
    return energy**2 / max(coloured, energy * power, 1e-300)
