"""Step 10: the verdict on a search with its held-out records; a cause that is none does not take the others along."""

from collections.abc import Sequence
from dataclasses import replace

from gear_damping.explanation.answer.acting import acts_as, also_as, inputs_and_loads
from gear_damping.explanation.answer.between_samples import between_samples
from gear_damping.explanation.answer.gain import nrmse
from gear_damping.explanation.answer.levels import of_unit_spread, said_of_levels
from gear_damping.explanation.answer.modes import modes_of
from gear_damping.explanation.answer.stand_in import (
    SWINGS_ON,
    is_untold,
    line_left,
    shape_without_name,
    stand_ins,
    swinging_on,
)
from gear_damping.explanation.answer.too_little import takes_of_little
from gear_damping.explanation.evidence.excess import excess
from gear_damping.explanation.model.contradicted import contradicts_stated
from gear_damping.explanation.model.homogeneity import homogeneity
from gear_damping.explanation.model.positive import positive
from gear_damping.explanation.state import State
from gear_damping.explanation.statistics.paired import Share, share_taken
from gear_damping.explanation.steps.confirm import Confirmed, without
from gear_damping.explanation.steps.judge import CONSISTENT, UNEXPLAINED, Judged, Known, verdict
from gear_damping.explanation.trials.refit import block_samples
from gear_damping.physics.terms import Sensor

TOO = "`{}` would take part of what is left too, {}"
SO_MUCH = "but beside it too much is left that has no name."
BENDS = "but not one of its figures is told by the records."
AT_BOUND = "but has run into a bound of what it can be."
WITHIN_FORM = "`{}` would take a little more: so little may as well be the form of the other causes, and is not named."


def judged(found: Confirmed, notes: Sequence[str], least_t: float = 0.0) -> Judged:
    """The state with its verdict.

    Where causes are refused for one among them that is none, those that are left are judged without it. And where
    something is left beside all of them, one that takes hardly anything bends to what the form of the others misses.

    Args:
        found: The search with its held-out records.
        notes: What is said beside the verdict.
        least_t: Of held-out records that are short, for a cause that is no large one to be established.
    """
    found, small = _without_form(found)
    notes = (*notes, *map(WITHIN_FORM.format, small))
    said, (doubtful, why) = _judged(found, notes, least_t)
    fewer = said
    while fewer.verdict.word == UNEXPLAINED and len(fewer.found.accepted) > 1:
        if not doubtful:  # more search must not lose what less of it had found
            doubtful, why = fewer.found.accepted[-1].name, SO_MUCH
        found, notes = without(found, doubtful), (*notes, TOO.format(doubtful, why or AT_BOUND))
        fewer, (doubtful, why) = _judged(found, notes, least_t)
    return _reported(said if fewer.verdict.word == UNEXPLAINED else fewer)


def _without_form(found: Confirmed) -> tuple[Confirmed, tuple[str, ...]]:
    """The search without causes that are another form of the larger ones, and their names.

    These take no more than that would, something is left beside them, and of what they were to explain a part.
    """
    settings, fewer = found.state.bench.settings, found
    small = _small(found.state)
    for name in small:
        fewer = without(fewer, name)
    take_all = 1 - found.after.percent / max(fewer.after.percent, 1e-300) >= settings.taken_by_all
    return (found, ()) if take_all or not small else (fewer, small)


def _small(state: State) -> tuple[str, ...]:
    """The causes beside larger ones that take no more than the form of these may be wrong by, where something is left.

    What takes energy out of the motion is no other form of what stores it, but of a larger one that takes it too; a
    sensor that is off bends to either.
    """
    if state.left is None or not state.left.visible or not state.accepted:
        return ()
    largest, *others = sorted(state.accepted, key=lambda cause: -cause.share)
    share, found = state.bench.settings.settled_share, []
    for place, cause in enumerate(others):
        larger = [one for one in others[:place] if one.effect.dissipative == cause.effect.dissipative]
        is_alike = isinstance(cause.effect, Sensor) or cause.effect.dissipative == largest.effect.dissipative
        form = 1.0 if is_alike else larger[0].share if larger else 0.0
        found += [cause.name] if cause.share < share * form else []
    return tuple(found)


def share_of_held_out(state: State) -> Share:
    """The share of held-out records' squared residuals that the causes take together."""
    first, last, evidence = state.nominal, state.outcome, state.bench.evidence
    return share_taken(first.holdout, last.holdout, block_samples(last, evidence, evidence.held))


def _reported(said: Judged) -> Judged:
    """The same with the extended model's waves as they are reported."""
    state = said.found
    tried = [cause.candidate for cause in state.accepted]
    if not tried:
        return said
    return replace(said, found=replace(state, outcome=of_unit_spread(positive(state.outcome, tried), tried)))


def _judged(found: Confirmed, notes: Sequence[str], least_t: float) -> tuple[Judged, tuple[str, str]]:
    """The state with its verdict, and a cause that may be none with the reason; both empty where there is no such."""
    state, before, after = found.state, found.before, found.after
    evidence, settings, budget = state.bench.evidence, state.bench.settings, state.bench.budget
    doubtful, stands_in = _doubtful(state)
    unknown, scattered = _of_no_figure(state)
    not_tried = tuple(budget.not_tried)
    fitted, beyond = (
        excess(state.nominal.fit_residuals, evidence.fitted, noise, settings)
        for noise in (state.noise, state.bench.floor)
    )
    known = Known(
        converged=state.outcome.fitted.converged,
        is_one=_is_one(state),
        whole=_taken_of_all(state),
        fitted=fitted.percent,
        fitted_beyond_sensor=beyond.percent if beyond.misfit > settings.small_misfit else 0.0,
        untried=not_tried,
        of_fit=1 - state.outcome.fitted.cost / max(state.nominal.fitted.cost, 1e-300),
        stands_in=stands_in,
        is_untold=is_untold(state),
        shape=shape_without_name(state),
        not_random=_not_random(state),
        is_short=found.t < least_t,
        any_figures=unknown,
        scattered=scattered,
        is_stated_otherwise=bool(contradicts_stated(state.nominal, evidence)),
        between_samples=between_samples(state),
        predicts_worse=bool(state.accepted) and found.is_opened and share_of_held_out(state).interval95[1] < 0,
    )
    said = verdict(state, before, after, known)
    left = line_left(state)
    acting = (*acts_as(state), *also_as(state), *modes_of(state)) if said.word not in (CONSISTENT, UNEXPLAINED) else ()
    if said.word == CONSISTENT:  # what would take part of so little is no cause
        said = said.saying(takes_of_little(state))
        state, after = replace(state, accepted=(), outcome=state.nominal, left=state.seen), before
    differs = said_of_levels(state.outcome, evidence) if state.accepted else []
    said = said.saying(left, *differs, *notes, *acting, *inputs_and_loads(state), budget.sentence)
    if (unknown or scattered) and not doubtful:
        doubtful, stands_in = unknown or scattered, BENDS
    return Judged(state, before, after, said, not_tried, found.t), (doubtful, stands_in)


def _of_no_figure(state: State) -> tuple[str, str]:
    """A cause of which not one size is known within itself, by the noise and by the scatter between records."""
    unknown = next(iter(state.of_no_figure(scatter=False)), "")
    return unknown, unknown or next(iter(state.of_no_figure(scatter=True)), "")


def _not_random(state: State) -> float:
    """What of the nominal model's residuals shows that it is not random, in % of the fitted records' variance."""
    left = 100 * nrmse(state.nominal.fit_residuals, state.bench.evidence.fitted) ** 2
    return left if state.seen is None else left * state.seen.taken


def _doubtful(state: State) -> tuple[str, str]:
    """A cause that stands in for something else or has run into a bound, and why it is none; both empty without."""
    for name in swinging_on(state):
        return name, SWINGS_ON.format(name)
    for one in stand_ins(state):
        return one.cause, one.sentence
    return next((cause.name for cause in state.accepted if state.is_at_bound(cause)), ""), ""


def _taken_of_all(state: State) -> float:
    """Share that causes take of all that the nominal model leaves beyond what was known of the noise at first."""
    before, after = (state.beyond_sensor(outcome).percent for outcome in (state.nominal, state.outcome))
    return 1 - max(after, 0.0) / before if before > 0 else 1.0


def _is_one(state: State) -> bool | None:
    """Whether every cause has one size over all records; None where none is refuted and too few tell of one."""
    tests = [homogeneity(state.outcome, cause.name, state.bench.evidence) for cause in state.accepted]
    if not all(test.holds for test in tests):
        return False
    return True if all(test.testable for test in tests) else None
