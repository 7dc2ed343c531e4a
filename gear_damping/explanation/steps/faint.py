"""Step 6b: causes that the power of left-out residuals is too blunt for, but the score of the residuals shows.

Residuals of left-out records are compared by the whole of their power; what an effect would add to a prediction is
compared with the residual itself here (Clark & West 2007), which needs a tenth of that power.
"""

from collections.abc import Sequence
from dataclasses import replace

from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.state import State
from gear_damping.explanation.trials.assess import Assessment
from gear_damping.explanation.trials.bench import Bench, has_many
from gear_damping.explanation.trials.refit import Refit, chosen, compared
from gear_damping.explanation.trials.score import Score, best_by_effect
from gear_damping.physics.systems.traits import Trait


def faint_cause(state: State) -> tuple[State, Refit | None, tuple[str, ...]]:
    """The state with the fits that were made, the next cause and its rivals; None where none is confirmed.

    Tried is what shows most, and besides what promises a good part of all that is left: beside coloured residuals,
    which may be its own doing, it need not show, and what shows as its shadow must not keep it out. About a place of
    rest, where fits are cheap, every law is. Beside a cause what is not among the first few has to take most of what is
    left.
    """
    seen, bench = state.left, state.bench
    if seen is None:
        return state, None, ()
    best = best_by_effect(state.ranked)
    shown = sorted((n for n in best if seen.visible.shows(n)), key=lambda n: -seen.visible.by_name[n])
    names = shown[: bench.settings.full_fits]
    names += [n for n in best if n not in names and best[n].gain >= bench.settings.least_share]
    names = names[: bench.settings.most_full_fits]
    foreseen = {*names[: bench.settings.full_fits]} if state.accepted else {*best}  # at first any law may be meant
    if names and bench.evidence.has(Trait.REST):  # laws take their part from each other
        likely = chosen(state.ranked, bench.settings, laws=True, every=True)
        names += [name for name in best_by_effect(likely) if name not in names]
    may_differ = all(cause.candidate.own_levels for cause in state.accepted)  # beside a law another would differ too
    differing = [name for name in names if best[name].candidate.own_levels and may_differ]
    names = [name for name in names if best[name].gain > 0 and not best[name].candidate.own_levels]
    fits = _fitted([best[name] for name in names], state)
    fits = [bench.converged(fit, state.outcome) if fit.gain > 0 else fit for fit in fits]
    fits = [fit for fit in fits if fit.name in foreseen or bench.takes_most(fit, state.outcome)]
    worth = [fit for fit in fits if _is_worth(fit, state.outcome, seen, bench)]
    state = replace(state, rejected=tuple(fits), first_fits=state.first_fits or tuple(fits))
    validated = [fit for fit in fits if state.is_validated(fit)]
    if state.needs_known_size:
        worth, validated = (
            [fit for fit in some if bench.is_determined(fit, state.outcome)] for some in (worth, validated)
        )
    if validated:
        best = min(validated, key=lambda fit: fit.outcome.left_out_cost)
        return state, *bench.simplest(best, fits)
    if not worth:
        return _of_records([best[name] for name in differing], state)
    first = max(worth, key=lambda fit: fit.fit_gain)
    rivals = [fit for fit in worth if fit is not first and not bench.encompasses(first, fit)]
    simpler = [fit for fit in rivals if fit.name == _simpler(first, bench)]
    if simpler:
        rivals = [fit for fit in (first, *rivals) if fit is not simpler[0]]
        first = simpler[0]
    first, rivals = bench.named_first(first, rivals)
    nearer = [fit for fit in fits if fit not in worth and _is_nearer(fit, first, bench)]
    rivals = [*sorted(nearer, key=lambda fit: -fit.fit_gain), *rivals]
    return state, first, tuple(fit.name for fit in rivals)


def _is_nearer(fit: Refit, first: Refit, bench: Bench) -> bool:
    """Whether a law that left-out records do not confirm, and do not refute, tells the fitted ones far better."""
    return fit.gain > 0 and fit.fit_gain > first.fit_gain + bench.settings.rival_evidence


def is_confirmed_beside(before: Outcome, fit: Refit, state: State) -> bool:
    """Whether a cause that was confirmed beside one model is so beside another, too."""
    held = compared(fit.score, fit.outcome, before, state.bench.evidence)
    return state.is_validated_beside(fit, before) or _is_worth(held, before, state.left, state.bench)


def _fitted(scores: Sequence[Score], state: State) -> list[Refit]:
    """Full fits of effects as far as there is time, those of many numbers last."""
    bench, cost, fits = state.bench, state.outcome.fitted.cost, []
    for score in sorted(scores, key=has_many):
        if bench.budget.refuses(score.candidate.name) or bench.waits(score, fits, cost):
            continue
        fit = bench.full_fit(score, state.outcome, reach=cost)
        fits += [] if fit is None else [fit]
    return fits


def _of_records(scores: Sequence[Score], state: State) -> tuple[State, Refit | None, tuple[str, ...]]:
    """The same with a cause that differs from record to record, where nothing that is one for all is confirmed."""
    bench = state.bench
    for score in scores:
        fit = None if bench.budget.refuses(score.candidate.name) else bench.full_fit(score, state.outcome)
        if fit is not None and (state.is_validated(fit) or _is_worth(fit, state.outcome, state.left, bench)):
            return replace(state, rejected=(*state.rejected, fit)), fit, ()
    return state, None, ()


def _is_worth(fit: Refit, before: Outcome, seen: Assessment, bench: Bench) -> bool:
    """Whether left-out records confirm a cause that takes its part of what is not random, and lose nothing by it."""
    if fit.gain <= 0:
        return False
    taken = 1 - fit.outcome.fitted.cost / max(before.fitted.cost, 1e-300)
    settings = bench.settings
    is_enough = taken >= settings.least_share * seen.taken
    return is_enough and bench.confirmation(before, fit.outcome) >= settings.confirmed_t


def _simpler(fit: Refit, bench: Bench) -> str | None:
    """The effect that this one contains as a special case."""
    return bench.evidence.library[fit.name].cause.simpler
