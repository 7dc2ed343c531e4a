"""Step 7: add what the held-out records bear out, one cause after another, then drop what is not needed."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from gear_damping.explanation.calibrate import restarted
from gear_damping.explanation.candidates import candidates_for
from gear_damping.explanation.evidence import Evidence
from gear_damping.explanation.hypothesis import Hypothesis, Outcome, fit_hypothesis
from gear_damping.explanation.noise import NoiseLevel
from gear_damping.explanation.ranking import Score, contains, scores
from gear_damping.explanation.refit import Refit, block_samples, chosen, refitted
from gear_damping.explanation.significance import Excess, excess, paired_gain
from gear_damping.identification.output_error.problem import FreeParameter
from gear_damping.physics.terms import Effect
from gear_damping.simulation.solver_settings import Solver

BORNE_OUT = 3.0  # t of the held-out gain that a cause needs
LEAST_SHARE = 0.25  # of the remaining excess that a cause must take
RIVAL = 2.0  # t below which two explanations are not told apart
MOST_CAUSES = 4
MOST_ANEW = 3  # times that a search begins anew from a better calibration
BENT = 4.0  # noise variances left by a nominal model whose free shape is no good place to begin
REST = 0.02  # of the first excess: less is not worth a cause
SAME = 1e-3  # of the noise variance: a mean difference below it is none
Say = Callable[[str], None]


@dataclass(frozen=True)
class Accepted:
    """A cause that held-out records bear out.

    Args:
        name: The effect.
        refit: Its full fit when it was accepted.
        share: Share of the excess that it took, held out.
        confusable: Other effects that fit no worse.
    """

    name: str
    refit: Refit
    share: float
    confusable: tuple[str, ...]

    @property
    def effect(self) -> Effect:
        """The effect itself."""
        return next(e for e in self.refit.outcome.hypothesis.effects if e.name == self.name)


@dataclass
class Search:
    """What the search found.

    Args:
        nominal: The calibrated nominal model.
        outcome: The model at the end.
        accepted: Causes in the order in which they were accepted.
        first_scores: Every candidate's score beside the nominal model.
        rejected: Full fits of the last round that were not accepted.
        first_fits: Full fits of the first round, the best first.
    """

    nominal: Outcome
    outcome: Outcome
    accepted: list[Accepted] = field(default_factory=list)
    first_scores: list[Score] = field(default_factory=list)
    rejected: list[Refit] = field(default_factory=list)
    first_fits: list[Refit] = field(default_factory=list)


def search(nominal: Outcome, evidence: Evidence, noise: NoiseLevel, say: Say, solver: Solver | None = None) -> Search:
    """Extend the nominal model until nothing significant is missing or nothing more is borne out."""
    found = Search(nominal, nominal)
    ranked = found.first_scores = _ranked(nominal, evidence, noise, solver)
    first = current = excess(nominal.holdout, evidence.holdout, noise)
    anew = 0
    while current.significant and len(found.accepted) < MOST_CAUSES:
        if found.accepted:
            fits = _full_fits(ranked, found.outcome, found.outcome, evidence, solver)
        else:
            fits = found.first_fits = _first_fits(found, evidence, current, noise, solver)
        best = _best(fits, evidence, current, noise)
        found.rejected = fits
        if best is None:
            break
        best, rivals = _simplest(best, fits, evidence)
        settled = _settled_without(best, evidence, solver) if anew < MOST_ANEW else None
        if settled is not None:
            anew += 1
            say(f"what {best.name} seemed to take is taken without it: the fit had not come to rest")
            found.outcome = settled
            current = excess(settled.holdout, evidence.holdout, noise)
            ranked = _ranked(settled, evidence, noise, solver)
            if not found.accepted:
                found.nominal, found.first_scores, first = settled, ranked, current
            continue
        after = excess(best.outcome.holdout, evidence.holdout, noise)
        share = (current.percent - after.percent) / max(first.percent, 1e-300)
        found.accepted.append(Accepted(best.name, best, share, rivals))
        say(f"{best.name} takes {100 * share:.1f} % of the excess on held-out records")
        found.outcome, current = best.outcome, after
        if current.percent <= REST * first.percent:
            break
        if len(found.accepted) > 1:
            current = _exchanged(found, evidence, noise, first, say, solver)
            if current.percent <= REST * first.percent:
                break
        ranked = _ranked(found.outcome, evidence, noise, solver)
    found.accepted = [_simplified(cause, found, evidence, noise, say, solver) for cause in found.accepted]
    if len(found.accepted) > 1:
        _prune(found, evidence, say, solver)
        found.accepted = [_beside_the_others(cause, found, evidence, noise, solver) for cause in found.accepted]
    return found


def _settled_without(best: Refit, evidence: Evidence, solver: Solver | None) -> Outcome | None:
    """The model without the effect, fitted from where the effect led, if it does as well there.

    Then the effect has no part in the gain: it only led the fit out of a local minimum.
    """
    hypothesis, states = _without(best.outcome.hypothesis, best.name), best.outcome.fitted.states
    without = fit_hypothesis(hypothesis, evidence, None, states, solver=solver)
    block = block_samples(best.outcome, evidence.sampling_rate)
    return without if _as_good(without, best.outcome, block, evidence.noise) else None


def _ranked(outcome: Outcome, evidence: Evidence, noise: NoiseLevel, solver: Solver | None) -> list[Score]:
    return scores(outcome, evidence, candidates_for(outcome.hypothesis, evidence), noise.value, solver)


def _exchanged(
    found: Search, evidence: Evidence, noise: NoiseLevel, first: Excess, say: Say, solver: Solver | None
) -> Excess:
    """Earlier causes give way to what explains more now that a further one is known; returns what is left.

    A cause that was accepted while another was missing may have been its neighbour that came nearest to both.
    """
    for place, cause in enumerate(found.accepted[:-1]):
        before, states = found.outcome, found.outcome.fitted.states
        without = fit_hypothesis(_without(before.hypothesis, cause.name), evidence, None, states, solver=solver)
        fits = _full_fits(_ranked(without, evidence, noise, solver), without, before, evidence, solver)
        if fits and fits[0].t > BORNE_OUT and fits[0].is_seen_in_fit:
            best, rivals = _simplest(fits[0], fits, evidence)
            gained = excess(before.holdout, evidence.holdout, noise).percent
            gained -= excess(best.outcome.holdout, evidence.holdout, noise).percent
            share = cause.share + gained / max(first.percent, 1e-300)
            if best.name != cause.name:
                say(f"{best.name} takes the place of {cause.name} beside the others")
            found.accepted[place] = Accepted(best.name, best, share, rivals)
            found.outcome = best.outcome
    return excess(found.outcome.holdout, evidence.holdout, noise)


def _full_fits(
    ranked: Sequence[Score], outcome: Outcome, against: Outcome, evidence: Evidence, solver: Solver | None
) -> list[Refit]:
    if not ranked:
        return []
    fits = (refitted(score, outcome, evidence, solver, against) for score in chosen(ranked) if score.gain > 0)
    return sorted((fit for fit in fits if fit is not None), key=lambda fit: fit.outcome.holdout_cost)


def _first_fits(
    found: Search, evidence: Evidence, current: Excess, noise: NoiseLevel, solver: Solver | None
) -> list[Refit]:
    """Full fits of the first round: from the nominal model, and from before its free shape was fitted.

    Where much is missing that shape has bent to what it is not made for, so the other place comes first;
    the second one is tried only where nothing is borne out from the first.
    """
    fits: list[Refit] = []
    for place in ("shaped", "unshaped") if current.misfit < BENT else ("unshaped", "shaped"):
        begin, ranked = found.nominal, found.first_scores
        if place == "unshaped":
            begin = restarted(evidence, solver)
            if begin is None:
                continue
            ranked = _ranked(begin, evidence, noise, solver)
        fits += _full_fits(ranked, begin, found.nominal, evidence, solver)
        fits.sort(key=lambda fit: fit.outcome.holdout_cost)
        if _best(fits, evidence, current, noise):
            break
    return fits


def _best(fits: Sequence[Refit], evidence: Evidence, current: Excess, noise: NoiseLevel) -> Refit | None:
    """The best full fit, where held-out records bear it out."""
    if not fits:
        return None
    best = next((fit for fit in fits if fit.is_seen_in_fit), fits[0])
    after = excess(best.outcome.holdout, evidence.holdout, noise)
    takes = (current.percent - after.percent) / current.percent
    return best if best.is_seen_in_fit and best.t > BORNE_OUT and takes >= LEAST_SHARE else None


def _simplest(best: Refit, fits: Sequence[Refit], evidence: Evidence) -> tuple[Refit, tuple[str, ...]]:
    """The explanation with its rivals, the effects whose full fit is not worse by the paired test.

    Of two of which one contains the other (a friction with two sides contains one with equal sides), the
    smaller is taken where the larger does no better; and of several that the data do not tell apart the one with
    the fewest parameters is named first.
    """
    block = block_samples(best.outcome, evidence.sampling_rate)
    alike = [f for f in fits if f is best or _as_good(f.outcome, best.outcome, block, evidence.noise)]
    inner = [f for f in alike if any(contains(o.score, f.score) for o in alike if o.name != f.name)]
    outer = {f.name for f in alike if any(contains(f.score, other.score) for other in inner if other.name != f.name)}
    kept = [f for f in alike if f.name not in outer] or alike
    first = min(kept, key=lambda fit: (len(fit.outcome.hypothesis.free), fit.outcome.holdout_cost))
    return first, tuple(dict.fromkeys(f.name for f in kept if f.name != first.name))


def _as_good(fit: Outcome, best: Outcome, block: int, noise: float) -> bool:
    gain, t = paired_gain(fit.holdout, best.holdout, block)
    return t < RIVAL or gain < SAME * noise**2


def _simplified(
    cause: Accepted, found: Search, evidence: Evidence, noise: NoiseLevel, say: Say, solver: Solver | None
) -> Accepted:
    """The cause, or the simpler one that it contains where that does as well beside the other causes."""
    simpler = cause.effect.cause.simpler
    if simpler is None or simpler in {accepted.name for accepted in found.accepted}:
        return cause
    states, block = found.outcome.fitted.states, block_samples(found.outcome, evidence.sampling_rate)
    without = fit_hypothesis(_without(found.outcome.hypothesis, cause.name), evidence, None, states, solver=solver)
    tried = [c for c in candidates_for(without.hypothesis, evidence) if c.name == simpler]
    ranked = scores(without, evidence, tried, noise.value, solver)
    fit = refitted(ranked[0], without, evidence, solver) if ranked else None
    if fit is None or not _as_good(fit.outcome, found.outcome, block, evidence.noise):
        return cause
    say(f"{simpler} does as well as {cause.name}, with fewer parameters")
    found.outcome = fit.outcome
    others = tuple(name for name in cause.confusable if name != simpler)
    return Accepted(simpler, fit, cause.share, others)


def _beside_the_others(
    cause: Accepted, found: Search, evidence: Evidence, noise: NoiseLevel, solver: Solver | None
) -> Accepted:
    """The cause with those of its rivals that do no worse in its place, now that the other causes are known."""
    named = {accepted.name for accepted in found.accepted}
    rivals = [name for name in cause.confusable if name not in named]
    if not rivals:
        return replace(cause, confusable=())
    states, block = found.outcome.fitted.states, block_samples(found.outcome, evidence.sampling_rate)
    without = fit_hypothesis(_without(found.outcome.hypothesis, cause.name), evidence, None, states, solver=solver)
    tried = [c for c in candidates_for(without.hypothesis, evidence) if c.name in rivals]
    best: dict[str, Score] = {}
    for score in scores(without, evidence, tried, noise.value, solver):
        best.setdefault(score.candidate.name, score)
    fits = [refitted(score, without, evidence, solver) for score in best.values() if score.gain > 0]
    kept = [f.name for f in fits if f is not None and _as_good(f.outcome, found.outcome, block, evidence.noise)]
    return replace(cause, confusable=tuple(kept))


def _prune(found: Search, evidence: Evidence, say: Say, solver: Solver | None) -> None:
    """Drop a cause whose removal costs nothing that held-out records show."""
    block = block_samples(found.outcome, evidence.sampling_rate)
    for accepted in found.accepted[:-1]:
        without = fit_hypothesis(
            _without(found.outcome.hypothesis, accepted.name),
            evidence,
            None,
            found.outcome.fitted.states,
            solver=solver,
        )
        _, t = paired_gain(without.holdout, found.outcome.holdout, block)
        if t < BORNE_OUT:
            say(f"{accepted.name} is not needed beside the others")
            found.outcome = without
            found.accepted = [other for other in found.accepted if other is not accepted]


def _without(hypothesis: Hypothesis, name: str) -> Hypothesis:
    def other(parameter: FreeParameter) -> bool:
        return not parameter.name.startswith(name + ".")

    return replace(
        hypothesis,
        effects=tuple(effect for effect in hypothesis.effects if effect.name != name),
        given={key: value for key, value in hypothesis.given.items() if not key.startswith(name + ".")},
        free=tuple(parameter for parameter in hypothesis.free if other(parameter)),
        causes=tuple(cause for cause in hypothesis.causes if cause != name),
    )
