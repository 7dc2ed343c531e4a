"""How well a fit knows what it moved."""

from dataclasses import replace

from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.hypothesis import Outcome, mean_free_places, time_scale
from gear_damping.identification.output_error.uncertainty import covariance

CORRELATED_PERIODS = 3.0  # characteristic times over which residuals may be correlated
SILENT = 0.1  # noise levels that a step of order one moves the records by, in all: less says nothing of a parameter


def covariance_of(outcome: Outcome, evidence: Evidence) -> Tensor:
    """Covariance of the fitted coordinates; residuals may be coloured."""
    scale = time_scale(outcome.hypothesis, evidence)
    fitted = replace(outcome.fitted, prediction=outcome.linearisation)
    mean_free = mean_free_places(outcome.hypothesis, outcome.problem.free)
    return covariance(outcome.problem, fitted, CORRELATED_PERIODS * scale, mean_free)
