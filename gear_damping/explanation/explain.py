"""Measured data in, named cause out: the steps in the order in which they are done."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import inf
from typing import Any

from torch import Tensor

from gear_damping.explanation import content
from gear_damping.explanation.budget import Budget
from gear_damping.explanation.calibrate import angles_counted, calibrated, recalibrated
from gear_damping.explanation.calibration_error import calibration_error
from gear_damping.explanation.casing.content import CasingStudy, explain_casing
from gear_damping.explanation.casing.heard import is_casing
from gear_damping.explanation.data_faults import data_faults, mesh_order_faults
from gear_damping.explanation.evidence import Evidence, evidence_of
from gear_damping.explanation.extend import search
from gear_damping.explanation.homogeneity import homogeneity
from gear_damping.explanation.hypothesis import MOST_GROWTH, SEGMENT_TIMES, Outcome, segments_of
from gear_damping.explanation.noise import NoiseLevel, noise_of, weighted
from gear_damping.explanation.significance import ac_energy, excess
from gear_damping.explanation.too_short import died_away, too_short
from gear_damping.explanation.trying import Search
from gear_damping.explanation.verdict import Judged, verdict
from gear_damping.identification.decimation import decimated
from gear_damping.identification.oscillator import linear_model
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import Segments
from gear_damping.identification.time_scale import characteristic_time
from gear_damping.measurement.record import Measurement
from gear_damping.physics.terms import Effect
from gear_damping.simulation.solver_settings import Solver

Say = Callable[[str], None]
STEPS = 4
LOST = 0.5  # of the variance of a record or of a stretch of it
STRETCHES, CLEAR = 8, 10.0  # of a record; noise variances that a stretch must hold to tell anything
MOST_SUBSTEPS = 24  # of an output interval: only forces far beyond the load would need more
FIT_ACCURACY = 1e-4  # of the deflection: far below the noise of any record that is explained


@dataclass(frozen=True)
class Explanation:
    """What came of it.

    Args:
        content: Of explanation.json, plain values.
        evidence: The records; None where the data were refused.
        noise: Their noise.
        found: The search, with the calibrated nominal model and the extended one.
        casing: The studies of casing records, where the gear pair was heard through nothing else.
    """

    content: dict[str, Any]
    evidence: Evidence | None = None
    noise: NoiseLevel | None = None
    found: Search | None = None
    casing: CasingStudy | None = None


def explain(
    measurement: Measurement,
    say: Say = lambda text: None,
    report: Callable[[int, int], None] | None = None,
    solver: Solver | None = None,
    library: Mapping[str, type[Effect]] | None = None,
    minutes: float = inf,
) -> Explanation:
    """Explain a measurement.

    Args:
        measurement: What was recorded.
        say: Told what is found on the way.
        report: Told (done, total) steps.
        solver: Settings of the solver.
        library: Effects that may be causes, by name; the whole catalogue where absent.
        minutes: Time of the search; when it is over, the best verdict so far says what was not tried.

    Raises:
        InputError: a record lacks the channel that its system is explained from.
    """
    step, budget = report or (lambda done, total: None), Budget(minutes)
    faults = data_faults(measurement)
    if faults:
        return Explanation(content.of_faults(measurement, faults))
    if is_casing(measurement):
        found, studies = explain_casing(measurement, say)
        return Explanation(content.of_casing(measurement, found), casing=studies)
    evidence = evidence_of(measurement)
    faults = mesh_order_faults(evidence)
    if faults:
        return Explanation(content.of_faults(measurement, faults))
    evidence = at_useful_rate(evidence)
    notes = [note for note in (died_away(evidence), too_short(evidence)) if note]
    for note in notes:
        say(note)
    fit, holdout, noise = noise_of(evidence.fit, evidence.holdout, measurement)
    say(f"noise {noise.value / evidence.channel.declared_factor:.3g} {evidence.channel.declared_unit} ({noise.method})")
    evidence = replace(evidence, fit=weighted(fit, noise), holdout=weighted(holdout, noise), noise=noise.value)
    evidence = evidence if library is None else replace(evidence, library=library)
    solver = solver or Solver()
    solver = replace(solver, accuracy=max(solver.accuracy, FIT_ACCURACY), most_substeps=MOST_SUBSTEPS)
    step(1, STEPS)
    evidence = replace(evidence, segments=first_segments(evidence))
    evidence, rough = angles_counted(evidence, solver)
    nominal = calibrated(evidence, solver, rough)
    noise = replace(noise, scatter=calibration_error(nominal, evidence, solver))
    _tell(nominal, evidence, noise, say)
    step(2, STEPS)
    found = Search(nominal, nominal)
    is_lost = is_lost_by(nominal, evidence)
    if evidence.segments or (nominal.growth <= MOST_GROWTH and not is_lost):
        found = search(nominal, evidence, noise, say, solver, budget=budget)
    is_loose = is_lost or found.growth > MOST_GROWTH or (evidence.system == "oscillator" and best_is_lost(found))
    if not evidence.segments and is_loose:
        evidence = replace(evidence, segments=segments_of(nominal.hypothesis, evidence))
        why = "the nominal model loses a record" if is_lost else "small errors grow"
        say(f"{why}: records are predicted in segments of {evidence.segments.seconds:.3g} s")
        nominal = recalibrated(nominal, evidence, solver)
        noise = replace(noise, scatter=calibration_error(nominal, evidence, solver))
        _tell(nominal, evidence, noise, say)
        found = search(nominal, evidence, noise, say, solver, found.first_fits[:1], budget)
    step(3, STEPS)
    floor, noise = noise, found.noise or noise
    before = excess(found.nominal.holdout, evidence.held, noise)
    after = excess(found.outcome.holdout, evidence.held, noise)
    one = _is_one(found, evidence)
    whole = _taken_of_all(found, evidence, floor)
    fitted = excess(found.nominal.fit_residuals, evidence.fitted, noise)
    said = verdict(found, before, after, found.outcome.fitted.converged, one, whole, fitted.percent)
    said = said.saying(*notes, budget.sentence)
    judged = Judged(found, before, after, said, tuple(budget.not_tried))
    step(4, STEPS)
    return Explanation(content.of_search(measurement, evidence, noise, judged), evidence, noise, found)


def at_useful_rate(evidence: Evidence) -> Evidence:
    """An oscillator's records at a rate that shows all of its motion, and no more."""
    if evidence.system != "oscillator":
        return evidence
    scale = linear_model(evidence.fit, evidence.known)[2]
    return replace(
        evidence, fit=tuple(decimated(evidence.fit, scale)), holdout=tuple(decimated(evidence.holdout, scale))
    )


def first_segments(evidence: Evidence) -> Segments:
    """How records are cut before anything was fitted: as the file says, or where nothing pulls the rig back."""
    if evidence.stated_segments or evidence.system == "gear_pair" or evidence.known.values.get("stiffness", 1.0) != 0:
        return evidence.stated_segments
    return Segments(SEGMENT_TIMES * characteristic_time(evidence.records))


def is_lost_by(nominal: Outcome, evidence: Evidence) -> bool:
    """Whether the nominal model leaves more than half of the fitted records, or of an oscillator's anywhere in one.

    A frequency that hangs on the amplitude runs out of step in the middle of a long decay, which over the whole of it
    counts for little, and no law looks right from there. A gear pair's teeth keep it in step; a record of it far from
    resonance may hold little but what is hidden.
    """
    pairs = list(zip(nominal.fit_residuals, evidence.fitted, strict=True))
    if evidence.system == "gear_pair":
        total = sum(ac_energy(record) for _, record in pairs)
        return sum(float(residual.square().sum()) for residual, _ in pairs) > LOST * total
    return any(_is_lost(residual, record, evidence.noise) for residual, record in pairs)


def best_is_lost(found: Search) -> bool:
    """Whether what fits by far best loses the held-out records, as a softening spring near the edge of its well does.

    There a small error of a parameter leads to another motion, and held-out records would choose a worse model.
    """
    seen = [fit.outcome for fit in found.first_fits if fit.is_seen_in_fit]
    best = min(seen, key=lambda outcome: outcome.fitted.cost, default=found.nominal)
    takes = best.fitted.cost < LOST * found.nominal.fitted.cost
    return takes and best.holdout_cost > found.nominal.holdout_cost


def _is_lost(residual: Tensor, record: FitRecord, noise: float) -> bool:
    if float(residual.square().sum()) > LOST * ac_energy(record):
        return True
    for left, moved in zip(residual.chunk(STRETCHES), record.stacked.chunk(STRETCHES), strict=True):
        motion = float((moved - moved.mean()).square().sum())
        if motion > CLEAR * len(moved) * noise**2 and float(left.square().sum()) > LOST * motion:
            return True
    return False


def _taken_of_all(found: Search, evidence: Evidence, floor: NoiseLevel) -> float:
    """Share that causes take of all that the nominal model leaves beyond what was known of the noise at first."""
    before, after = (excess(one.holdout, evidence.held, floor).percent for one in (found.nominal, found.outcome))
    return 1 - max(after, 0.0) / before if before > 0 else 1.0


def _is_one(found: Search, evidence: Evidence) -> bool | None:
    """Whether every cause has one size over all records; None where too few records tell of one."""
    tests = [homogeneity(found.outcome, cause.name, evidence) for cause in found.accepted]
    if not all(test.testable for test in tests):
        return None
    return all(test.holds for test in tests)


def _tell(nominal: Outcome, evidence: Evidence, noise: NoiseLevel, say: Say) -> None:
    before = excess(nominal.holdout, evidence.held, noise)
    say(f"the calibrated nominal model leaves {before.percent:.3g} % of the signal's variance beyond the noise")
