"""Step 3: the nominal simulation at its best, so that wrong parameters do not masquerade as physics."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from math import ceil, cos, inf, log, pi, sin, sqrt

import torch

from gear_damping.errors import InputError, Problem
from gear_damping.explanation.evidence import Evidence, with_own_angles
from gear_damping.explanation.hypothesis import Hypothesis, Outcome, fit_hypothesis, natural_frequency_hz
from gear_damping.identification.oscillator import (
    DAMPING,
    GAIN,
    expected_about,
    fit_oscillator,
    linear_model,
    linear_oscillator,
)
from gear_damping.identification.output_error.angles import STARTS, angle_bases, harmonics_to_resonance, scanned
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FreeParameter
from gear_damping.identification.output_error.segments import in_segments
from gear_damping.physics.effects.backlash import Backlash
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.effects.mesh_stiffness_shape import MeshStiffnessShape
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.simulation.solver_settings import Solver

MESH, SHAPE = "fourier_mesh_stiffness", "mesh_stiffness_shape"
RENAMED = {
    "mesh_stiffness_max": f"{MESH}.maximum",
    "mesh_stiffness_min": f"{MESH}.minimum",
    "contact_ratio": f"{MESH}.contact_ratio",
    "backlash_gap": "backlash.gap",
    "damping_ratio": DAMPING,
}
LESS_DAMPING = 0.05  # of what was found: what a local minimum takes for damping
SHAPE_ITERATIONS = 30
SHAPE_BAND = 1.6  # harmonics of the stiffness count up to this many natural frequencies, at the slowest record,
FEWEST_HARMONICS, MOST_HARMONICS = 6, 20  # within these
EXPECTED_SHAPE = 0.1  # of the mean stiffness over the harmonic: what real teeth add to the ideal wave
SHORT_PERIODS = 40.0  # natural periods of the first round
FIRST_RATIO = 0.01
MOST_SCANS = 8  # of the records' angles, each followed by a fit
SHAPED = 3.0  # noise variances: what a fit with all its shapes may leave before angles are looked at again
SCANNED = 0.99  # of the cost before: less is no reason for another scan
INDEX_ERROR = 0.1  # rad of the mesh: how well a file that states an index knows where the mesh begins
APART = 1.5  # times the cost of a phase for every record: one phase of all leaves that much where there is none; angles
# that begin anywhere agree that well once in a thousand times, for three records
NOT_FINITE = Problem(
    "parameters",
    "with what is stated of the rig and its load, the nominal simulation does not stay finite",
    remedy="check the values and units of parameters, torques and speeds",
)
LEAST_DAMPING = 1e-5  # of the first guess, N s/m


def calibrated(evidence: Evidence, solver: Solver | None = None, rough: Outcome | None = None) -> Outcome:
    """The nominal model fitted to the evidence.

    Args:
        evidence: The records.
        solver: Settings of the solver.
        rough: A gear pair's fit without the shape of its stiffness, where that was made.

    Raises:
        InputError: with what is stated of the rig it cannot be simulated.
    """
    with _simulable():
        is_gear = evidence.system == "gear_pair"
        found = _gear_pair(evidence, solver, rough) if is_gear else _oscillator(evidence, solver)
    if not bool(found.fitted.prediction.sensitivity.isfinite().all()):
        raise InputError(NOT_FINITE)
    return found


@contextmanager
def _simulable() -> Iterator[None]:
    """What is stated of a rig may be far from any that moves as was recorded."""
    try:
        yield
    except torch.linalg.LinAlgError as error:
        raise InputError(NOT_FINITE) from error


def _oscillator(evidence: Evidence, solver: Solver | None) -> Outcome:
    """Stiffness, damping, gain; offsets of force and response as nuisances."""
    found = fit_oscillator(evidence.fit, known=evidence.known, segments=evidence.segments)
    free, given, _ = linear_model(evidence.fit, evidence.known)
    free = [_from_here(parameter, found.given[parameter.name]) for parameter in free]
    model = linear_oscillator(evidence.fit)
    nominal = Hypothesis(model.system, tuple(model.effects), given, tuple(free))
    return fit_hypothesis(nominal, evidence, solver=solver)


def _from_here(parameter: FreeParameter, value: float) -> FreeParameter:
    """The parameter from a value that was found; a gain keeps its sign."""
    logarithmic = parameter.logarithmic or (parameter.name == GAIN and value > 0)
    expected = parameter.start if parameter.expected is None and parameter.logarithmic else parameter.expected
    deviation = parameter.deviation
    if logarithmic and not parameter.logarithmic:  # a relative one counts as such
        deviation = parameter.deviation / abs(parameter.start)
    return replace(parameter, start=value, logarithmic=logarithmic, expected=expected, deviation=deviation)


def recalibrated(nominal: Outcome, evidence: Evidence, solver: Solver | None = None) -> Outcome:
    """The nominal model fitted to the evidence in segments, from where it was and from little damping."""
    hypothesis = nominal.hypothesis
    starts = torch.zeros(2, len(hypothesis.common), dtype=torch.float64)
    places = [i for i, parameter in enumerate(hypothesis.free) if parameter.name == DAMPING]
    starts[1, places] = log(LESS_DAMPING)
    return fit_hypothesis(hypothesis, evidence, starts, iterations=SHAPE_ITERATIONS, solver=solver)


def restarted(evidence: Evidence, solver: Solver | None = None) -> Outcome | None:
    """A gear pair's nominal model before the shape of its stiffness was fitted, with that shape free.

    Where much is missing, the free shape bends to what it is not made for; a cause is better sought from here.
    """
    if evidence.system != "gear_pair" or evidence.segments:
        return None
    rough = _rough_gear_pair(evidence, solver)
    return _shaped(rough, evidence, 0, solver)


def _gear_pair(evidence: Evidence, solver: Solver | None, rough: Outcome | None) -> Outcome:
    """Mesh phase by a scan, then damping and stiffness, then free harmonics of the stiffness."""
    return _shaped(rough or _rough_gear_pair(evidence, solver), evidence, SHAPE_ITERATIONS, solver)


def _shaped(rough: Outcome, evidence: Evidence, iterations: int, solver: Solver | None) -> Outcome:
    shaped = _with_shape(rough.hypothesis, _shape_harmonics(rough, evidence))
    options = {"iterations": iterations, "solver": solver, "scan": True}
    found = fit_hypothesis(shaped, evidence, after=rough, **options)
    samples = sum(len(record.stacked) for record in evidence.fitted)
    if evidence.has_index or not iterations or found.fitted.cost < SHAPED * samples * evidence.noise**2:
        return found
    angles = _angles(found.hypothesis, evidence, evidence.duration, solver)
    again = fit_hypothesis(found.hypothesis, evidence, own=angles, **options)
    return again if again.fitted.cost < SCANNED * found.fitted.cost else found


def _rough_gear_pair(evidence: Evidence, solver: Solver | None) -> Outcome:
    """The contact ratio's wave, with the mesh phase tried all around: one phase, or one of every record."""
    first = _first_gear_pair(evidence)
    short = SHORT_PERIODS / natural_frequency_hz(first.model, first.given)
    horizons = [short, None] if short < evidence.duration else [None]
    options = {"horizons": horizons, "iterations": 12, "solver": solver}
    if evidence.has_index:
        starts = torch.zeros(STARTS, len(first.common), dtype=torch.float64)
        places = [i for i, p in enumerate(first.free) if p.name == "mesh_phase"]
        starts[:, places] = torch.linspace(0, 2 * pi, STARTS + 1, dtype=torch.float64)[:-1, None]
        return fit_hypothesis(first, evidence, starts if places else None, kept=0.12, **options)
    found: Outcome | None = None
    for _ in range(MOST_SCANS):  # a phase that is wrong makes stiffness and damping wrong, and they the next phase
        hypothesis = first if found is None else found.hypothesis
        angles = _angles(hypothesis, evidence, short, solver)
        again = fit_hypothesis(hypothesis, evidence, own=angles, **options)
        is_better = found is None or again.fitted.cost < SCANNED * found.fitted.cost
        found = again if found is None or again.fitted.cost < found.fitted.cost else found
        if not is_better:
            break
    return found


def angles_counted(evidence: Evidence, solver: Solver | None = None) -> tuple[Evidence, Outcome | None]:
    """The evidence with a phase of its own in every record where their angles do not count from one mark.

    An angle that was measured may begin anew in every record, as behind an encoder without an index: then one phase
    of the mesh does not fit them all. The rough fit that was made to find out comes with it.
    """
    if evidence.system != "gear_pair" or (evidence.has_index and evidence.mesh_index):
        return evidence, None
    apart = with_own_angles(evidence)
    if not evidence.has_index or len(evidence.fit) == 1:
        return evidence if evidence.has_index else apart, None
    with _simulable():
        one, many = (_rough_gear_pair(either, solver) for either in (evidence, apart))
    return (evidence, one) if one.fitted.cost <= APART * many.fitted.cost else (apart, many)


def _angles(hypothesis: Hypothesis, evidence: Evidence, horizon: float, solver: Solver | None) -> Mapping[str, float]:
    """The best angle of every record's mesh, of several."""
    pieces = in_segments(evidence.fit, evidence.segments)
    problem = OutputErrorProblem(hypothesis.model, hypothesis.given, hypothesis.free, pieces, solver, evidence.noise)
    return scanned(problem, torch.zeros(problem.n_shared, dtype=torch.float64), horizon, angle_bases(problem))


def stated_frequency(evidence: Evidence) -> float:
    """The natural frequency in Hz that follows from what the file states of the rig."""
    if evidence.system != "gear_pair":
        return sqrt(evidence.parameters["stiffness"]) / (2 * pi)
    first = _first_gear_pair(evidence)
    return natural_frequency_hz(first.model, first.given)


def _first_gear_pair(evidence: Evidence) -> Hypothesis:
    """The nominal gear pair with what the file says of it: known, expected, or a start."""
    stated = {RENAMED.get(name, name): value for name, value in evidence.parameters.items()}
    uncertain = {RENAMED.get(name, name): relative for name, relative in evidence.known.uncertainty.items()}
    effects = [FourierMeshStiffness(), ViscousDamping()]
    ratio = stated.pop(DAMPING, FIRST_RATIO)
    if stated.get("backlash.gap", 0.0) > 0:
        effects.append(Backlash())
    else:
        stated.pop("backlash.gap", None)
    defaults = {p.name: p.default for p in FourierMeshStiffness.parameters}
    high, low = (stated.get(f"{MESH}.{end}", defaults[end]) for end in ("maximum", "minimum"))
    contact_ratio = stated.get(f"{MESH}.contact_ratio") or _contact_ratio(stated)
    system = GearPair(gear_torque_mode=evidence.gear_torque_mode)
    start = stated | {f"{MESH}.maximum": high, f"{MESH}.minimum": low, f"{MESH}.contact_ratio": contact_ratio}
    derived = Model(system, effects).prepare(Model(system, effects).values(1, **start)).derived
    damping = 2 * ratio * float((derived["mean_stiffness"] * derived["equivalent_mass"])[0]) ** 0.5
    free = [
        FreeParameter(f"{MESH}.maximum", high, logarithmic=True),
        FreeParameter(f"{MESH}.minimum", low, logarithmic=True),
        FreeParameter(f"{MESH}.contact_ratio", contact_ratio, 0.2, lower=1.02, upper=1.98),
    ]
    if damping > 0:
        lower = LEAST_DAMPING * damping
        free = [FreeParameter(DAMPING, damping, logarithmic=True, lower=lower), *free]
    if evidence.has_index:
        free = [FreeParameter("mesh_phase", 0.0, deviation=INDEX_ERROR if evidence.mesh_index else inf), *free]
    free = [expected_about(parameter, uncertain.pop(parameter.name, None)) for parameter in free]
    free += [_uncertain(name, stated[name], relative) for name, relative in uncertain.items() if name in stated]
    return Hypothesis(system, tuple(effects), start | {DAMPING: damping}, tuple(free))


def _uncertain(name: str, value: float, relative: float) -> FreeParameter:
    """A known parameter with its expectation."""
    return expected_about(FreeParameter(name, value, abs(value), logarithmic=value > 0), relative)


def _contact_ratio(stated: Mapping[str, float]) -> float:
    """Of standard teeth with these numbers of teeth and pressure angle (ISO 21771), within what a spur pair has."""
    default = {p.name: p.default for p in GearPair.parameters}
    teeth = [stated.get(name, default[name]) for name in ("n_teeth_pinion", "n_teeth_gear")]
    angle = stated.get("pressure_angle", default["pressure_angle"])
    reach = sum(sqrt((z / 2 + 1) ** 2 - (z / 2 * cos(angle)) ** 2) for z in teeth) - sum(teeth) / 2 * sin(angle)
    return min(max(reach / (pi * cos(angle)), 1.1), 1.9)


def _shape_harmonics(rough: Outcome, evidence: Evidence) -> int:
    """Harmonics of the mesh that the natural frequency lets through, at the slowest record."""
    count = ceil(SHAPE_BAND * harmonics_to_resonance(rough.hypothesis.model, rough.flat_given(), evidence.fit))
    return min(max(count, FEWEST_HARMONICS), MOST_HARMONICS)


def _with_shape(rough: Hypothesis, harmonics: int) -> Hypothesis:
    """Free harmonics take over from the contact ratio, which they contain."""
    names = [f"{SHAPE}.{part}[{h}]" for part in ("in_phase", "quadrature") for h in range(harmonics)]
    taken_over = ("mesh_phase", f"{MESH}.minimum", f"{MESH}.contact_ratio")
    free = tuple(p for p in rough.free if p.name not in taken_over)
    zeros = (0.0,) * harmonics
    given = rough.given | {f"{SHAPE}.in_phase": zeros, f"{SHAPE}.quadrature": zeros}
    return Hypothesis(
        rough.system,
        (*rough.effects, MeshStiffnessShape()),
        given,
        (*free, *(_harmonic(name) for name in names)),
    )


def _harmonic(name: str) -> FreeParameter:
    """Free within what teeth can be: a harmonic that the fitted speeds hardly show must not be driven by noise."""
    order = int(name.partition("[")[2].rstrip("]")) + 1
    return FreeParameter(name, 0.0, scale=0.02, lower=-0.5, upper=0.5, deviation=EXPECTED_SHAPE / order)
