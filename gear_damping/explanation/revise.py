"""Second thoughts of the search: causes that give way to others, to simpler ones, or to nothing."""

from dataclasses import replace

from gear_damping.explanation.hypothesis import Outcome
from gear_damping.explanation.ranking import Score
from gear_damping.explanation.significance import Excess, is_settled
from gear_damping.explanation.told import is_told
from gear_damping.explanation.trying import ACCEPTED_AT, Accepted, Bench, Search

PROMISE = 0.6  # of the best one's, for an effect to be tried in the place of a cause


def exchanged(found: Search, first: Excess, bench: Bench) -> None:
    """Earlier causes give way to what explains more now that a further one is known.

    A cause that was accepted while another was missing may have been its neighbour that came nearest to both. What
    does no worse in its place is its rival.
    """
    for place, cause in enumerate(found.accepted[:-1]):
        if bench.budget.refuses(f"other effects in the place of {cause.name}"):
            return
        before = found.outcome
        without = bench.without(before, cause.name)
        fits = bench.full_fits(bench.ranked(without), without, before, PROMISE)
        if fits and fits[0].t > ACCEPTED_AT and fits[0].is_seen_in_fit:
            best, rivals = bench.simplest(fits[0], fits)
            gained = bench.excess(before).percent - bench.excess(best.outcome).percent
            if best.name != cause.name:
                bench.say(f"{best.name} takes the place of {cause.name} beside the others")
            share = cause.share + gained / max(first.percent, 1e-300)
            found.accepted[place] = Accepted(best.name, best, share, rivals)
            found.outcome = best.outcome
        else:
            alike = [fit.name for fit in fits if fit.is_seen_in_fit and bench.is_as_good(fit.outcome, before)]
            rivals = tuple(dict.fromkeys((*cause.confusable, *(name for name in alike if name != cause.name))))
            found.accepted[place] = replace(cause, confusable=rivals)


def simplified(cause: Accepted, found: Search, bench: Bench) -> Accepted:
    """The cause, or the simpler one that it contains where that does as well beside the other causes."""
    simpler = cause.effect.cause.simpler
    if simpler is None or simpler in {accepted.name for accepted in found.accepted}:
        return cause
    without = bench.without(found.outcome, cause.name)
    ranked = bench.ranked(without, {simpler})
    fit = bench.full_fit(ranked[0], without) if ranked else None
    if fit is None or not bench.is_as_good(fit.outcome, found.outcome):
        return cause
    bench.say(f"{simpler} does as well as {cause.name}, with fewer parameters")
    found.outcome = fit.outcome
    return Accepted(simpler, fit, cause.share, tuple(name for name in cause.confusable if name != simpler))


def pruned(found: Search, first: Excess, bench: Bench) -> None:
    """Drop a cause whose removal costs nothing that held-out records show, or leaves nothing that is visible."""
    for accepted in list(found.accepted):
        if len(found.accepted) == 1:
            return
        without = bench.without(found.outcome, accepted.name)
        if bench.paired_gain(without, found.outcome)[1] < ACCEPTED_AT or _is_enough(without, first, bench):
            bench.say(f"{accepted.name} is not needed beside the others")
            found.outcome = without
            left = [other for other in found.accepted if other is not accepted]
            found.accepted = [replace(left[0], share=left[0].share + accepted.share), *left[1:]]


def told(found: Search, bench: Bench) -> None:
    """Drop causes whose size the records do not tell from none."""
    for cause in list(found.accepted):
        if not is_told(found.outcome, cause.refit, bench.evidence):
            bench.say(f"{cause.name} lowers the cost, but its size is not told from none")
            found.outcome = bench.without(found.outcome, cause.name)
            found.accepted = [other for other in found.accepted if other is not cause]
            found.rejected = [cause.refit, *found.rejected]


def _is_enough(outcome: Outcome, first: Excess, bench: Bench) -> bool:
    """Whether a search that had come to this model would have ended there."""
    if not is_settled(bench.excess(outcome), first):
        return False
    left = bench.assessed(outcome, bench.ranked(outcome))
    return left is not None and not left.visible


def beside_the_others(cause: Accepted, found: Search, bench: Bench) -> Accepted:
    """The cause with those of its rivals that do no worse in its place, now that the other causes are known."""
    named = {accepted.name for accepted in found.accepted}
    rivals = [name for name in cause.confusable if name not in named]
    if not rivals:
        return replace(cause, confusable=())
    if bench.budget.refuses(f"rivals of {cause.name} beside the others"):
        return cause
    without = bench.without(found.outcome, cause.name)
    best: dict[str, Score] = {}
    for score in bench.ranked(without, rivals):
        best.setdefault(score.candidate.name, score)
    fits = [bench.full_fit(score, without) for score in best.values() if score.gain > 0]
    kept = [fit for fit in fits if fit is not None and bench.is_as_good(fit.outcome, found.outcome)]
    inside = [fit for fit in kept if not fit.is_at_bound]
    if cause.refit.is_at_bound and inside:  # it stands in for another at the end of what it can be
        best = min(inside, key=lambda fit: (len(fit.outcome.hypothesis.free), fit.outcome.holdout_cost))
        bench.say(f"{best.name} does as well as {cause.name}, which has run into a bound")
        found.outcome = best.outcome
        return Accepted(best.name, best, cause.share, tuple(fit.name for fit in inside if fit is not best))
    return replace(cause, confusable=tuple(fit.name for fit in kept))
