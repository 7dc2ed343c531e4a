"""How well a fit knows what it moved."""

from dataclasses import replace

import torch
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome, mean_free_places, places_of, time_scale
from gear_damping.explanation.model.own_phases import own_levels
from gear_damping.identification.output_error.problem import Prediction
from gear_damping.identification.output_error.records import SEPARATOR
from gear_damping.identification.output_error.uncertainty import covariance, without_one

CORRELATED_PERIODS = 3.0  # characteristic times over which residuals may be correlated
FEWEST = 3  # records, or segments, that tell whether they agree: the scatter of two is anybody's guess
SILENT = 0.1  # noise levels that a step of order one moves the records by, in all: less says nothing of a parameter


def covariance_of(outcome: Outcome, evidence: Evidence, linearised: Prediction | None = None) -> Tensor:
    """Covariance of the fitted coordinates; residuals may be coloured.

    Args:
        outcome: The fit.
        evidence: The records.
        linearised: In the place of the outcome's own linearisation.
    """
    scale = time_scale(outcome.hypothesis, evidence)
    fitted = replace(outcome.fitted, prediction=linearised or outcome.linearisation)
    return covariance(outcome.problem, fitted, CORRELATED_PERIODS * scale, _known_means(outcome))


def moves_without_one(outcome: Outcome) -> Tensor:
    """By how much the fitted coordinates move without one record, or one segment where there are few, (n, n_shared)."""
    fitted = replace(outcome.fitted, prediction=outcome.linearisation)
    return without_one(outcome.problem, fitted, groups_of(outcome)[0], _known_means(outcome))


def _known_means(outcome: Outcome) -> list[list[int]]:
    """Places of parameters whose mean is 0: it acts on nothing, or they count from it."""
    free = outcome.problem.free
    levels = [level + SEPARATOR for _, level in own_levels(outcome).values()]
    return [*mean_free_places(outcome.hypothesis, free), *places_of(levels, free)]


def wider_of_both(covariances: Tensor, outcome: Outcome) -> Tensor:
    """The covariance, with no coordinate known better than by how it moves without one record each (the jackknife).

    Forms of several causes that are each a little wrong trade against each other in every record in its own way, and
    the noise knows nothing of it. Segments of few records are no draws of one condition: of a decay the last one alone
    may tell of a friction.
    """
    if not has_records(outcome):
        return covariances
    moves = moves_without_one(outcome)
    scatter = (len(moves) - 1) * moves.var(0, correction=0)
    more = (scatter - covariances.diagonal()).clamp(min=0).nan_to_num(0.0, 0.0, 0.0)
    return covariances + torch.diag(more)


def has_records(outcome: Outcome) -> bool:
    """Whether there are records enough to scatter."""
    return len({row.record for row in outcome.problem.records}) >= FEWEST


def groups_of(outcome: Outcome) -> tuple[list[int], list[str]]:
    """Group of every row of the problem, and the groups' names: records, or segments where there are too few."""
    rows = outcome.problem.records
    names = list(dict.fromkeys(row.record for row in rows))
    if len(names) >= FEWEST:
        return [names.index(row.record) for row in rows], names
    return list(range(len(rows))), [f"{row.record} at {row.begins:.3g} s" for row in rows]
