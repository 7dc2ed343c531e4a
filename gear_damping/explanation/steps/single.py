"""A further cause: the effect that takes most of what is left, where left-out records bear it out."""

from collections.abc import Sequence
from dataclasses import replace

from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.nominal_gear_pair import shaped
from gear_damping.explanation.state import State
from gear_damping.explanation.trials.refit import Refit, again
from gear_damping.explanation.trials.score import Score


def single_cause(state: State) -> tuple[State, Refit | None, tuple[str, ...]]:
    """The state with the fits that were made, the next cause and its rivals; None where nothing more is borne out."""
    bench = state.bench
    if state.accepted:
        fits = bench.full_fits(bench.worth(state.ranked, state.outcome), state.outcome, state.outcome)
    else:
        fits = _first_fits(state)
        state = replace(state, first_fits=fits)
    state = replace(state, rejected=fits)
    if state.is_unpredictable:
        return state, None, ()
    fits = _rivals_at_rest(fits, state)
    state = replace(state, rejected=fits)
    best = _best(fits, state)
    if best is None or (state.needs_known_size and not bench.is_determined(best)):
        return state, None, ()
    return state, *bench.simplest(best, fits)


def _first_fits(state: State) -> tuple[Refit, ...]:
    """Full fits of the first round: from the nominal model, and from before its free shape was fitted.

    Where much is missing that shape has bent to what it is not made for, so the other place comes first;
    the second one is tried only where nothing is borne out from the first.
    """
    bench = state.bench
    fits = [again(refit, state.nominal, bench.evidence, bench.solver) for refit in state.begun]
    is_bent = state.current.misfit >= bench.settings.bent_misfit
    for place in (_unshaped, _shaped) if is_bent else (_shaped, _unshaped):
        begun = place(state)
        if begun is None:
            continue
        fits += bench.full_fits(begun[1], begun[0], state.nominal)
        fits.sort(key=lambda fit: fit.outcome.left_out_cost)
        if _best(fits, state):
            break
    return tuple(fits)


def _shaped(state: State) -> tuple[Outcome, Sequence[Score]] | None:
    return state.nominal, state.first_scores


def _unshaped(state: State) -> tuple[Outcome, Sequence[Score]] | None:
    """The nominal model before its shape was fitted, with the scores beside it; None where there is none, or no time.

    Where much is missing, the free shape bends to what it is not made for; a cause is better sought from here.
    """
    bench = state.bench
    if bench.rough is None or bench.evidence.segments:
        return None
    if bench.budget.refuses("effects from before the shape of the stiffness was fitted"):
        return None
    outcome = shaped(bench.rough, bench.evidence, 0, bench.solver)
    return outcome, bench.ranked(outcome)


def _rivals_at_rest(fits: Sequence[Refit], state: State) -> tuple[Refit, ...]:
    """The fits, the best ones carried to their ends: what has not converged is no rival yet, and no winner."""
    best, bench = _best(fits, state), state.bench
    if best is None:
        return tuple(fits)
    against = state.outcome if state.accepted else state.nominal
    alike = [fit for fit in fits if fit is best or bench.is_as_good(fit.outcome, best.outcome)]
    ends = [bench.converged(fit, against) if any(fit is one for one in alike) else fit for fit in fits]
    return tuple(sorted(ends, key=lambda fit: fit.outcome.left_out_cost))


def _best(fits: Sequence[Refit], state: State) -> Refit | None:
    """The best full fit, where left-out records bear it out."""
    best = next((fit for fit in fits if fit.is_seen_in_fit), None)
    if best is None:
        return None
    current, settings = state.current, state.bench.settings
    takes = (current.percent - state.bench.excess(best.outcome).percent) / current.percent
    return best if best.t > settings.accepted_t and takes >= settings.least_share else None
