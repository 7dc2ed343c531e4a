"""Where levels of single records begin that a linear model of each record by itself tells."""

from math import pi

import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.fitting import InitialValues
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.trials.score import Score
from gear_damping.identification.oscillator.each_alone import LEAVES, Alone, each_alone
from gear_damping.identification.oscillator.linear_model import DAMPING
from gear_damping.identification.output_error.records import SEPARATOR, FitRecord
from gear_damping.simulation.solver_settings import Solver


def levels_alone(
    score: Score, outcome: Outcome, evidence: Evidence, solver: Solver | None = None
) -> InitialValues | None:
    """Where a fit begins whose records differ by a spring: at the stiffness of each record by itself.

    Records whose frequencies are several lines of their spectra apart have nothing in common with a mean one, from
    which a linearised optimum leads anywhere. None where one model nearly follows them, or none follows each.
    """
    candidate = score.candidate
    if not candidate.own_levels or len(candidate.own_phases) != 1 or not evidence.has_spring:
        return None
    spring = evidence.base.spring
    if candidate.hypothesis.effects[-1].told_alone != spring:
        return None
    alone = alone_beside(outcome, evidence, solver)
    return _begun(alone, score, outcome, str(spring)) if alone else None


def alone_beside(
    outcome: Outcome, evidence: Evidence, solver: Solver | None = None, leaves: float = LEAVES
) -> tuple[Alone, ...]:
    """What each record says by itself, where that is what a model for all of them misses, but for a share of it."""
    pairs = zip(evidence.fitted, outcome.fit_residuals, strict=True)
    left = sum(_of_first_channel(record, residual) for record, residual in pairs)
    return each_alone(evidence.fit, left, evidence.known, solver, leaves)


def _begun(alone: tuple[Alone, ...], score: Score, outcome: Outcome, spring: str) -> InitialValues:
    """Their mean and their spread as coordinates, and the level of each."""
    stiffness = torch.tensor([(2 * pi * one.natural_frequency_hz.value) ** 2 for one in alone], dtype=torch.float64)
    mean, spread = float(stiffness.mean()), float(stiffness.std(correction=0))
    ratios = [one.damping_ratio_percent.value / 100 for one in alone if one.damping_ratio_percent]
    damping = 2 * sum(ratios) / max(len(ratios), 1) * mean**0.5
    ((place, level),) = score.candidate.own_phases.items()
    common, start = score.candidate.hypothesis.common, torch.zeros_like(score.start)
    wanted = {common[place].name: spread, spring: mean} | ({DAMPING: damping} if damping > 0 else {})
    for number, parameter in enumerate(common):
        if parameter.name in wanted:
            start[number] = parameter.coordinate(wanted[parameter.name])
    own = {
        f"{level}{SEPARATOR}{one.record}": float((k - mean) / spread) for one, k in zip(alone, stiffness, strict=True)
    }
    return InitialValues(start[None], outcome, own)


def _of_first_channel(record: FitRecord, residual: torch.Tensor) -> float:
    """The weighted squares that are left of the first channel of a record."""
    return float((record.weight * residual[: len(residual) // len(record.channels)]).square().sum())
