"""The order of a search: causes are added one after another as left-out records validate them, then doubted."""

from collections.abc import Sequence
from dataclasses import replace

from gear_damping.explanation.evidence.excess import is_form, is_settled
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.state import State
from gear_damping.explanation.steps.each_alone import followed_one_by_one
from gear_damping.explanation.steps.faint import faint_cause, is_confirmed_beside
from gear_damping.explanation.steps.hidden import cause_beside_random
from gear_damping.explanation.steps.pairs import (
    with_pair,
    with_pair_instead,
    with_pair_of_a_nearer,
    with_pair_of_as_many,
)
from gear_damping.explanation.steps.revise import beside_the_others, exchanged, pruned, simplified
from gear_damping.explanation.steps.single import cause_of_records, differing_instead, single_cause
from gear_damping.explanation.steps.told import told
from gear_damping.explanation.trials.bench import Bench
from gear_damping.explanation.trials.refit import Refit

INSTEAD = "other effects in the place of causes that take nearly all"


def search(nominal: Outcome, bench: Bench, carried_on: Sequence[Refit] = ()) -> State:
    """Extend the nominal model until nothing significant is missing or nothing more is validated.

    Args:
        nominal: The calibrated model.
        bench: The records, their noise, and where candidates are tried.
        carried_on: Full fits to other evidence that are carried on.
    """
    state = _from(State(bench, nominal, nominal, carried_on=tuple(carried_on)))
    while state.unsized and not bench.budget.refuses("effects in the place of those of no known size"):
        state = _from(state.without_unsized())
    state = _or_before(state)
    bench.budget.asks_again(state.names)  # another form of what was found waits for nothing any more
    return beside_the_others(state) if len(state.accepted) > 1 else state


def _from(state: State) -> State:
    """With the causes that are found from a state on, thought over and doubted."""
    return _doubted(_thought_over(_extended(looked(state))))


def _extended(state: State) -> State:
    """With causes as long as there are any to add."""
    goes_on = True
    while goes_on and len(state.accepted) < state.bench.settings.most_causes:
        state, goes_on = _with_more(state)
        state = looked(state).with_itself_passed() if goes_on else state
    return state


def _thought_over(state: State) -> State:
    """With the second thoughts about causes that take nearly all, which wait until no further one is found."""
    if len(state.accepted) < 2 or not state.takes_nearly_all or state.bench.budget.postpones(INSTEAD):
        return state
    thought = with_pair_instead(exchanged(state))
    return thought if thought.outcome is state.outcome else _extended(looked(thought).with_itself_passed())


def _or_before(state: State) -> State:
    """The state, or one before it whose causes are no more, or a single one, leave less and are told from none.

    Second thoughts may lead away: of two causes that take nearly all together one may turn out to be of no known size,
    and the other is then less than what had been found at first. What had run into a bound stood in for something: it
    is better than no cause, and than no other.
    """
    bench, most = state.bench, max(len(state.accepted), 1)
    better = [one for one in state.passed if len(one.accepted) <= most and _leaves_less(one, state)]
    if state.accepted:
        better = [one for one in better if not any(map(one.is_at_bound, one.accepted))]
    for one in sorted(better, key=lambda one: bench.excess(one.outcome).percent):
        if told(one).names == one.names:
            bench.log(f"{' and '.join(sorted(one.names))} leave less than what came later")
            return one
    return state


def _leaves_less(one: State, state: State) -> bool:
    """Whether an earlier state predicts what is left out better, by the paired test too."""
    bench = state.bench
    less = bench.excess(one.outcome).percent < bench.excess(state.outcome).percent
    return less and not bench.is_as_good(state.outcome, one.outcome)


def _doubted(state: State) -> State:
    """Causes that are no simpler, told from none, and needed beside each other; one fewer may leave another untold."""
    state = told(simplified(state))
    return told(pruned(state)) if len(state.accepted) > 1 else state


def looked(state: State) -> State:
    """With scores beside the present model, and what its residuals hold; the noise follows from what is random."""
    with state.bench.budget.looking():
        ranked = tuple(state.bench.ranked(state.outcome))
        left = state.bench.assessed(state.outcome, ranked)
    state = replace(state, bench=state.bench.knowing(left), ranked=ranked, left=left)
    if state.outcome is state.nominal:  # nothing is accepted, or all was calibrated anew
        state = replace(state, first_scores=ranked, seen=left)
    return state


def _with_more(state: State) -> tuple[State, bool]:
    """One round: a further cause or two of them, or a better calibration; and whether there was any."""
    bench, current = state.bench, state.current
    if state.accepted and bench.budget.refuses("further causes"):
        return state, False
    settled = is_settled(current, state.first, bench.settings)
    is_random = state.left is not None and not state.left.visible and current.misfit <= bench.settings.small_misfit
    is_gross = (settled or is_random) and _is_missed_grossly(state)
    if is_random and not is_gross:
        return state, False
    if state.accepted and state.first.significant and is_form(current, state.first, bench.settings):
        return state, False
    if settled and not is_gross:
        state, best, rivals = _of_records_instead(*faint_cause(state))
        if best is None:
            further = with_pair_of_as_many(state)
        else:
            further = _calibrated_anew(state, best, is_faint=True) or state.accepting(best, rivals)
        return (state, False) if further is None else (further, True)
    if (instead := with_pair_of_a_nearer(state)) is not None:
        return instead, True
    state, best, rivals = _of_records_instead(*single_cause(state))
    if best is None:
        state, best, rivals = cause_beside_random(state)
    if best is None:
        further = with_pair(state) or cause_of_records(state)
    elif (further := _calibrated_anew(state, best)) is None:
        further = state.accepting(best, rivals)
        further = further if further.takes_nearly_all else with_pair_instead(exchanged(further))
    return (state, False) if further is None else (further, True)


def _of_records_instead(
    state: State, best: Refit | None, rivals: tuple[str, ...]
) -> tuple[State, Refit | None, tuple[str, ...]]:
    """The cause and its rivals, or in their place what differs from record to record."""
    own = None if best is None else differing_instead(best, state)
    return (state, best, rivals) if own is None else (state, own, ())


def _is_missed_grossly(state: State) -> bool:
    """Whether without a cause so much is missed beyond the noise of the sensor that it is looked for, however random.

    A motion of which half is missed looks random too, beside held-out records that are few. Not where each record by
    itself is that of a linear model: a second mode would be another rig's.
    """
    beyond, gross = state.beyond_sensor(state.outcome).percent, state.bench.settings.gross_percent
    return not state.accepted and beyond > gross and not followed_one_by_one(state)


def _calibrated_anew(state: State, best: Refit, is_faint: bool = False) -> State | None:
    """The state without the local minimum that an effect seemed needed for: what it took is taken without it.

    Beside the model without it, too, an effect has to be what it was accepted as.
    """
    bench = state.bench
    if state.calibrations >= bench.settings.most_calibrations:
        return None
    # far above what a cause must leave it creeps for half a minute
    reach = bench.spared(best.outcome) if is_faint else bench.foretold(bench.goal(state.outcome))
    settled = bench.without(best.outcome, best.name, reach)
    if is_faint:
        is_needed = is_confirmed_beside(settled, best, state)
    else:
        is_needed = not bench.is_as_good(settled, best.outcome) and state.is_validated_beside(best, settled)
    if is_needed:
        return None
    bench.log(f"what {best.name} seemed to take is taken without it: the fit had not converged")
    nominal = state.nominal if state.accepted else settled
    return replace(state, outcome=settled, nominal=nominal, calibrations=state.calibrations + 1)
