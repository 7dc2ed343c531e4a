"""A cause that is visible, and takes little of what is left only because most of that looks random beside it."""

from dataclasses import replace

from gear_damping.explanation.state import State
from gear_damping.explanation.trials.refit import Refit


def cause_beside_random(state: State) -> tuple[State, Refit | None, tuple[str, ...]]:
    """The state, the cause and its rivals, where nothing was validated by its share of what is left; None where not.

    Beside something large the random part of what is left is not known, and counts as missing: a noise of another
    colour than the floor of its spectrum tells then hides what takes less than a part of it. Beside the best fit that
    left-out records bear out by the paired test that part is looked for again; where nothing else is visible, it is
    noise to all.
    """
    bench = state.bench
    if state.is_unpredictable or state.left is None or not state.left.visible or bench.noise != bench.floor:
        return state, None, ()
    best = next((fit for fit in state.rejected if fit.is_seen_in_fit and not fit.differs), None)
    if best is None or best.t <= bench.settings.accepted_t:
        return state, None, ()
    if bench.budget.refuses(f"what looks random beside {best.name}"):
        return state, None, ()
    left = bench.assessed(best.outcome, bench.ranked(best.outcome))
    if left is None or left.visible:
        return state, None, ()
    known = replace(state, bench=bench.knowing(left))
    if not known.is_validated(best) or (state.needs_known_size and not bench.is_determined(best, state.outcome)):
        return state, None, ()
    return known, *known.bench.simplest(best, state.rejected)
