"""Step 9: held-out records, which took no part in any choice, are opened once.

They tell what the causes are worth on records that nobody has looked at, and whether they are validated there at all.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from gear_damping.explanation.evidence.excess import Excess, excess
from gear_damping.explanation.evidence.input_noise import without_input_noise
from gear_damping.explanation.evidence.noise import NoiseLevel, noise_of, weighted
from gear_damping.explanation.evidence.records import Evidence, with_own_angles
from gear_damping.explanation.evidence.same_length import as_fitted
from gear_damping.explanation.evidence.unsteady import has_unsteady_shafts, with_unsteady_shafts
from gear_damping.explanation.model.calibration_error import calibration_error
from gear_damping.explanation.model.homogeneity import homogeneity
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.model.opened import opened
from gear_damping.explanation.model.own_marks import with_own_marks
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.statistics.paired import confirmation
from gear_damping.explanation.trials.refit import block_samples
from gear_damping.identification.observation import MESH_PHASE
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.record import Measurement
from gear_damping.physics.systems.traits import Trait


@dataclass(frozen=True)
class Confirmed:
    """A search with what held-out records say of it.

    Args:
        state: Where it ended, with the causes that are validated; its records hold those held out.
        noise: Of all records.
        before: What the nominal model leaves of held-out records.
        after: What the extended one does.
        t: Of what the causes together add to the prediction of held-out records; 0 where there is none.
        is_opened: Whether there are records that took no part in the choice.
    """

    state: State
    noise: NoiseLevel
    before: Excess
    after: Excess
    t: float = 0.0
    is_opened: bool = False


def confirmed(state: State, sealed: Sequence[FitRecord], measurement: Measurement) -> Confirmed:
    """The state with its held-out records, without causes that these do not validate.

    Args:
        state: Where the search ended.
        sealed: The held-out records; none where they took part in the choice.
        measurement: Where they are from.
    """
    if not sealed:
        t = _t(state.nominal, state.outcome, state) if state.accepted else 0.0
        return Confirmed(state, state.noise, state.first, state.current, t)
    evidence, noise = _with_sealed(state, sealed, measurement)
    nominal, extended = _both_opened(state, evidence)
    if (marked := with_own_marks(evidence, extended, state.bench.solver)) is not evidence:
        evidence = marked
        nominal, extended = _both_opened(state, evidence)
    bench = replace(state.bench, evidence=evidence)
    scatter = calibration_error(nominal, evidence, bench.solver)
    noise = replace(noise, scatter=scatter)
    state, t = _validated(_told_apart(replace(state, bench=bench, nominal=nominal, outcome=extended)))
    before, after = (_excess(one, evidence, noise) for one in (nominal, state.outcome))
    return Confirmed(state, noise, before, after, t, is_opened=True)


def _both_opened(state: State, evidence: Evidence) -> tuple[Outcome, Outcome]:
    """The nominal model and the extended one on held-out records; one and the same where nothing is accepted."""
    nominal = opened(state.nominal, evidence, state.bench.solver)
    if not state.accepted:
        return nominal, nominal
    return nominal, opened(state.outcome, evidence, state.bench.solver, nominal.own)


def without(found: Confirmed, name: str) -> Confirmed:
    """The search without one of its causes, the others fitted and held against held-out records anew.

    One that was not needed beside it, and was accepted beside the others before it came, is back in its place.

    Args:
        found: The search.
        name: The cause.
    """
    state, evidence, bench = found.state, found.state.bench.evidence, found.state.bench
    back = next((cause for cause in state.pruned if _is_beside(cause, state.names - {name})), None)
    outcome = _fewer(state, name) if back is None else bench.until_converged(back.refit.outcome)
    if found.is_opened:
        outcome = opened(outcome, evidence, bench.solver, state.nominal.own)
    state = _dropped(state, name, outcome)
    if back is not None:
        bench.log(f"{back.name} is back in the place of {name}")
        pruned = tuple(cause for cause in state.pruned if cause is not back)
        state = replace(state, accepted=(*state.accepted, back), pruned=pruned)
    is_late = bench.budget.all_spent  # what is visible beside more causes is so beside fewer
    left = state.left if is_late else bench.assessed(outcome, bench.ranked(outcome))
    t, state = _t(state.nominal, outcome, state), replace(state, left=left)
    after = _excess(outcome, evidence, found.noise) if found.is_opened else state.current
    return replace(found, state=state, after=after, t=t)


def _excess(outcome: Outcome, evidence: Evidence, noise: NoiseLevel) -> Excess:
    """What is left of opened records."""
    left = as_fitted(outcome.holdout, evidence.held, evidence.fitted)
    return excess(left, evidence.held, noise, evidence.settings)


def _is_beside(cause: Accepted, names: Collection[str]) -> bool:
    """Whether a cause was accepted beside these and no others."""
    return cause.name not in names and set(cause.refit.outcome.hypothesis.causes) == {*names, cause.name}


def _fewer(state: State, name: str) -> Outcome:
    """The model without a cause: fitted from where all were, or as it was before that cause came, the better one."""
    kept = state.names - {name}
    before = [c.refit.outcome for c in state.accepted if set(c.refit.outcome.hypothesis.causes) == kept]
    return min([state.bench.without(state.outcome, name), *before], key=lambda outcome: outcome.fitted.cost)


def _dropped(state: State, name: str, outcome: Outcome) -> State:
    """The state with a model without one of its causes, which counts as rejected."""
    gone = state.going_with(name)
    kept = state.left_of(gone, outcome)
    refits = (cause.refit for cause in state.accepted if cause.name in gone)
    return replace(state, accepted=kept, outcome=outcome, rejected=(*refits, *state.rejected))


def _with_sealed(state: State, sealed: Sequence[FitRecord], measurement: Measurement) -> tuple[Evidence, NoiseLevel]:
    """The evidence with its held-out records as the others are seen, and the noise of all of them."""
    evidence, known = state.bench.evidence, state.noise
    if evidence.input_noise:
        sealed = without_input_noise(sealed, evidence.has(Trait.TEETH)) or sealed
    seen = replace(evidence, holdout=tuple(sealed))
    if any(MESH_PHASE in record.own for record in evidence.fit):
        seen = with_own_angles(seen)
    if has_unsteady_shafts(evidence.fit):
        seen = with_unsteady_shafts(seen)
    _, scaled, found = noise_of(evidence.fit, seen.holdout, measurement)
    levels = {record.name: known.elsewhere(state.bench.floor, found.by_record[record.name]) for record in sealed}
    noise = replace(known, by_record={**known.by_record, **levels})
    return replace(evidence, holdout=weighted(scaled, noise)), noise


def _told_apart(state: State) -> State:
    """The state without rivals of its one cause that held-out records refute, the cause itself among them.

    Which effects are rivals was settled before; none can come in here. One with another size in every record takes the
    place of none that has one in all: it bends to the condition that is held out, as it did to the others.
    """
    if len(state.accepted) != 1 or not state.accepted[0].confusable:
        return state
    bench, cause = state.bench, state.accepted[0]
    fits = {fit.name: fit for fit in reversed((*state.rejected, *state.first_fits))}
    tried = {name: fits[name] for name in cause.confusable if name in fits}
    rivals = {n: opened(fit.outcome, bench.evidence, bench.solver, state.nominal.own) for n, fit in tried.items()}
    every = {cause.name: state.outcome, **rivals}
    best = min(every.values(), key=_held_out_cost)
    blocks = block_samples(best, bench.evidence, bench.evidence.held)
    kept = {n: one for n, one in every.items() if one is best or bench.no_worse(one.holdout, best.holdout, blocks)}
    inside = [] if cause.name in kept else [name for name in kept if not tried[name].is_at_bound]
    if inside and _is_one(state.outcome, cause.name, bench.evidence):
        inside = [name for name in inside if _is_one(kept[name], name, bench.evidence)]
    if not inside:
        left = tuple(name for name in cause.confusable if name not in rivals or name in kept)
        return state.with_cause(0, replace(cause, confusable=left))
    first = min(inside, key=lambda name: (len(kept[name].hypothesis.free), kept[name].fitted.cost))
    bench.log(f"held-out records tell {first} from {cause.name}")
    others = tuple(name for name in kept if name != first)
    return state.with_cause(0, Accepted(first, tried[first], cause.share, others), kept[first])


def _is_one(outcome: Outcome, cause: str, evidence: Evidence) -> bool:
    return homogeneity(outcome, cause, evidence).holds


def _held_out_cost(outcome: Outcome) -> float:
    return sum(float(residual.square().sum()) for residual in outcome.holdout)


def _validated(state: State) -> tuple[State, float]:
    """The state with the causes that held-out records validate, and the t of what these add to the prediction."""
    if not state.accepted:
        return state, 0.0
    bench, least = state.bench, state.bench.settings.confirmed_t
    for cause in state.accepted if len(state.accepted) > 1 else ():
        fewer = opened(_fewer(state, cause.name), bench.evidence, bench.solver, state.nominal.own)
        if _t(fewer, state.outcome, state) < least:
            bench.log(f"{cause.name} is not validated on held-out records")
            state = _dropped(state, cause.name, fewer)
    t = _t(state.nominal, state.outcome, state)
    if t < least:
        bench.log("held-out records do not validate what was found")
        fits = tuple(cause.refit for cause in state.accepted)
        return replace(state, accepted=(), outcome=state.nominal, rejected=(*fits, *state.rejected)), 0.0
    return state, t


def _t(before: Outcome, after: Outcome, state: State) -> float:
    """The t statistic of what a second model adds to the prediction of held-out records."""
    evidence = state.bench.evidence
    return confirmation(before.holdout, after.holdout, block_samples(after, evidence, evidence.held))
