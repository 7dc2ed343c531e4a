"""Step 6: the full fit of a candidate, and whether held-out records bear it out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import torch

from gear_damping.explanation.evidence import Evidence
from gear_damping.explanation.hypothesis import Outcome, fit_hypothesis, natural_frequency_hz
from gear_damping.explanation.ranking import Score, collinearity
from gear_damping.explanation.significance import paired_gain
from gear_damping.simulation.solver_settings import Solver

FULL_FITS = 4  # of the most promising candidates
MOST_FITS = 9  # with those that resemble the first
NEARLY_COLLINEAR = 0.7
LEAST_PROMISE = 0.3  # of the first one's, for a full fit of one that resembles it
BLOCK_PERIODS = 6.0  # natural periods of a block of the paired test
PRESENCE_STARTS = (-1.2, 0.0, 1.2)  # logarithms of the default of an effect that is tried as a whole


@dataclass(frozen=True)
class Refit:
    """A candidate fitted in full.

    Args:
        score: What it promised.
        outcome: What came of it.
        gain: Mean fall of held-out squared residuals.
        t: Its t statistic over blocks.
    """

    score: Score
    outcome: Outcome
    gain: float
    t: float

    @property
    def name(self) -> str:
        """The effect."""
        return self.score.candidate.name


def block_samples(outcome: Outcome, rate: float) -> int:
    """Samples of a block of the paired test."""
    frequency = natural_frequency_hz(outcome.hypothesis.model, outcome.hypothesis.given)
    return max(8, round(BLOCK_PERIODS * rate / frequency))


def chosen(scores: Sequence[Score]) -> list[Score]:
    """The candidates worth a full fit: the best variant of the best effects, and who resembles the first."""
    best: dict[str, Score] = {}
    for score in scores:
        best.setdefault(score.candidate.name, score)
    ranked = list(best.values())
    first = ranked[:FULL_FITS]
    promising = [score for score in ranked[FULL_FITS:] if score.gain > LEAST_PROMISE * ranked[0].gain]
    alike = [score for score in promising if collinearity(ranked[0], score) > NEARLY_COLLINEAR]
    return (first + alike)[:MOST_FITS]


def refitted(
    score: Score, outcome: Outcome, evidence: Evidence, solver: Solver | None = None, against: Outcome | None = None
) -> Refit | None:
    """The candidate's full fit from `outcome`, held against it or another; None where the fit ran away."""
    candidate = score.candidate
    starts = score.start.unsqueeze(0)
    if candidate.presence:
        starts = starts.repeat(len(PRESENCE_STARTS), 1)
        starts[:, candidate.strengths[0]] = torch.tensor(PRESENCE_STARTS, dtype=torch.float64)
    hypothesis = candidate.hypothesis
    found = fit_hypothesis(hypothesis, evidence, starts, outcome.fitted.states, solver=solver)
    if candidate.later:
        freed = replace(found.hypothesis, free=(*found.hypothesis.free, *candidate.later))
        freed = replace(
            freed, free=tuple(replace(p, start=float(found.hypothesis.given.get(p.name, p.start))) for p in freed.free)
        )
        found = fit_hypothesis(freed, evidence, None, found.fitted.states, solver=solver)
    if not torch.isfinite(torch.tensor(found.holdout_cost)):
        return None
    before = (against or outcome).holdout
    gain, t = paired_gain(before, found.holdout, block_samples(outcome, evidence.sampling_rate))
    return Refit(score, found, gain, t)
