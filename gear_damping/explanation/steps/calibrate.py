"""Step 3: the nominal simulation at its best, so that wrong parameters do not masquerade as physics."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import log, pi

import torch

from gear_damping.errors import InputError, Problem
from gear_damping.explanation.evidence.input_noise import without_input_noise
from gear_damping.explanation.evidence.records import Evidence, with_own_angles
from gear_damping.explanation.evidence.unsteady import has_unsteady_shafts, with_unsteady_shafts
from gear_damping.explanation.evidence.useful_samples import fair_share
from gear_damping.explanation.model.fitting import InitialValues, fit_hypothesis
from gear_damping.explanation.model.followed import followed_alone, of_one_flank
from gear_damping.explanation.model.hypothesis import Hypothesis, Outcome, natural_frequency_hz
from gear_damping.explanation.model.mesh_alignment import begun_aligned
from gear_damping.explanation.model.near_stated import is_overdamped, near_stated
from gear_damping.explanation.model.nominal_gear_pair import (
    ANGLES_KEPT,
    ROUGH_ITERATIONS,
    SCANNED,
    angles_of,
    first_gear_pair,
    is_standing,
    leaves_noise,
    noise_power,
    phase_starts,
    shaped,
    standing,
    upright,
    with_edge,
    with_stiffness,
)
from gear_damping.explanation.model.own_marks import APART
from gear_damping.explanation.model.parting_flanks import flanks_part
from gear_damping.explanation.trials.noisy_load import moves_with_noise
from gear_damping.identification.observation import MESH_PHASE
from gear_damping.identification.oscillator.fit import fit_oscillator
from gear_damping.identification.oscillator.linear_model import DAMPING, TIME, linear_model, linear_oscillator, mass_of
from gear_damping.identification.output_error.least_squares import NONE, Rounds
from gear_damping.identification.output_error.records import SEPARATOR, FitRecord, FreeParameter
from gear_damping.identification.output_error.segments import shortened
from gear_damping.identification.time_scale import characteristic_time
from gear_damping.physics.systems.traits import Trait, by_trait
from gear_damping.simulation.solver_settings import Solver

LESS_DAMPING = 0.05  # of what was found: what a local minimum takes for damping
SHAPE_ITERATIONS = 30  # of the fit with a free shape of the stiffness; causes are tried from where it stands
CALIBRATED = 8000  # samples of the fitted records together, on which their calibration begins
SHORT_PERIODS = 40.0  # natural periods of the first round
MOST_SCANS = 8  # of the records' angles, each followed by a fit; one where flanks part, which no fit of these follows
EDGES = (0.0, 0.2, 0.4)  # of a mesh period: of spur teeth, wide ones and helical ones
STIFFNESSES = (1.0, 0.85, 0.92, 1.08, 1.17)  # times where it begins: with a wrong one angles of records are wrong too
POORLY = 0.05  # of what moved: a stiffness that varies by a fifth leaves about so much behind a model linear in it
FEWEST_PHASES = 4  # of records: two more than a line has numbers
SLOPES = 201  # of a line that is tried through phases, up to half a mesh period between rest and the highest speed
IN_LINE = 0.1  # rad, root mean square: four random phases are so near to a line once in 250 times, six once in 10 000
NOT_FINITE = Problem(
    "parameters",
    "with what is stated of the rig and its load, the nominal simulation does not stay finite",
    remedy="check the values and units of parameters, torques and speeds",
)


@dataclass(frozen=True)
class Calibration:
    """The evidence with the nominal model at its best.

    Args:
        evidence: The records, with phases of their own where their angles do not count from one mark.
        nominal: The nominal model fitted to them.
        rough: A gear pair's fit before the shape of its stiffness was freed; None where there are no teeth.
        followed: How many of the records the nominal model was fitted to, where it does not follow the others; else 0.
    """

    evidence: Evidence
    nominal: Outcome
    rough: Outcome | None = None
    followed: int = 0


def calibrated(evidence: Evidence, solver: Solver | None = None) -> Calibration:
    """The nominal model fitted to the evidence.

    Raises:
        InputError: with what is stated of the rig it cannot be simulated, or nothing is known to fit to its system.
    """
    with _simulable():
        found = by_trait(evidence.base, NOMINAL, "nominal model")(evidence, solver)
    if not bool(found.nominal.fitted.prediction.sensitivity.isfinite().all()):
        raise InputError(NOT_FINITE)
    return found


@contextmanager
def _simulable() -> Iterator[None]:
    """What is stated of a rig may be far from any that moves as was recorded."""
    try:
        yield
    except torch.linalg.LinAlgError as error:
        raise InputError(NOT_FINITE) from error


def _oscillator_calibrated(evidence: Evidence, solver: Solver | None) -> Calibration:
    """With loads without the noise of their sensor, or as they were measured where the oscillator moves with that."""
    found = Calibration(evidence, _oscillator(evidence, solver))
    cleaned = _with_quiet_loads(evidence)
    if cleaned is None:
        return found
    quiet = Calibration(cleaned, _oscillator(cleaned, solver))
    if not (found.nominal.is_finite and quiet.nominal.is_finite):  # one that runs away is compared with nothing
        return quiet if quiet.nominal.is_finite else found
    return found if moves_with_noise(found.nominal, quiet.nominal, cleaned) else quiet


def _gear_pair_calibrated(evidence: Evidence, solver: Solver | None) -> Calibration:
    """The gear pair, held near what is stated of its mesh where that comes out damped beyond critical otherwise."""
    found = _under_quiet_torques(evidence, solver)
    near = near_stated(evidence) if is_overdamped(found.nominal, evidence) else None
    if near is None:
        return found
    held = _under_quiet_torques(near, solver)
    if not held.nominal.is_finite or is_overdamped(held.nominal, evidence):
        return found
    return replace(held, evidence=replace(held.evidence, known=evidence.known))  # it is not what the file says


def _under_quiet_torques(evidence: Evidence, solver: Solver | None) -> Calibration:
    """The same with torques: all of a floor may be that of the meter, as a steady torque has no content of its own."""
    found = _gear_pair(evidence, solver)
    cleaned = None if found.followed or is_standing(evidence) else _with_quiet_loads(found.evidence)
    if cleaned is None:
        return found
    initial, rounds = InitialValues(after=found.nominal, is_near=True), Rounds(SHAPE_ITERATIONS)
    nominal = fit_hypothesis(found.nominal.hypothesis, cleaned, initial, rounds, solver=solver)
    if not nominal.is_finite or moves_with_noise(found.nominal, nominal, cleaned):
        return found
    return replace(found, evidence=cleaned, nominal=nominal)


def _with_quiet_loads(evidence: Evidence) -> Evidence | None:
    """The evidence with loads without the noise of their meters; None where none has any."""
    cleaned, count = without_input_noise(evidence.records, evidence.has(Trait.TEETH)), len(evidence.fit)
    if cleaned is None:
        return None
    return replace(evidence, fit=cleaned[:count], holdout=cleaned[count:], input_noise=True)


def _oscillator(evidence: Evidence, solver: Solver | None) -> Outcome:
    """Stiffness, damping, gain; offsets of force and response as nuisances."""
    found = fit_oscillator(evidence.fit, known=evidence.known, segments=evidence.segments)
    free, given, _ = linear_model(evidence.fit, evidence.known)
    if TIME in given:  # without a spring: known now
        given[TIME] = characteristic_time(evidence.fit, 0.0, found.given[DAMPING] / mass_of(evidence.known))
    gains = evidence.base.gains.values()
    free = [_from_here(parameter, found.given[parameter.name], parameter.name in gains) for parameter in free]
    model = linear_oscillator(evidence.fit, evidence.known)
    nominal = Hypothesis(model.system, tuple(model.effects), given, tuple(free))
    return fit_hypothesis(nominal, evidence, solver=solver)


def _from_here(parameter: FreeParameter, value: float, is_gain: bool) -> FreeParameter:
    """The parameter from a value that was found; a gain keeps its sign."""
    logarithmic = parameter.logarithmic or (is_gain and value > 0)
    expected = parameter.start if parameter.expected is None and parameter.logarithmic else parameter.expected
    deviation = parameter.deviation
    if logarithmic and not parameter.logarithmic:  # a relative one counts as such
        deviation = parameter.deviation / abs(parameter.start)
    return replace(parameter, start=value, logarithmic=logarithmic, expected=expected, deviation=deviation)


def recalibrated(calibration: Calibration, evidence: Evidence, solver: Solver | None = None) -> Outcome:
    """The nominal model fitted to the evidence in segments, from where it was and from little damping.

    One that only some of the records follow stays as it is.
    """
    hypothesis = calibration.nominal.hypothesis
    own = calibration.nominal.of_records
    if calibration.followed:
        return fit_hypothesis(hypothesis, evidence, InitialValues(own=own), NONE, solver=solver)
    starts = torch.zeros(2, len(hypothesis.common), dtype=torch.float64)
    places = [i for i, parameter in enumerate(hypothesis.free) if parameter.name == DAMPING]
    starts[1, places] = log(LESS_DAMPING)
    return fit_hypothesis(hypothesis, evidence, InitialValues(starts, own=own), Rounds(SHAPE_ITERATIONS), solver=solver)


def _gear_pair(evidence: Evidence, solver: Solver | None) -> Calibration:
    """Mesh phase by a scan, damping and stiffness, free harmonics of the stiffness, then speeds that vary a little."""
    if is_standing(evidence):
        return Calibration(evidence, standing(evidence, solver))
    driven = of_one_flank(evidence)
    if driven is not evidence:
        return _carried_over(_gear_pair(driven, solver), evidence, solver)
    evidence, rough, nominal = _begun_short(evidence, solver)
    followed = followed_alone(nominal, evidence, lambda some: _shaped(some, solver))
    unsteady = with_unsteady_shafts(evidence)
    if followed is not None:
        return Calibration(unsteady, _of_others(*followed, unsteady, solver), rough, len(followed[1].fit))
    if has_unsteady_shafts(unsteady.fit):  # only now: before the teeth have their shape, speeds would bend to it
        initial, rounds = InitialValues(after=nominal), Rounds(SHAPE_ITERATIONS)
        nominal = fit_hypothesis(nominal.hypothesis, unsteady, initial, rounds, solver=solver)
    return Calibration(unsteady, nominal, rough)


def _begun_short(evidence: Evidence, solver: Solver | None) -> tuple[Evidence, Outcome, Outcome]:
    """The evidence with its angles counted, the rough fit and the nominal model, all of long records begun on a part.

    Stiffness, damping and angles are found by many fits, of which a few thousand samples tell as much as all.
    """
    part = _on_a_part(evidence)
    begun, rough, nominal = _angles_counted(part, solver)
    rough = rough or _rough_gear_pair(begun, solver)
    nominal = nominal or shaped(rough, begun, SHAPE_ITERATIONS, solver)
    begun, rough, nominal = _realigned(begun, rough, nominal, solver)
    if part is evidence:
        return begun, rough, nominal
    whole = evidence if begun.has_index else with_own_angles(evidence)
    rough = _on_the_whole(rough, whole, ROUGH_ITERATIONS, solver)
    return whole, rough, _on_the_whole(nominal, whole, SHAPE_ITERATIONS, solver)


def _realigned(
    evidence: Evidence, rough: Outcome, nominal: Outcome, solver: Solver | None
) -> tuple[Evidence, Outcome, Outcome]:
    """The same, or what follows better, begun from where the meshes of the records stand to each other.

    The ideal wave lacks the harmonics of real teeth, which an accelerometer and slow speeds show above all: then its
    own best angles, stiffness and damping lead astray, to a fit that leaves more than a poorer model does.
    """
    is_told = len(evidence.fit) < 2 or (evidence.has_index and evidence.mesh_index)
    if is_told or flanks_part(evidence) or _follows_each(nominal, evidence):
        return evidence, rough, nominal
    apart = with_own_angles(evidence) if evidence.has_index else evidence
    for wave in begun_aligned(apart, nominal.fitted.cost, solver):
        again = shaped(wave, apart, SHAPE_ITERATIONS, solver)
        if again.fitted.cost < SCANNED * nominal.fitted.cost:
            evidence, rough, nominal = apart, wave, again
    return evidence, rough, nominal


def _follows_each(nominal: Outcome, evidence: Evidence) -> bool:
    """Whether a fit leaves little of what moved in every record: what a lively one leaves hides the quiet ones."""
    return all(
        float(residual.square().sum()) - noise < POORLY * (_moved(record) - noise)
        for residual, record in zip(nominal.fit_residuals, evidence.fitted, strict=True)
        for noise in [len(record.stacked) * evidence.noise**2]
    )


def _moved(record: FitRecord) -> float:
    """Sum of the squares of a record's channels about their means, as residuals count."""
    series = record.weight * record.stacked.reshape(len(record.channels), -1)
    return float((series - series.mean(1, keepdim=True)).square().sum())


def _on_a_part(evidence: Evidence) -> Evidence:
    """The evidence with the first of its long records; as it is where they are short enough."""
    share = fair_share([len(record.stacked) for record in evidence.fit], CALIBRATED)
    short = tuple(shortened(r, int(min(len(r.response), share / len(r.channels)))) for r in evidence.fit)
    is_whole = all(len(a.response) == len(b.response) for a, b in zip(short, evidence.fit, strict=True))
    return evidence if is_whole else replace(evidence, fit=short)


def _on_the_whole(found: Outcome, evidence: Evidence, iterations: int, solver: Solver | None) -> Outcome:
    """What was fitted to a part of records, fitted to all of them."""
    initial = InitialValues(after=found, is_near=True)
    return fit_hypothesis(found.hypothesis, evidence, initial, Rounds(iterations), solver=solver)


def _carried_over(found: Calibration, evidence: Evidence, solver: Solver | None) -> Calibration:
    """A calibration to some of the records on all of them."""
    if not found.evidence.has_index:
        evidence = with_own_angles(evidence)
    evidence = with_unsteady_shafts(evidence) if has_unsteady_shafts(found.evidence.fit) else evidence
    followed = found.followed or len(found.evidence.fit)
    nominal = _of_others(found.nominal, found.evidence, evidence, solver)
    return Calibration(evidence, nominal, None, followed)


def _shaped(evidence: Evidence, solver: Solver | None) -> Iterator[Outcome]:
    """The nominal model of some of the records, of long ones on a part of them and then on all."""
    part = _on_a_part(evidence)
    found = shaped(_rough_gear_pair(part, solver), part, SHAPE_ITERATIONS, solver)
    yield found
    if part is not evidence:
        yield _on_the_whole(found, evidence, SHAPE_ITERATIONS, solver)


def _of_others(found: Outcome, followed: Evidence, evidence: Evidence, solver: Solver | None) -> Outcome:
    """The nominal model of the records that it follows on all of them, none of its parameters moved."""
    names = {record.name for record in followed.fit}
    others = replace(evidence, fit=tuple(record for record in evidence.fit if record.name not in names))
    own = {} if evidence.has_index else dict(angles_of(found.hypothesis, others, evidence.duration, solver))
    own |= found.of_records
    return fit_hypothesis(found.hypothesis, evidence, InitialValues(own=own), NONE, solver=solver)


def _rough_gear_pair(evidence: Evidence, solver: Solver | None) -> Outcome:
    """The contact ratio's wave, the stiffer part of which is that of two pairs of teeth."""
    return upright(_wave_of_gear_pair(evidence, solver), evidence, solver)


def _wave_of_gear_pair(evidence: Evidence, solver: Solver | None) -> Outcome:
    """The contact ratio's wave, with the mesh phase tried all around: one phase, or one of every record.

    Pairs of helical teeth, and of wide ones, take up their load over a good part of a pitch. A wave with corners then
    has harmonics that no record shows, and only a damping far too large takes them away.
    """
    first = first_gear_pair(evidence)
    short = SHORT_PERIODS / natural_frequency_hz(first.model, first.given)
    rounds = Rounds(ROUGH_ITERATIONS, [short, None] if short < evidence.duration else [None])
    found: Outcome | None = None
    for edge in EDGES:
        tried = _wave(with_edge(first, edge), evidence, rounds, solver)
        found = tried if found is None or tried.fitted.cost < SCANNED * found.fitted.cost else found
    if evidence.has_index:
        return found
    scans = 1 if flanks_part(evidence) else MOST_SCANS
    for number in range(scans):  # a phase that is wrong makes stiffness and damping wrong, and they the next phase
        factors = STIFFNESSES if number else STIFFNESSES[1:]  # where it begins is tried already
        tried = [_wave(with_stiffness(found.hypothesis, factor), evidence, rounds, solver) for factor in factors]
        again = min(tried, key=lambda outcome: outcome.fitted.cost)
        is_better = number == 0 or again.fitted.cost < SCANNED * found.fitted.cost
        found = again if again.fitted.cost < found.fitted.cost else found
        if not is_better:
            break
    return found


def _wave(hypothesis: Hypothesis, evidence: Evidence, rounds: Rounds, solver: Solver | None) -> Outcome:
    """One fit of many, from the best angles of the mesh; by what is left out of it none of them is chosen."""
    evidence = replace(evidence, holdout=())
    if evidence.has_index:
        initial, few = InitialValues(phase_starts(hypothesis)), replace(rounds, kept=ANGLES_KEPT)
        return fit_hypothesis(hypothesis, evidence, initial, few, solver=solver)
    angles = angles_of(hypothesis, evidence, rounds.horizons[0] or evidence.duration, solver)
    return fit_hypothesis(hypothesis, evidence, InitialValues(own=angles), rounds, solver=solver)


def _angles_counted(
    evidence: Evidence, solver: Solver | None = None
) -> tuple[Evidence, Outcome | None, Outcome | None]:
    """The evidence with a phase of its own in every record where their angles do not count from one mark.

    An angle that was measured may begin anew in every record, as behind an encoder without an index: then one phase
    of the mesh does not fit them all. The rough fit that was made to find out comes with it, and that with the teeth's
    own shape where it was needed: what the rough wave lacks hides the difference of the two, and a trigger may begin
    all records within a few degrees of the mesh.
    """
    if evidence.has_index and evidence.mesh_index:
        return evidence, None, None
    apart = with_own_angles(evidence)
    if not evidence.has_index or len(evidence.fit) == 1:
        return evidence if evidence.has_index else apart, None, None
    one, many = (_rough_gear_pair(either, solver) for either in (evidence, apart))
    if one.fitted.cost > APART * many.fitted.cost:
        return (evidence, one, None) if _are_in_line(many, evidence) else (apart, many, None)
    if leaves_noise(one, evidence):
        return evidence, one, None
    own = shaped(one, evidence, SHAPE_ITERATIONS, solver)
    if own.fitted.cost <= APART * noise_power(evidence):  # nothing leaves so much less than the noise
        return evidence, one, own
    of_many = shaped(many, apart, SHAPE_ITERATIONS, solver)
    is_one = own.fitted.cost <= APART * of_many.fitted.cost or _are_in_line(of_many, evidence)
    return (evidence, one, own) if is_one else (apart, many, of_many)


def _are_in_line(many: Outcome, evidence: Evidence) -> bool:
    """Whether phases of single records agree but for a delay, which turns them by as much as the shaft turns faster.

    Phases of angles that begin anywhere do so by chance alone.
    """
    begins = f"{MESH_PHASE.name}{SEPARATOR}"
    found = {name.removeprefix(begins): value for name, value in many.values.items() if name.startswith(begins)}
    told = [record for record in evidence.fit if record.name in found and "pinion_speed" in record.conditions]
    if len(told) < FEWEST_PHASES:
        return False
    speeds = torch.tensor([record.conditions["pinion_speed"] for record in told], dtype=torch.float64)
    phases = torch.tensor([found[record.name] for record in told], dtype=torch.float64)
    slopes = torch.linspace(-pi, pi, SLOPES, dtype=torch.float64) / speeds.abs().max()
    agreement = torch.exp(1j * (phases - slopes.unsqueeze(1) * speeds)).mean(1).abs().max()
    return float(2 * (1 - agreement)) <= IN_LINE**2


# how the nominal model of a system is fitted, by the first of these traits that it has
NOMINAL: dict[Trait, Callable[[Evidence, Solver | None], Calibration]] = {
    Trait.TEETH: _gear_pair_calibrated,
    Trait.REST: _oscillator_calibrated,
}
