"""Step 6: the full fit of a candidate, and whether left-out records validate it."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from math import inf, isclose

import torch
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.candidates import EXPONENT, Candidate
from gear_damping.explanation.model.fitting import InitialValues, fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis, Outcome, time_scale
from gear_damping.explanation.model.two_modes import settled
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.statistics.paired import paired_gain
from gear_damping.explanation.trials.levels_alone import levels_alone
from gear_damping.explanation.trials.score import Score, best_by_effect, collinearity
from gear_damping.identification.output_error.least_squares import Ends, Rounds
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.simulation.solver_settings import Solver

NEARLY_COLLINEAR = 0.7  # cosine: half of what one explains the other would
OTHER_FORM = 0.95  # of the predicted gain of an effect's best form, for a full fit of another form
OTHER_SIZED_FORM = 0.5  # the same where forms are tried at a few sizes, between which half of a resonance is missed
LEAST_PREDICTED_GAIN = 0.3  # of the first one's, for a full fit of one that resembles it
BLOCK_TIMES = 6.0  # characteristic times of a block of the paired test,
FEWEST_BLOCKS = 8  # but at least so many blocks: the variance of fewer is anybody's guess
SHORTEST_BLOCK = 4  # samples, however short the characteristic time is beside them
JOINS = 0.5  # of the way to the cost that is to be reached, from where what joins later may take the rest
CAUTIOUS = 0.3  # of the linearised optimum: the second start, where the first one leads too far
FIRST_PART = 0.25  # of the records, by which the better start is chosen
ONE = 1e-9  # share of the starts that goes on: the best
CRAWL = 0.003  # of the cost: a fit that is far from the noise and gets nearer by less at a time is in a wrong valley
AS_WELL = 5.0  # noise variances: no more may be left of a motion that is written otherwise, as of rounding
ENOUGH = 0.1  # noise variances: a tenth of what a parameter of no use gains from noise
TO_ENOUGH = Ends(ENOUGH)
FIRST_ITERATIONS, LAST_ITERATIONS = 10, 30  # over a part of the record, and over all of it
AT_BOUND = 0.05  # of a bound: a parameter as near to it as that has run into it
VARIANTS_KEPT = 0.25  # of the sizes of an effect that is tried as a whole, after the first round


@dataclass(frozen=True)
class Refit:
    """A candidate fitted in full.

    Args:
        score: Its predicted gain.
        outcome: What came of it.
        gain: Mean fall of squared residuals of left-out records.
        t: Its t statistic over blocks.
        fit_gain: Fall of the fitted records' squared residuals, in noise variances.
        is_seen_in_fit: Whether the records to which it was fitted show it: what shows only in conditions that are left
            out is their luck.
    """

    score: Score
    outcome: Outcome
    gain: float
    t: float
    fit_gain: float
    is_seen_in_fit: bool

    @property
    def is_at_bound(self) -> bool:
        """Whether a parameter of the effect itself has run into a bound of what is tried."""
        return runs_into_bound(self.name, self.outcome, self.score.candidate.resting)

    @property
    def name(self) -> str:
        """The effect."""
        return self.score.candidate.name

    @property
    def differs(self) -> bool:
        """Whether it says of itself that it differs from record to record: every law that does would be one, too."""
        return self.score.candidate.own_levels


def runs_into_bound(name: str, outcome: Outcome, resting: Collection[tuple[str, int]]) -> bool:
    """Whether a parameter of an effect is at a bound of what is tried, but for one where it may rest."""
    own = [p for p in outcome.problem.free if p.name.startswith(name + ".")]
    ends = [(p.name, side, end) for p in own for side, end in ((1, p.upper), (-1, p.lower)) if end]
    tried = [(name, end) for name, side, end in ends if (name, side) not in resting]
    return any(isclose(outcome.values[name], end, rel_tol=AT_BOUND) for name, end in tried)


def block_samples(outcome: Outcome, evidence: Evidence, records: Sequence[FitRecord]) -> list[int]:
    """Samples of a block of the paired test, by record; short records have shorter blocks."""
    total = sum(record.duration for record in records)
    seconds = min(BLOCK_TIMES * time_scale(outcome.hypothesis, evidence), total / FEWEST_BLOCKS)
    return [max(SHORTEST_BLOCK, round(seconds * record.sampling_rate)) for record in records]


def chosen(
    scores: Sequence[Score], settings: SearchSettings, least: float = 0.0, laws: bool = False, every: bool = False
) -> list[Score]:
    """The candidates worth a full fit: the best variant of the best effects, and who resembles the first.

    Another form of an effect (a filter of another order) is tried too where its predicted gain is nearly as large, and
    with an effect the simpler one that it contains, which needs to be no more.

    Args:
        scores: Every candidate, the best first.
        settings: How many are worth it.
        least: Of the first one's predicted gain, that another needs.
        laws: Whether every law of stiffness or damping is worth one, as for an oscillator, whose fits are cheap: one
            that is even in the deflection pulls the frequency by its square, one of damping takes its part from what
            another was fitted to, and what is tried as a whole (a sensor that saturates) has little gain at a wrong
            size. No linear score foresees these.
        every: Whether all that promise much are, whether they resemble the first or not.

    What differs from record to record by its own account is worth one where it promises as much as any.
    """
    most = settings.rival_share * scores[0].gain if scores else 0.0
    scores = [score for score in scores if not score.candidate.own_levels or score.gain >= most]
    forms: dict[tuple, Score] = {}
    for score in scores:
        forms.setdefault((score.candidate.name, *score.candidate.form), score)
    variants = list(forms.values())
    ranked = list(best_by_effect(variants).values())
    first = [score for score in ranked[: settings.full_fits] if score.gain >= least * ranked[0].gain]
    promising = [score for score in ranked[settings.full_fits :] if score.gain > LEAST_PREDICTED_GAIN * ranked[0].gain]
    alike = [score for score in promising if every or collinearity(ranked[0], score) > NEARLY_COLLINEAR]
    instead = [score for score in ranked if score.candidate.replaced]  # adds nothing that could overfit: always tried
    far = [score for score in ranked if laws and score.gain > 0 and _is_unforeseen(score.candidate)]
    taken = [*(first + alike)[: settings.most_full_fits], *instead, *far]
    simpler = {score.candidate.hypothesis.effects[-1].cause.simpler for score in taken}
    taken += [score for score in ranked if score.candidate.name in simpler]
    worth = {score.candidate.name: score.gain for score in taken}
    return [s for s in variants if s.gain >= _as_good_a_form(s.candidate) * worth.get(s.candidate.name, inf)]


def _as_good_a_form(candidate: Candidate) -> float:
    return OTHER_SIZED_FORM if candidate.non_nested else OTHER_FORM


def _is_unforeseen(candidate: Candidate) -> bool:
    return candidate.is_law or bool(candidate.non_nested)


def refitted(
    score: Score,
    outcome: Outcome,
    evidence: Evidence,
    solver: Solver | None = None,
    against: Outcome | None = None,
    reach: float = inf,
) -> Refit | None:
    """The candidate's full fit from `outcome`, held against it or another; None where the fit ran away.

    A fit that will not get the cost below `reach` is not carried to its end. What joins later does so where the rest is
    half of the way there: a friction that turns too softly leaves most of what it would take.
    """
    candidate = score.candidate
    hypothesis = candidate.hypothesis
    kept, ends = VARIANTS_KEPT if candidate.non_nested else ONE, Ends(ENOUGH, reach, CRAWL)
    rounds = Rounds((FIRST_ITERATIONS, LAST_ITERATIONS), (FIRST_PART * evidence.duration, None), kept)
    initial = InitialValues(_starts(score), outcome, score.own)
    found = fit_hypothesis(hypothesis, evidence, initial, rounds, ends, solver)
    if (alone := levels_alone(score, outcome, evidence, solver)) is not None:
        apart = fit_hypothesis(hypothesis, evidence, alone, rounds, ends, solver)
        found = min(found, apart, key=lambda one: one.fitted.cost if one.is_finite else inf)
    gone, wanted = (max(outcome.fitted.cost - cost, 0.0) for cost in (found.fitted.cost, reach))
    if candidate.later and gone >= JOINS * wanted:
        found = with_later(found, candidate, evidence, solver, ends)
    if not found.is_finite:
        return None
    if candidate.settled:
        found = _settled(found, candidate.settled, evidence, solver)
    return compared(score, found, against or outcome, evidence)


def _settled(found: Outcome, names: Collection[str], evidence: Evidence, solver: Solver | None) -> Outcome:
    """The same motion with these parameters known, and the others where they make it then."""
    hypothesis = found.hypothesis
    values = settled(found, hypothesis.effects[-1].name)
    free = tuple(
        replace(one, start=values.get(one.name, one.start)) for one in hypothesis.free if one.name not in names
    )
    told = replace(hypothesis, free=free, given=hypothesis.given | values)
    again = fit_hypothesis(told, evidence, ends=TO_ENOUGH, solver=solver)
    return again if again.fitted.cost <= found.fitted.cost + AS_WELL * evidence.noise**2 else found


def with_later(
    found: Outcome, candidate: Candidate, evidence: Evidence, solver: Solver | None, ends: Ends = TO_ENOUGH
) -> Outcome:
    """A fit carried on with what joins later of a candidate in it free too."""
    return fit_hypothesis(_freed(found, candidate), evidence, InitialValues(after=found), ends=ends, solver=solver)


def _freed(found: Outcome, candidate: Candidate) -> Hypothesis:
    """The model with what joins later free too, everything beginning where the fit stands.

    Beside an exponent the logarithm of a strength is fitted, as far as it is a size: force = c |v|^n is a straight
    valley in log(c) and n, and a bent one in c and n, along which a fit creeps where the unit of v is far from the
    motion's.
    """
    hypothesis, at = found.hypothesis, found.hypothesis.given
    steep = any(parameter.declared_name.endswith(f".{EXPONENT}") for parameter in candidate.later)
    sizes = [candidate.hypothesis.common[place].name for place in candidate.strengths] if steep else []
    free = []
    for parameter in (*hypothesis.free, *candidate.later):
        start = float(at.get(parameter.name, parameter.start))
        is_size = parameter.name in sizes and parameter.lower == 0 < start
        free.append(replace(parameter, start=start, logarithmic=parameter.logarithmic or is_size))
    return replace(hypothesis, free=tuple(free))


def again(refit: Refit, against: Outcome, evidence: Evidence, solver: Solver | None = None) -> Refit:
    """A full fit carried on with other evidence, as with the records in segments, and held against another model."""
    found = fit_hypothesis(refit.outcome.hypothesis, evidence, ends=Ends(ENOUGH), solver=solver)
    return compared(refit.score, found, against, evidence)


def compared(score: Score, found: Outcome, against: Outcome, evidence: Evidence) -> Refit:
    """A fit held against another model on left-out records."""
    gain, t = paired_gain(against.left_out, found.left_out, block_samples(against, evidence, evidence.judged))
    fit_gain = (against.fitted.cost - found.fitted.cost) / max(evidence.noise**2, 1e-300)
    return Refit(score, found, gain, t, fit_gain, fit_gain > evidence.settings.seen_in_fit)


def _starts(score: Score) -> Tensor:
    """Coordinates of the starts, (starts, n_free), and those with what stood in for the effect moved back."""
    starts, moved = _initial_values(score), torch.zeros_like(score.start)
    for place, coordinate in score.candidate.moved.items():
        moved[place] = coordinate
    return torch.cat([starts, starts + moved]) if score.candidate.moved else starts


def _initial_values(score: Score) -> Tensor:
    """The linearised optimum and less of it, or every size."""
    candidate = score.candidate
    if not candidate.non_nested:
        starts = score.start.repeat(2, 1)
        starts[1, list(candidate.strengths)] *= CAUTIOUS
        return starts
    return torch.stack([score.start, *(score.start + _apart(other, candidate) for other in score.variants)])


def _apart(other: Candidate, candidate: Candidate) -> Tensor:
    """Coordinates of another size of the candidate, in the candidate's own."""
    pairs = zip(other.hypothesis.common, candidate.hypothesis.common, strict=True)
    ratios = [o.start / p.start if p.logarithmic else 1.0 for o, p in pairs]
    return torch.tensor(ratios, dtype=torch.float64).log()
