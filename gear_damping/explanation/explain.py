"""Measured data in, named cause out: the steps in the order in which they are done."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from torch import Tensor

from gear_damping.errors import InputError
from gear_damping.explanation.answer import report_fields
from gear_damping.explanation.answer.gain import rmse
from gear_damping.explanation.answer.judged import judged
from gear_damping.explanation.answer.other_shafts_torque import torque_of_the_other_shaft
from gear_damping.explanation.budget import Budget
from gear_damping.explanation.casing.heard import is_casing
from gear_damping.explanation.casing.report_fields import CasingStudy, explain_casing
from gear_damping.explanation.evidence.data_faults import data_faults, mesh_order_faults
from gear_damping.explanation.evidence.excess import ac_energy, is_mostly_left
from gear_damping.explanation.evidence.noise import NoiseLevel, Scatter, noise_of, weighted
from gear_damping.explanation.evidence.records import Evidence, evidence_of
from gear_damping.explanation.evidence.stated_speed import stated_speed_faults
from gear_damping.explanation.evidence.useful_samples import at_useful_rate, of_useful_length
from gear_damping.explanation.longer import over_longer
from gear_damping.explanation.model.calibration_error import calibration_error
from gear_damping.explanation.model.contradicted import contradicts_stated, noise_above
from gear_damping.explanation.model.gives_back import takes_and_gives
from gear_damping.explanation.model.hypothesis import SEGMENT_TIMES, Outcome, natural_frequency_hz, segments_of
from gear_damping.explanation.model.rig import swells_again
from gear_damping.explanation.search import looked, search
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.steps.calibrate import Calibration, calibrated, recalibrated
from gear_damping.explanation.steps.confirm import Confirmed, confirmed
from gear_damping.explanation.steps.each_alone import of_each_record
from gear_damping.explanation.steps.estimate import estimated
from gear_damping.explanation.steps.never_dies import never_dies
from gear_damping.explanation.steps.out_of_step import out_of_step
from gear_damping.explanation.steps.overdamped import overdamped
from gear_damping.explanation.steps.polarity import polarity_fault
from gear_damping.explanation.steps.too_short import least_t, left_out_ends, too_short
from gear_damping.explanation.trials.bench import Bench, Log, nobody
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import Segments
from gear_damping.identification.time_scale import characteristic_time
from gear_damping.measurement.record import Finding, Measurement
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Effect
from gear_damping.simulation.solver_settings import Solver
from gear_damping.threads import no_spinning

STEPS = 4  # that are reported: evidence, calibration, search, verdict
STRETCHES, CLEAR = 8, 10.0  # of a record; noise variances that a stretch must hold to tell anything
MOST_SUBSTEPS = 24  # of an output interval: only forces far beyond the load would need more
INPUT_NOISE = "The measured load has noise of its own, which was filtered out before the simulation was driven by it."
FIT_ACCURACY = 1e-4  # of the deflection: far below the noise of any record that is explained


@dataclass(frozen=True)
class Explanation:
    """What came of it.

    Args:
        content: Of explanation.json, plain values.
        evidence: The records; None where the data were refused.
        noise: Their noise.
        found: Where the search ended, with the calibrated nominal model and the extended one.
        casing: The studies of casing records, where the gear pair was heard through nothing else.
    """

    content: dict[str, Any]
    evidence: Evidence | None = None
    noise: NoiseLevel | None = None
    found: State | None = None
    casing: CasingStudy | None = None


@dataclass(frozen=True)
class Listener:
    """Who is told on the way.

    Args:
        log: What is found, in a line.
        progress: (done, total) steps.
    """

    log: Log = nobody
    progress: Callable[[int, int], None] = lambda done, total: None


NOBODY = Listener()


def explain(
    measurement: Measurement,
    listener: Listener = NOBODY,
    solver: Solver | None = None,
    library: Mapping[str, type[Effect]] | None = None,
    budget: Budget | None = None,
    settings: SearchSettings | None = None,
) -> Explanation:
    """Explain a measurement.

    Args:
        measurement: What was recorded.
        listener: Who is told on the way.
        solver: Settings of the solver.
        library: Effects that may be causes, by name; the whole catalogue where absent.
        budget: Time of the search; when it is over, the best verdict so far says what was not tried. As long as it
            takes where absent.
        settings: Thresholds of the search; the defaults where absent.

    Raises:
        InputError: a record lacks the channel that its system is explained from.
    """
    budget, settings = budget or Budget(), settings or SearchSettings()
    if faults := data_faults(measurement):
        return Explanation(report_fields.of_faults(measurement, faults))
    if is_casing(measurement):
        found, studies = explain_casing(measurement, listener.log)
        return Explanation(report_fields.of_casing(measurement, found), casing=studies)
    evidence = replace(evidence_of(measurement), settings=settings, is_over=lambda: budget.spent)
    if faults := mesh_order_faults(evidence) or stated_speed_faults(evidence):
        return Explanation(report_fields.of_faults(measurement, faults))
    evidence = evidence if library is None else replace(evidence, library=library)
    with no_spinning():
        return _of_evidence(evidence, measurement, listener, fitting_solver(solver), budget)


def _of_evidence(
    evidence: Evidence, measurement: Measurement, listener: Listener, solver: Solver, budget: Budget
) -> Explanation:
    """What explains records without faults: calibration, search, confirmation on sealed records, verdict."""
    log, step = listener.log, listener.progress
    stretches = of_useful_length(at_useful_rate(evidence))
    whole = stretches.evidence
    silent = left_out_ends(whole)
    for said in filter(None, (silent, stretches.said)):
        log(said)
    sealed = whole.holdout if whole.can_be_sealed else ()
    evidence = replace(whole, holdout=(), sealed=True) if sealed else whole
    evidence, noise = with_noise(evidence, measurement, log)
    step(1, STEPS)
    found = _calibrated(replace(evidence, segments=first_segments(evidence)), solver)
    if isinstance(found, Finding):
        return Explanation(report_fields.of_faults(measurement, [found]))
    state = _searched(found, noise, log, solver, budget, lambda: step(2, STEPS))
    short = too_short(whole, state.nominal)
    if short:
        log(short)
    step(3, STEPS)
    found = _confirmed(state, sealed, measurement)
    evidence, noise = found.state.bench.evidence, found.noise
    doubts = (
        out_of_step(found.state),
        never_dies(found.state),
        overdamped(found.state),
        of_each_record(found.state),
        contradicts_stated(found.state.outcome, evidence),
        torque_of_the_other_shaft(found.state.outcome, evidence),
        noise_above(found.state.bench.floor, rmse(found.state.outcome.fit_residuals), evidence.channel) or "",
        INPUT_NOISE if evidence.input_noise else "",
    )
    least = least_t(whole, state.nominal)
    unsure = short if found.t < least else ""
    said = judged(found, [silent, unsure, *doubts, stretches.said], least)
    step(4, STEPS)
    return Explanation(report_fields.of_search(measurement, evidence, noise, said), evidence, noise, said.found)


def _confirmed(state: State, sealed: tuple[FitRecord, ...], measurement: Measurement) -> Confirmed:
    """The search's end with what sealed records say of it; where they take a cause away, what is left is looked at."""
    found = confirmed(_with_the_last_time(state), sealed, measurement)
    if found.state.names != state.names:
        found = replace(found, state=replace(found.state, left=looked(found.state).left))
    return replace(found, state=estimated(found.state))


def _with_the_last_time(state: State) -> State:
    """The state whose further fits may take the time that was kept for them: one cut short says nothing of a cause."""
    bench = state.bench
    evidence = replace(bench.evidence, is_over=lambda: bench.budget.all_spent)
    return replace(state, bench=replace(bench, evidence=evidence))


def with_noise(evidence: Evidence, measurement: Measurement, log: Log) -> tuple[Evidence, NoiseLevel]:
    """The evidence with its records weighted by their noise, and that noise."""
    fit, holdout, noise = noise_of(evidence.fit, evidence.holdout, measurement)
    log(f"noise {noise.value / evidence.channel.declared_factor:.3g} {evidence.channel.declared_unit} ({noise.method})")
    return replace(evidence, fit=weighted(fit, noise), holdout=weighted(holdout, noise), noise=noise.value), noise


def fitting_solver(given: Solver | None) -> Solver:
    """Settings that are fine enough for a fit, and no finer."""
    solver = given or Solver()
    return replace(solver, accuracy=max(solver.accuracy, FIT_ACCURACY), most_substeps=MOST_SUBSTEPS)


def _calibrated(evidence: Evidence, solver: Solver) -> Calibration | Finding:
    """The calibration, or the finding that a channel counts the other way round."""

    def fitted(some: Evidence) -> Outcome:
        return calibrated(some, solver).nominal

    try:
        found = calibrated(evidence, solver)
    except InputError:
        if fault := polarity_fault(evidence, None, fitted):
            return fault
        raise
    fault = is_lost_by(found.nominal, found.evidence) and polarity_fault(evidence, found.nominal, fitted)
    return fault or found


def _searched(
    found: Calibration, noise: NoiseLevel, log: Log, solver: Solver, budget: Budget, is_calibrated: Callable[[], None]
) -> State:
    """The search, over whole records as far as these can be predicted from their start."""
    nominal, evidence = found.nominal, found.evidence
    noise = replace(noise, scatter=_scatter(nominal, evidence, solver))
    bench = Bench(evidence, noise, log, solver, noise, budget=budget, rough=found.rough)
    if found.followed:
        log(f"one model follows {found.followed} of {len(evidence.fit)} records and is calibrated by these")
    _tell(nominal, bench)
    is_calibrated()
    state, is_lost = State(bench, nominal, nominal), is_lost_by(nominal, evidence)
    is_led = is_lost and evidence.has(Trait.SHAFTS)  # by what turns: a large runout leaves little to the mesh
    if evidence.segments or not (state.is_unpredictable or (is_lost and not is_led)):
        state = search(nominal, bench)
        is_lost = is_led and is_lost_by(state.outcome, evidence)
    loses = not evidence.has(Trait.SHAFTS) and best_is_lost(state)
    if evidence.segments or not (is_lost or state.is_unpredictable or loses):
        return state
    if not state.accepted and has_another_mode(nominal, bench):
        log("a second mode follows records whose motion grows again: whole records are searched")
        beating = search(nominal, bench)
        if beating.accepted:
            return beating

    def begun(segments: Segments) -> tuple[Bench, Outcome]:
        """The bench and the nominal model with records cut so."""
        cut = replace(evidence, segments=segments)
        fitted = recalibrated(found, cut, solver)
        known = replace(noise, scatter=_scatter(fitted, cut, solver))
        return replace(bench, evidence=cut, noise=known, floor=known), fitted

    segments = segments_of(nominal.hypothesis, evidence)
    why = "the nominal model loses a record" if is_lost else "small errors grow"
    log(f"{why}: records are predicted in segments of {segments.seconds:.3g} s")
    short, nominal = begun(segments)
    _tell(nominal, short)
    return over_longer(search(nominal, short, state.first_fits[:1]), begun)


def has_another_mode(nominal: Outcome, bench: Bench) -> bool:
    """Whether a motion grows again after it fell, and a linear model with one mode more loses no fitted record.

    Two modes beat: within a segment shorter than a beat they are nearly one, and what is left of it is free to begin
    anew with every segment. Over whole records a linear model looks as right from its start as at its end.
    """
    evidence = bench.evidence
    modes = [name for name, kind in evidence.library.items() if takes_and_gives(kind)]
    if not modes or not evidence.has(Trait.REST):
        return False
    frequency = natural_frequency_hz(nominal.hypothesis.model, nominal.flat_given())
    if not frequency or not any(swells_again(record, frequency) for record in evidence.fit):
        return False
    tried = bench.ranked(nominal, modes)[: evidence.settings.most_full_fits]
    fits = (bench.full_fit(score, nominal) for score in tried)
    return any(fit is not None and not is_lost_by(fit.outcome, evidence) for fit in fits)


def _scatter(nominal: Outcome, evidence: Evidence, solver: Solver) -> Scatter:
    """What errors of the calibration add to the residuals by which models are compared."""
    return nominal.scatter if evidence.sealed else calibration_error(nominal, evidence, solver)


def first_segments(evidence: Evidence) -> Segments:
    """How records are cut before anything was fitted: as the file says, or where nothing pulls the rig back."""
    if evidence.stated_segments or evidence.has_spring:
        return evidence.stated_segments
    return Segments(SEGMENT_TIMES * characteristic_time(evidence.records))


def is_lost_by(nominal: Outcome, evidence: Evidence) -> bool:
    """Whether the nominal model leaves more than half of the fitted records, or without shafts anywhere in one.

    A frequency that depends on the amplitude runs out of step in the middle of a long decay, which over the whole of it
    counts for little, and no law looks right from there. Shafts keep a motion in step; a record of it far from
    resonance may hold little but what is hidden.
    """
    pairs = list(zip(nominal.fit_residuals, evidence.fitted, strict=True))
    if evidence.has(Trait.SHAFTS):
        total = sum(ac_energy(record) for _, record in pairs)
        return sum(float(residual.square().sum()) for residual, _ in pairs) > evidence.settings.lost_share * total
    return any(_is_lost(residual, record, evidence) for residual, record in pairs)


def best_is_lost(found: State) -> bool:
    """Whether what fits by far best loses conditions that are left out, as a softening spring near its edge does.

    There a small error of a parameter leads to another motion, and left-out records would choose a worse model.
    """
    seen = [fit.outcome for fit in found.first_fits if fit.is_seen_in_fit]
    best = min(seen, key=lambda outcome: outcome.fitted.cost, default=found.nominal)
    takes = best.fitted.cost < found.bench.settings.lost_share * found.nominal.fitted.cost
    return takes and best.left_out_cost > found.nominal.left_out_cost


def _is_lost(residual: Tensor, record: FitRecord, evidence: Evidence) -> bool:
    share = evidence.settings.lost_share
    if is_mostly_left(residual, record, evidence.noise, share):
        return True
    for left, moved in zip(residual.chunk(STRETCHES), record.stacked.chunk(STRETCHES), strict=True):
        motion = float((moved - moved.mean()).square().sum())
        if motion > CLEAR * len(moved) * evidence.noise**2 and float(left.square().sum()) > share * motion:
            return True
    return False


def _tell(nominal: Outcome, bench: Bench) -> None:
    left = bench.excess(nominal).percent
    bench.log(f"the calibrated nominal model leaves {left:.3g} % of the signal's variance beyond the noise")
