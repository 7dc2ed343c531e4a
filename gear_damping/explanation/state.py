"""What is known so far: every step of a search takes a state and gives the next."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from gear_damping.explanation.evidence.excess import Excess, excess
from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.explanation.model.candidates import Candidate, going_with
from gear_damping.explanation.model.covariance import covariance_of, wider_of_both
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.own_phases import own_levels
from gear_damping.explanation.trials.assess import Assessment
from gear_damping.explanation.trials.bench import Bench
from gear_damping.explanation.trials.refit import Refit, compared, runs_into_bound
from gear_damping.explanation.trials.score import Score
from gear_damping.explanation.trials.told_size import without_a_figure
from gear_damping.physics.terms import Effect

FREELY_NAMED = 2  # causes whose size may be anybody's guess when they are accepted


@dataclass(frozen=True)
class Accepted:
    """A cause that left-out records validate.

    Args:
        name: The effect.
        refit: Its full fit when it was accepted.
        share: Share of the excess that it took on left-out records.
        confusable: Other effects that fit no worse.
        score: Its own score, where the full fit is that of another that was accepted with it.
    """

    name: str
    refit: Refit
    share: float
    confusable: tuple[str, ...]
    score: Score | None = None

    @property
    def candidate(self) -> Candidate:
        """The form in which it was tried."""
        return (self.score or self.refit.score).candidate

    @property
    def looks_like(self) -> tuple[str, ...]:
        """Effects that are never tried and that no record of this channel can tell from it."""
        return self.effect.cause.alike(self.refit.outcome.values_of(self.name))

    def runs_into_bound(self, outcome: Outcome) -> bool:
        """Whether a parameter of the effect is at a bound in a model."""
        return runs_into_bound(self.name, outcome, self.candidate.resting)

    @property
    def effect(self) -> Effect:
        """The effect itself."""
        return next(e for e in self.refit.outcome.hypothesis.effects if e.name == self.name)


@dataclass(frozen=True)
class State:
    """Where a search stands.

    Args:
        bench: Where candidates are tried, with the noise as it is known now.
        nominal: The calibrated nominal model.
        outcome: The model with the causes that were accepted.
        accepted: These causes in the order in which they were accepted.
        ranked: Every candidate's score beside that model.
        first_scores: The same beside the nominal model.
        rejected: Full fits of the last round that were not accepted.
        first_fits: Full fits of the first round, the best first.
        carried_on: Full fits to other evidence that are carried on.
        seen: What the residuals of the nominal model hold; None where that was not found out.
        left: What those of the model hold.
        calibrations: How often the nominal model has been calibrated anew.
        unsized: Causes that were dropped because the records do not tell their size from none.
        pruned: Causes that were not needed beside others.
        passed: States on the way, one for every cause that was added.
    """

    bench: Bench
    nominal: Outcome
    outcome: Outcome
    accepted: tuple[Accepted, ...] = ()
    ranked: tuple[Score, ...] = ()
    first_scores: tuple[Score, ...] = ()
    rejected: tuple[Refit, ...] = ()
    first_fits: tuple[Refit, ...] = ()
    carried_on: tuple[Refit, ...] = ()
    seen: Assessment | None = None
    left: Assessment | None = None
    calibrations: int = 0
    unsized: frozenset[str] = frozenset()
    pruned: tuple[Accepted, ...] = ()
    passed: tuple["State", ...] = field(default=(), repr=False)

    @property
    def first(self) -> Excess:
        """What the nominal model leaves of conditions that are left out."""
        return self.bench.excess(self.nominal)

    @property
    def current(self) -> Excess:
        """What the model leaves of them."""
        return self.bench.excess(self.outcome)

    def beyond_sensor(self, outcome: Outcome) -> Excess:
        """What a model leaves beyond the noise as it was known before any residual was looked at."""
        return replace(self.bench, noise=self.bench.floor).excess(outcome)

    @property
    def noise(self) -> NoiseLevel:
        """The noise as it is known now."""
        return self.bench.noise

    @property
    def failed(self) -> Mapping[str, str]:
        """Why an effect could not be fitted in full, by its name."""
        return self.bench.failed

    @property
    def names(self) -> frozenset[str]:
        """The effects that were accepted."""
        return frozenset(cause.name for cause in self.accepted)

    def going_with(self, name: str) -> frozenset[str]:
        """A cause and the others that need it, which go where it goes."""
        return going_with(name, self.outcome.hypothesis.effects)

    def passed_without(self, name: str) -> Outcome | None:
        """The best model that has all the causes but one, and what needs it, and was fitted on the way; if any was."""
        kept = self.names - self.going_with(name)
        fits = [fit.outcome for fit in (*self.first_fits, *self.rejected)]
        ways = [outcome for outcome in (*fits, *(one.outcome for one in self.passed)) if outcome.is_finite]
        alike = [outcome for outcome in ways if set(outcome.hypothesis.causes) == kept]
        return min(alike, key=lambda outcome: outcome.fitted.cost, default=None)

    def is_at_bound(self, cause: Accepted) -> bool:
        """Whether a parameter of a cause has run into a bound: alone in its own full fit too, or beside the others.

        While another cause is missing a law bends to what that leaves, and it is no less there beside it.
        """
        alone = len(self.accepted) <= 1 and cause.runs_into_bound(cause.refit.outcome)
        return alone or cause.runs_into_bound(self.outcome)

    def of_no_figure(self, scatter: bool) -> tuple[str, ...]:
        """Causes of which not one figure is known within itself, by the noise, or by the scatter between records too.

        Where a cause says that records differ, they need not agree.
        """
        outcome, evidence = self.outcome, self.bench.evidence
        if not self.accepted:
            return ()
        covariances = covariance_of(outcome, evidence)
        if scatter and not own_levels(outcome):
            covariances = wider_of_both(covariances, outcome)
        causes = ((cause.name, cause.candidate.names_of_phases) for cause in self.accepted)
        return tuple(
            name for name, phases in causes if without_a_figure(outcome, [name], covariances, evidence, phases)
        )

    @property
    def needs_known_size(self) -> bool:
        """Whether a further cause counts only where its size is known: beside so many a law bends to what is left."""
        return len(self.accepted) >= FREELY_NAMED

    @property
    def error_amplification(self) -> float:
        """How much an error of the initial state grows over a record, by the model or the best of the first round."""
        best = [fit.outcome for fit in self.first_fits[:1] if fit.is_seen_in_fit]
        return max(outcome.error_amplification for outcome in (self.nominal, self.outcome, *best))

    @property
    def is_unpredictable(self) -> bool:
        """Whether records were predicted over more than they can be: nothing of that counts."""
        return self.error_amplification > self.bench.settings.most_growth and not self.bench.evidence.segments

    def is_validated(self, fit: Refit) -> bool:
        """Whether left-out records bear a further cause out by their power.

        Where other records hardly show what one does, as one at resonance, that may be so though the model leaves less
        than chance may.
        """
        settings, beyond = self.bench.settings, self.beyond_sensor if self.is_far_off else self.bench.excess
        left = beyond(self.outcome).percent
        is_enough = left > 0 and left - beyond(fit.outcome).percent >= settings.least_share * left
        return is_enough and fit.is_seen_in_fit and fit.t > settings.accepted_t

    def is_validated_beside(self, fit: Refit, before: Outcome) -> bool:
        """The same where another model is what it is held against."""
        held = compared(fit.score, fit.outcome, before, self.bench.evidence)
        return replace(self, outcome=before).is_validated(held)

    @property
    def is_far_off(self) -> bool:
        """Whether the nominal model misses so much of what it is fitted to that its errors elsewhere hide the rest.

        Of one record it tells a part that it has not seen no better than by chance then, whatever is missing.
        """
        gross, bench = self.bench.settings.gross_percent, self.bench
        if self.first.threshold <= gross:
            return False
        return excess(self.nominal.fit_residuals, bench.evidence.fitted, bench.floor, bench.settings).percent > gross

    def with_itself_passed(self) -> "State":
        """The same, which a search may come back to."""
        return replace(self, passed=(*self.passed, self))

    def with_cause(self, place: int, cause: Accepted, outcome: Outcome | None = None) -> "State":
        """The same with another cause in one place, and the model that goes with it."""
        accepted = (*self.accepted[:place], cause, *self.accepted[place + 1 :])
        return replace(self, accepted=accepted, outcome=outcome or self.outcome)

    def without_unsized(self) -> "State":
        """The same where effects whose size was not told from none are no candidates any more."""
        evidence, names = self.bench.evidence, self.unsized
        library = {name: effect for name, effect in evidence.library.items() if name not in names}
        bench = replace(self.bench, evidence=replace(evidence, library=library))
        first = tuple(score for score in self.first_scores if score.candidate.name not in names)
        outcome = self.outcome if self.accepted else self.nominal
        return replace(self, bench=bench, outcome=outcome, first_scores=first, carried_on=(), unsized=frozenset())

    def accepting(self, best: Refit, rivals: tuple[str, ...] = ()) -> "State":
        """The same with a further cause."""
        state, outcome, bench = self, self.bench.until_converged(best.outcome), self.bench
        if self.is_far_off and bench.evidence.sealed:  # the errors of the better model count from here
            state = replace(self, bench=replace(bench, noise=replace(bench.noise, scatter=outcome.scatter)))
        share = min(state.share_taken(outcome), 1.0)
        bench.log(f"{best.name} takes {100 * share:.1f} % of the excess on left-out records")
        return replace(state, outcome=outcome, accepted=(*self.accepted, Accepted(best.name, best, share, rivals)))

    def left_of(self, gone: Collection[str], outcome: Outcome) -> tuple[Accepted, ...]:
        """The causes without some, the first of them with what those took in its place.

        Two that came together have half of their share each, and one that takes all by itself has then no less.

        Args:
            gone: Names.
            outcome: The model without them.
        """
        kept = tuple(cause for cause in self.accepted if cause.name not in gone)
        if not kept:
            return ()
        taken = sum(cause.share for cause in self.accepted if cause.name in gone)
        over = taken - self.share_between(outcome, self.outcome)
        return (replace(kept[0], share=kept[0].share + over), *kept[1:])

    def share_taken(self, outcome: Outcome) -> float:
        """What another model takes of what this one leaves, as a share of what the nominal one leaves."""
        return self.share_between(self.outcome, outcome)

    @property
    def takes_nearly_all(self) -> bool:
        """Whether the causes take of the first excess what establishes them though something is left."""
        return (
            bool(self.accepted) and self.share_between(self.nominal, self.outcome) >= self.bench.settings.taken_by_all
        )

    def share_between(self, before: Outcome, after: Outcome) -> float:
        """The fall of the excess on left-out records over the first one; that of all residuals if there was none."""
        if self.first.percent > 0:
            return (self.bench.excess(before).percent - self.bench.excess(after).percent) / self.first.percent
        return (before.left_out_cost - after.left_out_cost) / max(self.nominal.left_out_cost, 1e-300)
