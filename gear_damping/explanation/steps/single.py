"""A further cause: the effect that takes most of what is left, where left-out records validate it."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf

from gear_damping.explanation.evidence.excess import is_settled
from gear_damping.explanation.model.fitting import InitialValues, fit_hypothesis
from gear_damping.explanation.model.hypothesis import Outcome, settled_at
from gear_damping.explanation.model.nominal_gear_pair import SHAPE, shaped
from gear_damping.explanation.model.parting_flanks import are_missed, flanks_change, stay_closed, with_parting_flanks
from gear_damping.explanation.state import State
from gear_damping.explanation.trials.levels_alone import levels_alone
from gear_damping.explanation.trials.refit import Refit, again, compared
from gear_damping.explanation.trials.score import Score, best_by_effect
from gear_damping.identification.output_error.least_squares import NONE
from gear_damping.physics.effects.backlash import Backlash
from gear_damping.physics.systems.traits import Trait

SHAPE_IN_PHASE = f"{SHAPE}.in_phase["  # one of every harmonic
LEAST_OF_TEETH = 0.1  # of the largest gain: with less, an effect of single teeth is not the first to be named
APART = 2.0  # times what a level of each record leaves: a law that leaves less is the nearer one, with fewer figures
FAR = 10.0  # times the cost of the best fit: a law that leaves so much more has not converged where it could


def single_cause(state: State) -> tuple[State, Refit | None, tuple[str, ...]]:
    """The state with the fits that were made, the next cause and its rivals; None where nothing more is validated."""
    bench = state.bench
    if state.accepted:
        fits = bench.full_fits(bench.worth(state.ranked, state.outcome), state.outcome, state.outcome)
    else:
        fits = _first_fits(state)
        state = replace(state, first_fits=fits)
    state = replace(state, rejected=fits)
    if state.is_unpredictable:
        return state, None, ()
    fits = _converged_rivals(fits, state)
    state = replace(state, rejected=fits)
    best = _best(fits, state)
    if best is None or (state.needs_known_size and not bench.is_determined(best, state.outcome)):
        return state, None, ()
    return state, *bench.simplest(best, fits)


def _first_fits(state: State) -> tuple[Refit, ...]:
    """Full fits of the first round: from the nominal model, and from before its free shape was fitted.

    Where much is missing that shape has bent to what it is not made for, so the other place comes first, unless an
    effect promises nearly all of it as it is; the second one is tried only where nothing is validated from the first.
    """
    bench = state.bench
    fits = [again(refit, state.nominal, bench.evidence, bench.solver) for refit in state.carried_on]
    is_parted = not fits and flanks_change(bench.evidence)
    if is_parted:  # a model whose flanks stay together is no place to begin
        fits = _from_what_is_stated(fits, state)
        if _best(fits, state):
            return tuple(fits)
    is_bent = state.current.misfit >= bench.settings.bent_misfit and not _promises_all(state)
    is_shaped = False
    for place in (_unshaped, _shaped) if is_bent else (_shaped, _unshaped):
        carried_on = place(state)
        if carried_on is None:
            continue
        is_shaped = is_shaped or carried_on[0] is state.nominal
        fits += bench.full_fits(carried_on[1], carried_on[0], state.nominal)
        fits = _from_the_best(fits, state)
        fits.sort(key=lambda fit: fit.outcome.left_out_cost)
        if _best(fits, state):
            break
    fits += [] if is_parted else _from_what_is_stated(fits, state)
    fits += _rivals_from_the_shape(fits, state) if is_bent and not is_shaped else []
    return tuple(sorted(fits, key=lambda fit: fit.outcome.left_out_cost))


def _promises_all(state: State) -> bool:
    """Whether an effect promises beside the nominal model to take nearly all that is left beyond the noise.

    What tells teeth apart promises as much of anything that has orders of their shaft.
    """
    bench, nominal = state.bench, state.nominal
    laws = [score.gain for score in state.first_scores if not score.candidate.tells_teeth_apart]
    most = max(laws, default=0.0)
    return most * nominal.fitted.cost >= bench.settings.taken_by_all * bench.beyond_noise(nominal)


def _rivals_from_the_shape(fits: Sequence[Refit], state: State) -> list[Refit]:
    """Effects fitted from the nominal model, where the best fit came from before its shape was fitted.

    From there a law of the stiffness, which changes what every harmonic does, may lead too far: one that promises as
    much as any beside the nominal model is fitted again where no fit came to an end. And what the shape lacks hides
    how much others take: what was not worth a fit there and promises much here gets one, as far as it leaves less.
    """
    bench, scores, best = state.bench, best_by_effect(state.first_scores), _best(fits, state)
    if best is None:
        return []
    tried = {fit.name for fit in fits}
    unended = tried - {fit.name for fit in fits if fit.outcome.fitted.converged}
    most = max((score.gain for score in scores.values()), default=0.0)
    waiting = [scores[n] for n in scores if n in unended and scores[n].gain >= bench.settings.rival_share * most]
    hidden = [scores[n] for n in scores if n not in tried and scores[n].gain >= bench.settings.taken_by_one * most]
    found = bench.full_fits(hidden, state.nominal, state.nominal, reach=best.outcome.fitted.cost)
    return [*found, *bench.full_fits(waiting, state.nominal, state.nominal)]


def _from_what_is_stated(fits: Sequence[Refit], state: State) -> list[Refit]:
    """The gap between flanks fitted from what is stated of the rig, where nothing else leaves as little as noise."""
    bench, name = state.bench, Backlash.name
    if stay_closed(bench.evidence):
        return []
    score = best_by_effect(state.first_scores).get(name)
    if score is None or any(is_settled(bench.excess(fit.outcome), state.first, bench.settings) for fit in fits):
        return []
    if bench.budget.refuses(f"{name} from what is stated of the rig"):
        return []
    harmonics = sum(p.name.startswith(SHAPE_IN_PHASE) for p in state.nominal.problem.free)
    evidence = bench.evidence
    found = with_parting_flanks(evidence, harmonics, bench.solver)
    is_cut = found is not None and found.error_amplification > bench.settings.most_growth and not evidence.segments
    if found is None or (is_cut and not are_missed(found, state.nominal, evidence, bench.solver)):
        return []
    return [compared(score, found, state.nominal, evidence)]


def _from_the_best(fits: Sequence[Refit], state: State) -> list[Refit]:
    """The fits, about a place of rest those that leave far more than the best one tried again from where that lies.

    The nominal model may be a long way off in all that it shares with them, a gain of the force or a damping, and its
    own spring another one: from there some laws come to a place where no step is better.
    """
    bench, nominal = state.bench, state.nominal
    best = min(fits, key=lambda fit: fit.outcome.fitted.cost, default=None)
    if not bench.evidence.has(Trait.REST) or best is None:
        return list(fits)
    far = {fit.name for fit in fits if fit.outcome.fitted.cost > FAR * best.outcome.fitted.cost}
    if not far or bench.budget.refuses("laws once more, from the best one"):
        return list(fits)
    shared = {p.name: best.outcome.values[p.name] for p in nominal.problem.free if p.name in best.outcome.values}
    settled = settled_at(nominal.hypothesis, shared)
    place = fit_hypothesis(settled, bench.evidence, InitialValues(after=best.outcome), NONE, solver=bench.solver)
    scores = best_by_effect(bench.ranked(place, far)) if place.is_finite else {}
    found = [bench.full_fit(score, place, nominal) for score in scores.values() if score.candidate.non_nested]
    again = {fit.name: fit for fit in found if fit is not None}
    return [min([fit, again.get(fit.name, fit)], key=lambda one: one.outcome.fitted.cost) for fit in fits]


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
    return outcome, bench.ranked(outcome, _hidden_by_shape(state.first_scores))


def _hidden_by_shape(scores: Sequence[Score]) -> set[str]:
    """Effects of which a shape that has bent may have taken something, so that their scores beside it say too little.

    What tells teeth apart has orders of a shaft, and the shape but those of the mesh: their scores stand, and those
    that promise little need not be found anew, which for a hundred teeth takes most of the time.
    """
    best = best_by_effect(scores)
    most = max((score.gain for score in scores), default=0.0)
    stand = {n for n, one in best.items() if one.candidate.tells_teeth_apart and one.gain < LEAST_OF_TEETH * most}
    return set(best) - stand


def _converged_rivals(fits: Sequence[Refit], state: State) -> tuple[Refit, ...]:
    """The fits, the best ones carried to their ends: what has not converged is no winner yet.

    Under a preload another one is carried on only as long as it may get below the best: it is a rival where it stands,
    too, and one of a hundred numbers, as an error of every tooth, creeps for minutes.
    """
    best, bench = _best(fits, state), state.bench
    if best is None:
        return tuple(fits)
    against = state.outcome if state.accepted else state.nominal
    alike = [fit for fit in fits if fit is best or bench.is_as_good(fit.outcome, best.outcome)]
    reach = bench.foretold(best.outcome.fitted.cost)
    goals = {id(fit): inf if fit is best else reach for fit in alike}
    ends = [bench.converged(fit, against, goals[id(fit)]) if id(fit) in goals else fit for fit in fits]
    return tuple(sorted(ends, key=lambda fit: fit.outcome.left_out_cost))


def _best(fits: Sequence[Refit], state: State) -> Refit | None:
    """The best full fit, where left-out records validate it.

    What differs from record to record is the best only where what is one for all leaves far more, and takes less than
    nearly all: a left-out record is fitted with a figure of its own by the one, and foretold by the other.
    """
    best = next((fit for fit in fits if fit.is_seen_in_fit), None)
    if best is not None and best.differs:
        same = next((fit for fit in fits if fit.is_seen_in_fit and not fit.differs), None)
        is_better = same is not None and same.outcome.left_out_cost > APART * best.outcome.left_out_cost
        best = best if is_better and not _foretells(same, state) and state.is_validated(same) else same
    return best if best is not None and state.is_validated(best) else None


def _foretells(fit: Refit, state: State) -> bool:
    """Whether a law that is one for all records takes nearly all that is missed in those that are left out."""
    return state.share_taken(fit.outcome) >= state.bench.settings.taken_by_all


def cause_of_records(state: State) -> State | None:
    """The state with a cause that differs from record to record, where nothing that is one for all is validated."""
    best = next((fit for fit in state.rejected if fit.is_seen_in_fit and fit.differs), None) or _told_alone(state)
    if state.is_unpredictable or best is None or not state.is_validated(best):
        return None
    return state.accepting(best, ())


def differing_instead(best: Refit, state: State) -> Refit | None:
    """What differs between records that are followed one by one, where a law for all of them leaves far more.

    Of pendulums of six lengths a law whose frequency falls with the swing follows some, as their swings differ too. Of
    one pendulum in ever smaller swings each record has a frequency of its own, and a law of one figure leaves less of
    what is fitted: what is left out is told a frequency of its own as well.
    """
    if state.accepted or best.differs:
        return None
    if state.beyond_sensor(best.outcome).misfit <= state.bench.settings.small_misfit:  # it leaves noise
        return None
    own = _told_alone(state)
    if own is None or APART * own.outcome.left_out_cost >= best.outcome.left_out_cost:
        return None
    laws = [
        fit for fit in (best, *state.rejected) if fit.is_seen_in_fit and not fit.differs and state.is_validated(fit)
    ]
    is_nearest = all(own.outcome.fitted.cost <= law.outcome.fitted.cost for law in laws)
    return own if is_nearest and state.is_validated(own) else None


def _told_alone(state: State) -> Refit | None:
    """What differs between records that a model of its own follows one by one: no score of a mean one foresees it."""
    bench = state.bench
    for score in best_by_effect(state.ranked).values() if not state.accepted else ():
        if levels_alone(score, state.outcome, bench.evidence, bench.solver) is None:
            continue
        fit = None if bench.budget.refuses(score.candidate.name) else bench.full_fit(score, state.outcome)
        if fit is not None and fit.is_seen_in_fit:
            bench.log(f"{fit.name}: each record is followed by a model of its own")
            return fit
    return None
