"""The evaluation of candidates: score, fit in full, compare on left-out records."""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import reduce
from math import inf
from typing import Any

from gear_damping.explanation.budget import Budget
from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.explanation.model.candidates import Candidate, candidates_for, going_with, restored
from gear_damping.explanation.model.covariance import covariance_of
from gear_damping.explanation.model.fitting import InitialValues, fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis, Outcome
from gear_damping.explanation.trials.assess import Assessment, assessed
from gear_damping.explanation.trials.comparison import Comparison
from gear_damping.explanation.trials.refit import Refit, chosen, compared, refitted, with_later
from gear_damping.explanation.trials.score import Score, Scoring, contains, scores
from gear_damping.explanation.trials.told_size import has_figure, is_told
from gear_damping.identification.output_error.least_squares import Ends, Fitted, Rounds
from gear_damping.identification.output_error.uncertainty import QUANTILE
from gear_damping.physics.systems.traits import Trait
from gear_damping.simulation.solver_settings import Solver

LEAST_TAKEN = 0.25  # of what another takes of the fitted records, for a fit to be carried to its end,
RIVALS_LEAVE = 1.25  # and where that is nearly all that is missing, of what it leaves: only rivals count then
FEW = 8  # strengths of a law and of the harmonics of one: what has more tells single teeth apart or bends to any series
LAST_ITERATIONS = 60  # of a cause that is accepted before its fit has converged
Log = Callable[[str], None]


def nobody(text: str) -> None:
    """Where nobody is told."""


@dataclass(frozen=True)
class Bench(Comparison):
    """Where candidates are tried, and compared.

    Args:
        evidence: The records, with their noise.
        noise: The same in full.
        log: Told what is found on the way.
        solver: Settings of the solver.
        floor: The noise as it was known before any residual was looked at.
        failed: Why an effect could not be fitted in full, by its name.
        budget: The time that is left.
        rough: A gear pair's nominal model before the shape of its stiffness was freed; None where there are no teeth.
        fewer: Models without one of their causes, beside the fit that each was taken from, by that and the cause:
            several steps ask for the same one.
    """

    log: Log
    solver: Solver | None
    floor: NoiseLevel
    failed: dict[str, str] = field(default_factory=dict)
    budget: Budget = field(default_factory=Budget)
    rough: Outcome | None = None
    fewer: dict[tuple[int, str], tuple[Fitted, Outcome]] = field(default_factory=dict, repr=False)

    def __getstate__(self) -> dict[str, Any]:
        """What is kept in a file: who was told goes on in its own process alone, and so do numbers of its objects."""
        return vars(self) | {"log": nobody, "fewer": {}}

    def assessed(self, outcome: Outcome, ranked: Sequence[Score], families: bool = True) -> Assessment | None:
        """What the residuals of a model hold that is not random, and what is; beside families without a name or not."""
        return assessed(outcome, ranked, self.evidence, families)

    def knowing(self, seen: Assessment | None) -> "Bench":
        """The same with the noise that an assessment found: the random part, where little else is left.

        Beside something large the random part takes in what no column follows, and is no noise yet.
        """
        if seen is None or (seen.visible and seen.taken > self.settings.random_share):
            return replace(self, noise=self.floor)
        return replace(self, noise=seen.random.joined(self.floor))

    def ranked(self, outcome: Outcome, names: Collection[str] | None = None) -> list[Score]:
        """Every candidate beside a model, or those of some effects, the most promising first."""
        residuals = list(zip(self.evidence.fitted, outcome.fit_residuals, strict=True))
        tried = candidates_for(outcome.hypothesis, self.evidence, residuals)
        tried = tried if names is None else [candidate for candidate in tried if candidate.name in names]
        scoring = Scoring(self.solver, self.settings.taken_by_all, self.budget.refuses_score)
        found = scores(outcome, tried, self.noise.value, scoring)
        self.budget.asks_again(score.candidate.name for score in found)
        return found

    def noise_cost(self, outcome: Outcome) -> float:
        """Sum of squares that noise alone leaves of the fitted records."""
        return self.evidence.noise**2 * float((outcome.problem.response.weights > 0).sum())

    def beyond_noise(self, outcome: Outcome) -> float:
        """The rest of it."""
        return max(outcome.fitted.cost - self.noise_cost(outcome), 0.0)

    def worth(self, ranked: Sequence[Score], outcome: Outcome, share: float = 1.0) -> list[Score]:
        """Those of the candidates beside a model with causes with enough predicted gain of what it leaves beyond noise.

        About a place of rest fits are cheap, and laws far from linear.

        Args:
            ranked: Scores beside it.
            outcome: The model.
            share: Of what is enough as a further cause.
        """
        if self.evidence.has(Trait.REST):
            return list(ranked)
        least = share * self.settings.least_promise * self.beyond_noise(outcome) / max(outcome.fitted.cost, 1e-300)
        return [score for score in ranked if score.gain >= least or score.candidate.replaced]

    def goal(self, outcome: Outcome) -> float:
        """The cost that a fit has to get below to take as much of what a model leaves as a cause must."""
        return outcome.fitted.cost - self.settings.least_share * self.beyond_noise(outcome)

    def full_fit(
        self, score: Score, outcome: Outcome, against: Outcome | None = None, reach: float = inf
    ) -> Refit | None:
        """A candidate fitted in full from a model and held against one; given up where it cannot reach a cost."""
        return refitted(score, outcome, self.evidence, self.solver, against, reach)

    def full_fits(
        self,
        ranked: Sequence[Score],
        outcome: Outcome,
        against: Outcome,
        predicted_gain: float = 0.0,
        reach: float = inf,
    ) -> tuple[Refit, ...]:
        """The candidates worth it, fitted in full, the best first; one that will not get below `reach` is given up.

        Those with few strengths are fitted first, of these what promises most: one that takes nearly all spares the
        many of another, as of an error of every tooth, and one that can do all that it does and more waits for the next
        round. What promises too little for that comes last.
        """
        if not ranked:
            return ()
        fits: list[Refit] = []
        base = (outcome if outcome.fitted.converged else against).fitted.cost
        worth = chosen(ranked, self.settings, predicted_gain, laws=self.evidence.has(Trait.REST))
        largest = max((score.gain for score in worth), default=0.0)
        enough = self.settings.taken_by_one * largest
        for score in sorted(worth, key=lambda one: (one.gain < enough, has_many(one), -one.gain)):
            if any(self._is_enough(fit, score, base) for fit in fits) or self.waits(score, fits, base):
                continue
            causes = outcome.hypothesis.causes
            is_any = bool(causes) or any(self._is_clear(fit) for fit in fits)
            with self.budget.trying(not fits and not causes, is_any):
                if self.budget.refuses(score.candidate.name):
                    continue
                most = max((base - fit.outcome.fitted.cost for fit in fits), default=0.0)
                is_less = most > 0 and score.gain < largest  # what promises most goes on to its end
                goal = min(reach, self._reach(most, base, against)) if is_less else reach
                fit = self.full_fit(score, outcome, against, goal) if score.gain > 0 else None
            if fit is None and score.gain > 0:
                self.failed[score.candidate.name] = "its full fit ran away"
            fits += [] if fit is None else [fit]
        return tuple(sorted(fits, key=lambda fit: fit.outcome.left_out_cost))

    def waits(self, score: Score, fits: Sequence[Refit], base: float) -> bool:
        """Whether a candidate waits that promises little beside what another takes, late or where that is nearly all.

        It is asked for again beside that one, of whose part it may have been promised some. So does another form of an
        effect of which one came to little of its promise. Without a preload laws are far from linear, and what they
        would come to is not foretold.
        """
        if self.evidence.has(Trait.REST) or score.candidate.replaced:
            return False
        taken = [(fit, _taken(fit, base)) for fit in fits]
        most = max((share for fit, share in taken if self._is_clear(fit)), default=0.0)
        forms = [share / fit.score.gain for fit, share in taken if fit.name == score.candidate.name]
        is_small = score.gain < LEAST_TAKEN * most or (most > 0 and min(forms, default=1.0) < LEAST_TAKEN)
        return is_small and self.budget.postpones(score.candidate.name, most >= self.settings.taken_by_all)

    def _is_clear(self, fit: Refit) -> bool:
        """Whether left-out records validate a fit, and nothing says that it stands in for another."""
        return fit.t > self.settings.accepted_t and fit.is_seen_in_fit and not fit.is_at_bound

    def _is_enough(self, fit: Refit, larger: Score, base: float) -> bool:
        """Whether a full fit takes most of what is promised of a candidate that can do the same and more.

        An error of every tooth does what an eccentricity does, and with its other numbers bends to whatever else is
        missing. What the smaller one leaves is asked for in the next round, the larger one among the answers.
        """
        if not self._is_clear(fit):
            return False
        return _taken(fit, base) >= self.settings.taken_by_one * larger.gain and contains(larger, fit.score)

    def _reach(self, most: float, base: float, against: Outcome) -> float:
        """The cost that another fit has to get below, where one took the `most` of it.

        Without a preload laws are far from linear, and what they would come to is not foretold.
        """
        if self.evidence.has(Trait.PRELOAD) and most >= self.settings.taken_by_all * (base - self.noise_cost(against)):
            return RIVALS_LEAVE * (base - most)
        return base - LEAST_TAKEN * most

    def without(self, outcome: Outcome, name: str, reach: float = inf) -> Outcome:
        """A model without one of its causes, fitted from where it was; given up where it cannot reach a cost."""
        key = (id(outcome.fitted), name)
        if key in self.fewer:
            return self.fewer[key][1]
        hypothesis, initial = _without(outcome.hypothesis, name), InitialValues(after=outcome, is_near=True)
        found = fit_hypothesis(hypothesis, self.evidence, initial, ends=Ends(reach=reach), solver=self.solver)
        is_at_end = reach == inf or found.fitted.converged
        if is_at_end and not self.evidence.is_over():  # which may have cut it short
            self.fewer[key] = outcome.fitted, found
        return found

    def foretold(self, cost: float) -> float:
        """A cost that a fit has to reach, or none without a preload: far from linear a fit foretells nothing of it."""
        return cost if self.evidence.has(Trait.PRELOAD) else inf

    def spared(self, outcome: Outcome) -> float:
        """The cost below which a model without a cause shows that it took less than a cause must.

        Beside a hundred times as much a fit without that cause creeps for half a minute.
        """
        return self.foretold(outcome.fitted.cost / max(1 - self.settings.least_share, 1e-9))

    def until_converged(self, outcome: Outcome, reach: float = inf) -> Outcome:
        """A model whose fit is carried on where it had not converged; given up where it cannot reach a cost."""
        if outcome.fitted.converged:
            return outcome
        initial, rounds = InitialValues(after=outcome, is_near=True), Rounds(LAST_ITERATIONS)
        further = fit_hypothesis(outcome.hypothesis, self.evidence, initial, rounds, Ends(reach=reach), self.solver)
        return further if further.is_finite else outcome

    def converged(self, fit: Refit, against: Outcome, reach: float = inf) -> Refit:
        """A full fit carried on where it had not converged, and held against a model; `reach` as before."""
        if fit.outcome.fitted.converged:
            return fit
        return compared(fit.score, self.until_converged(fit.outcome, reach), against, self.evidence)

    def joined(self, fit: Refit, candidate: Candidate, against: Outcome) -> Refit:
        """A full fit carried on with what joins later of another candidate in it, and held against a model."""
        return compared(
            fit.score, with_later(fit.outcome, candidate, self.evidence, self.solver), against, self.evidence
        )

    def simplest(self, best: Refit, fits: Sequence[Refit]) -> tuple[Refit, tuple[str, ...]]:
        """The explanation with its rivals, the effects whose full fit is not worse by the paired test.

        Of two of which one contains the other (a friction with two sides contains one with equal sides), the
        smaller is taken where the larger does no better; and of several that the data do not tell apart and that
        take about as much the one with the fewest parameters is named first: few records tell hardly anything apart.
        A rival beside which the best one is still visible, and that is
        not visible beside it, is none (Davidson & MacKinnon 1981, Econometrica 49).
        """
        alike = [f for f in fits if f is best or (f.is_seen_in_fit and self._is_rival(f, best))]
        alike = _one_a_size(alike, best)
        inner = [f for f in alike if any(contains(o.score, f.score) for o in alike if o.name != f.name)]
        outer = {f.name for f in alike if any(contains(f.score, o.score) for o in inner if o.name != f.name)}
        kept = self._not_encompassed(best, [f for f in alike if f.name not in outer] or alike)
        sized = self._sized(kept)
        near = [f for f in sized if f.gain >= self.settings.rival_share * best.gain]
        first = self._within_bounds(smallest(near or sized), fits)
        plain = self._plain_form(first, fits)
        return plain, self.rivals(plain.name, [f.name for f in kept if f.name != first.name])

    def named_first(self, best: Refit, rivals: Sequence[Refit]) -> tuple[Refit, list[Refit]]:
        """Of explanations not told apart that fit about as well: the one of a known size with fewest figures."""
        alike = [best, *rivals]
        near = [fit for fit in alike if fit.fit_gain >= self.settings.rival_share * best.fit_gain]
        first = smallest(self._sized(near))
        return first, [fit for fit in alike if fit is not first]

    def rivals(self, name: str, others: Iterable[str]) -> tuple[str, ...]:
        """The other effects of several, each once, but for what contains this one, of which it is the simpler form.

        Nor what is no candidate any more, as an effect whose size was not told from none.
        """
        known = ((one, self.evidence.library.get(one)) for one in others if one != name)
        return tuple(dict.fromkeys(one for one, kind in known if kind is not None and kind.cause.simpler != name))

    def _sized(self, fits: Sequence[Refit]) -> Sequence[Refit]:
        """Those of whose size the records tell anything; all where that is none of several.

        One of any size would be dropped at the end, with what was named beside it.
        """
        return fits if len(fits) == 1 else [fit for fit in fits if self._is_sized(fit)] or fits

    def _is_sized(self, fit: Refit) -> bool:
        told = fit.outcome.is_finite and is_told(fit.outcome, fit, self.evidence)
        return told and has_figure(fit.outcome, fit, self.evidence)

    def _plain_form(self, fit: Refit, fits: Sequence[Refit]) -> Refit:
        """A law, or the simpler one that it contains where it takes too little of what that leaves or has no size."""
        simpler = self.evidence.library[fit.name].cause.simpler
        plain = [one for one in fits if one.name == simpler and one.is_seen_in_fit]
        return next((one for one in plain if self._is_plainer(one, fit)), fit)

    def _is_plainer(self, simpler: Refit, fit: Refit) -> bool:
        if not self.is_further(fit.outcome, simpler.outcome):
            return True
        return self._is_sized(simpler) and not self._is_sized(fit)

    def _not_encompassed(self, best: Refit, alike: Sequence[Refit]) -> list[Refit]:
        """Those that the best explanation does not beat by what the other leaves."""
        if not self.evidence.sealed or len(alike) < 2 or not any(fit is best for fit in alike):
            return list(alike)
        return [f for f in alike if f is best or not self.encompasses(best, f) or self.encompasses(f, best)]

    def encompasses(self, first: Refit, other: Refit) -> bool:
        """Whether one is still visible beside the other: what the other says is then not enough."""
        scores = self.ranked(other.outcome, {first.name})
        seen = self.assessed(other.outcome, scores, families=False) if scores else None
        return seen is not None and seen.visible.shows(first.name)

    def _is_rival(self, fit: Refit, best: Refit) -> bool:
        """Whether it does no worse than the best, or nearly as well and fits the others better.

        Near a resonance a small error of a parameter, as any fit has, weighs more than the law.
        """
        if self.is_as_good(fit.outcome, best.outcome):
            return True
        settings = self.settings
        return fit.gain >= settings.rival_share * best.gain and fit.fit_gain > best.fit_gain + settings.seen_in_fit

    def is_determined(self, fit: Refit, beside: Outcome) -> bool:
        """Whether the records tell the size of an effect, where its fit leaves more than noise and little is taken.

        Where much is left that is not random, a test over blocks takes a further law that can bend to it for one that
        is there; its parameters then hardly matter to the fit. One that takes most of what a model without it leaves
        is more than a bend, though its size may trade against another's (a dry friction against a viscous one).
        """
        if self.excess(fit.outcome).misfit <= self.settings.small_misfit or self.takes_most(fit, beside):
            return True
        covariances = covariance_of(fit.outcome, self.evidence)
        problem, shared = fit.outcome.problem, fit.outcome.fitted.shared
        for place, parameter in enumerate(problem.free):
            if parameter.name.startswith(fit.name + "."):
                half = QUANTILE * float(covariances[place, place].clamp(min=0).sqrt())
                size = 1.0 if parameter.logarithmic else abs(float(parameter.value(shared[place])) / parameter.scale)
                if half <= self.settings.determined * size and not problem.unknowns.at_bound(shared)[place]:
                    return True
        return False

    def _within_bounds(self, first: Refit, fits: Sequence[Refit]) -> Refit:
        """The explanation, or where it has run into a bound and so stands in for another, the one that settles too.

        Not for one of any size, which stands in for another as well.
        """
        if not first.is_at_bound:
            return first
        others = [fit for fit in fits if fit.is_seen_in_fit and not fit.is_at_bound]
        near = [fit for fit in others if fit.gain >= self.settings.rival_share * first.gain]
        close = [fit for fit in others if self.excess(fit.outcome).misfit <= self.settings.settled_misfit]
        return smallest([fit for fit in close or near if self._is_sized(fit)] or [first])


def has_many(score: Score) -> bool:
    """Whether an effect has many numbers, as an error of every tooth, whose fit takes long."""
    return len(score.candidate.strengths) > FEW


def smallest(fits: Sequence[Refit]) -> Refit:
    """The fit with the fewest parameters, a figure of each record last; of several the one that leaves least of all.

    What is left out tells laws apart that grow differently, and may be too little to tell apart what fits alike.
    """

    def leaves(fit: Refit) -> float:
        return fit.outcome.fitted.cost + fit.outcome.left_out_cost

    return min(fits, key=lambda fit: (fit.differs, len(fit.outcome.hypothesis.free), leaves(fit)))


def _one_a_size(fits: Sequence[Refit], best: Refit) -> list[Refit]:
    """Of the forms of an effect with as many parameters the one that leaves least; of the best one's that one."""

    def size(fit: Refit) -> tuple[str, int]:
        return fit.name, len(fit.outcome.hypothesis.free)

    kept = {size(best): best}
    for fit in sorted(fits, key=lambda fit: fit.outcome.left_out_cost):
        kept.setdefault(size(fit), fit)
    return [fit for fit in fits if kept[size(fit)] is fit]


def _without(hypothesis: Hypothesis, name: str) -> Hypothesis:
    """A model without a cause, and without what needs it."""
    gone = going_with(name, hypothesis.effects)
    left = replace(
        hypothesis,
        effects=tuple(effect for effect in hypothesis.effects if effect.name not in gone),
        given={key: value for key, value in hypothesis.given.items() if key.partition(".")[0] not in gone},
        free=tuple(parameter for parameter in hypothesis.free if parameter.name.partition(".")[0] not in gone),
        causes=tuple(cause for cause in hypothesis.causes if cause not in gone),
    )
    return reduce(restored, gone, left)


def _taken(fit: Refit, base: float) -> float:
    """Share of a cost that a full fit takes."""
    return 1 - fit.outcome.fitted.cost / base
