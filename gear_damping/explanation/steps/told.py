"""Causes whose size the records do not tell from none are dropped, and small ones that bend beside others."""

from dataclasses import replace

from gear_damping.explanation.evidence.excess import is_all
from gear_damping.explanation.model.gives_back import gives_back
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.trials.told_size import is_told

OF_ANY_SIZE = "lowers the cost, but its size is not told from none"
BENDS = "takes little beside the others, and this at a bound of what it can be"


def told(state: State) -> State:
    """Without causes whose size the records do not tell from none.

    A strength may trade against another parameter however far (the growth of a contact ratio against the height of
    its edges): what explains all, or is alone and takes most of what is missing, and is missed when it is taken out, is
    there whatever its size. A large rest of its form, by which a size is judged, is no reason against it. That is no
    rescue for what is tried as a whole: of any stiffness and any inertia, the torsion of a shaft bends to what another
    one does. What gives back energy that it took does what nothing else can, though of a free motion the poles of two
    masses tell four figures of five.

    Beside others, what takes little and has run into a bound of what it can be bends to what these leave. So does what
    has not one figure that is known within itself, which no verdict would name: another law is sought in its place.
    """
    while (untold := _untold(state)) is not None:
        cause, outcome = untold
        state.bench.log(f"{cause.name} {BENDS if _bends(state, cause) else OF_ANY_SIZE}")
        kept = state.left_of({cause.name}, outcome)
        rejected, unsized = (cause.refit, *state.rejected), state.unsized | {cause.name}
        state = replace(state, outcome=outcome, accepted=kept, rejected=rejected, unsized=unsized)
    return state


def _untold(state: State) -> tuple[Accepted, Outcome] | None:
    """A cause of no known size and the model without it, None where all are told.

    Of several that trade against each other, the one without which conditions that are left out are predicted best.
    """
    bench, found = state.bench, []
    for cause in state.accepted:
        if _bends(state, cause):
            return cause, bench.without(state.outcome, cause.name)
        runs_away = not state.outcome.is_finite  # with a small change: then it tells nothing
        if not runs_away and is_told(state.outcome, cause.refit, bench.evidence):
            continue
        outcome = bench.without(state.outcome, cause.name)
        is_one = not runs_away and (
            not cause.candidate.non_nested or gives_back(cause.effect, state.outcome, bench.evidence)
        )
        is_missed = is_one and (_explain_all(state) or _takes_most(state))
        if not is_missed or bench.is_as_good(outcome, state.outcome):
            found.append((cause, outcome))
    if not found and (unknown := _of_no_figure(state)) is not None:
        return unknown, bench.without(state.outcome, unknown.name)
    return min(found, key=lambda one: one[1].left_out_cost, default=None)


def _bends(state: State, cause: Accepted) -> bool:
    """Whether a cause beside others takes little, and this at a bound of what it can be."""
    is_small = len(state.accepted) > 1 and cause.share < state.bench.settings.least_share
    return is_small and cause.runs_into_bound(state.outcome)


def _of_no_figure(state: State) -> Accepted | None:
    """The last one of several causes of which no figure is known; where they leave nothing, records need not agree."""
    if len(state.accepted) < 2 or not state.outcome.is_finite:
        return None
    names = state.of_no_figure(scatter=not _explain_all(state))
    return next((cause for cause in reversed(state.accepted) if cause.name in names), None)


def _explain_all(state: State) -> bool:
    """Whether causes leave nothing that is worth another."""
    return is_all(state.current, state.first, state.bench.settings)


def _takes_most(state: State) -> bool:
    """Whether a cause is alone, and takes most of what is missing on left-out records."""
    return len(state.accepted) == 1 and state.accepted[0].share > state.bench.settings.taken_by_one
