"""Second thoughts: causes that give way to others, to simpler ones, or to nothing."""

from dataclasses import replace
from functools import reduce

from gear_damping.explanation.evidence.excess import is_settled
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.trials.bench import RIVALS_LEAVE, smallest
from gear_damping.explanation.trials.score import best_by_effect


def exchanged(state: State) -> State:
    """Earlier causes give way to what explains more now that a further one is known.

    A cause that was accepted while another was missing may have been its neighbour that came nearest to both. What
    does no worse in its place is its rival.
    """
    for place, cause in enumerate(state.accepted[:-1]):
        if len(state.going_with(cause.name)) > 1:  # nothing else carries what needs it
            continue
        if state.bench.budget.refuses(f"other effects in the place of {cause.name}"):
            break
        state = _exchanged_at(state, place)
    return state


def _exchanged_at(state: State, place: int) -> State:
    bench, cause, before = state.bench, state.accepted[place], state.outcome
    without = bench.without(before, cause.name)
    reach = RIVALS_LEAVE * before.fitted.cost
    fits = bench.full_fits(bench.ranked(without), without, before, bench.settings.exchange_share, reach)
    fits = [fit for fit in fits if not fit.differs]
    if fits and fits[0].t > bench.settings.accepted_t and fits[0].is_seen_in_fit:
        best, rivals = bench.simplest(fits[0], fits)
        if best.name != cause.name:
            bench.log(f"{best.name} takes the place of {cause.name} beside the others")
        share = cause.share + state.share_taken(best.outcome)
        return state.with_cause(place, Accepted(best.name, best, share, rivals), best.outcome)
    alike = [fit.name for fit in fits if fit.is_seen_in_fit and bench.is_as_good(fit.outcome, before)]
    rivals = bench.rivals(cause.name, (*cause.confusable, *alike))
    return state.with_cause(place, replace(cause, confusable=rivals))


def simplified(state: State) -> State:
    """Every cause, or the simpler one that it contains where that does as well, or nearly, beside the other causes."""
    return reduce(_simplified_at, range(len(state.accepted)), state)


def _simplified_at(state: State, place: int) -> State:
    bench, cause = state.bench, state.accepted[place]
    simpler = cause.effect.cause.simpler
    if simpler is None or simpler in state.names or len(state.going_with(cause.name)) > 1:
        return state
    without = bench.without(state.outcome, cause.name)
    ranked = bench.ranked(without, {simpler})
    fit = bench.full_fit(ranked[0], without) if ranked else None
    if fit is None:
        return state
    if not bench.is_as_good(fit.outcome, state.outcome) and bench.is_further(state.outcome, fit.outcome):
        return state
    bench.log(f"{simpler} does as well as {cause.name}, with fewer parameters")
    rivals = bench.rivals(simpler, cause.confusable)
    return state.with_cause(place, Accepted(simpler, fit, cause.share, rivals), fit.outcome)


def pruned(state: State) -> State:
    """Without causes whose removal costs nothing that left-out records show, or leaves nothing that is visible."""
    bench = state.bench
    for cause in state.accepted:
        if len(state.accepted) == 1:
            break
        if cause.name not in state.names:  # gone with another
            continue
        without = bench.without(state.outcome, cause.name, bench.spared(state.outcome))
        is_needed = bench.paired_gain(without, state.outcome)[1] >= bench.settings.accepted_t
        if is_needed and not _is_enough(without, state):
            continue
        names = state.going_with(cause.name)
        gone = [other for other in state.accepted if other.name in names]
        left = state.left_of(names, without)
        if not left:
            continue
        bench.log(f"{cause.name} is not needed beside the others")
        state = replace(state, outcome=without, accepted=left, pruned=(*state.pruned, *gone))
    return state


def _is_enough(outcome: Outcome, state: State) -> bool:
    """Whether a search that had come to this model would have ended there."""
    bench = state.bench
    if not is_settled(bench.excess(outcome), state.first, bench.settings):
        return False
    left = bench.assessed(outcome, bench.ranked(outcome))
    return left is not None and not left.visible


def beside_the_others(state: State) -> State:
    """Every cause with those of its rivals that do no worse in its place, now that the other causes are known."""
    return reduce(_beside_the_others_at, range(len(state.accepted)), state)


def _beside_the_others_at(state: State, place: int) -> State:
    bench, cause = state.bench, state.accepted[place]
    rivals = [name for name in bench.rivals(cause.name, cause.confusable) if name not in state.names]
    if not rivals or len(state.going_with(cause.name)) > 1:
        return state.with_cause(place, replace(cause, confusable=()))
    if bench.budget.refuses(f"rivals of {cause.name} beside the others"):
        return state.with_cause(place, replace(cause, confusable=tuple(rivals)))
    without = bench.without(state.outcome, cause.name)
    best = best_by_effect(bench.ranked(without, rivals)).values()
    fits = [bench.full_fit(score, without) for score in best if score.gain > 0]
    kept = [fit for fit in fits if fit is not None and bench.is_as_good(fit.outcome, state.outcome)]
    inside = [fit for fit in kept if not fit.is_at_bound]
    if cause.refit.is_at_bound and inside:  # it stands in for another at the end of what it can be
        instead = smallest(inside)
        bench.log(f"{instead.name} does as well as {cause.name}, which has run into a bound")
        others = bench.rivals(instead.name, [fit.name for fit in inside])
        return state.with_cause(place, Accepted(instead.name, instead, cause.share, others), instead.outcome)
    return state.with_cause(place, replace(cause, confusable=tuple(fit.name for fit in kept)))
