"""The nominal model of a gear pair: what the file says of it, and what of that is fitted."""

from collections.abc import Mapping
from dataclasses import replace
from math import ceil, cos, floor, hypot, inf, log, pi, sin, sqrt

import torch

from gear_damping.explanation.evidence.records import Evidence, all_stand
from gear_damping.explanation.model.fitting import InitialValues, fit_hypothesis
from gear_damping.explanation.model.hypothesis import Given, Hypothesis, Outcome, natural_frequency_hz, settled_at
from gear_damping.identification.oscillator.linear_model import DAMPING, LAWS, expected_about, uncertain_parameter
from gear_damping.identification.output_error.angles import STARTS, angle_bases, harmonics_to_resonance, scanned
from gear_damping.identification.output_error.least_squares import NONE, Rounds
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FreeParameter
from gear_damping.identification.output_error.segments import in_segments
from gear_damping.measurement.spectral_floor import spectrum_of
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
FLAT = {**RENAMED, **LAWS}  # of an oscillator too
PHASED = ("mesh_phase", f"{MESH}.minimum", f"{MESH}.contact_ratio")  # what of a mesh shows while teeth change alone
TORQUES = ("pinion_torque", "gear_torque")
SHAPE_BAND = 1.6  # harmonics of the stiffness count up to this many natural frequencies, at the slowest record, at
FEWEST_HARMONICS, MOST_OF_BAND = 6, 20  # of the mesh; how many the resonance lets through is kept within these
MOST_HARMONICS = 40  # where sensors show them: an accelerometer weighs the highest as the lowest
EXPECTED_SHAPE = 0.1  # of the mean stiffness over the harmonic: what real teeth add to the ideal wave
ADVANCE = 0.5  # of x, by which pinion and gear each say differently which teeth carry; nobody knows what these follow,
MOST_ADVANCE = 1.0  # ... but either wheel is all of x away from the other: beyond, it stands for something else
EDGE = 0.1  # of a mesh period, over which a pair takes up its load: as of real teeth, whose corners are relieved
SERIES = (8, 12, 16, MOST_OF_BAND)  # harmonics of the ideal wave: a kernel is compiled for each of few lengths
FIRST_RATIO = 0.01  # damping ratio to begin with where none is stated
INDEX_ERROR = 0.1  # rad of the mesh: how well a file that states an index knows where the mesh begins
ROUGH_ITERATIONS = 12  # of each round while the teeth have the contact ratio's shape
ANGLES_KEPT = 0.12  # of those all around: after the first round one or two valleys are left
SHAPED = 3.0  # noise variances: what a fit with all its shapes may leave before angles are looked at again
SCANNED = 0.99  # of the cost before: less is no reason for another scan
UPRIGHT = 1.01  # of the cost: the same wave
LEAST_DAMPING = 1e-4  # of critical: what rings longer stands for a line that folds from beyond the sampling rate


def stated_mesh_frequency(evidence: Evidence) -> float:
    """The natural frequency in Hz that follows from what the file states of a gear pair."""
    first = first_gear_pair(evidence)
    return natural_frequency_hz(first.model, first.given)


def is_standing(evidence: Evidence) -> bool:
    """Whether the shafts stand in all records, so that the teeth that carry never change."""
    return all_stand(evidence.fit)


def first_gear_pair(evidence: Evidence) -> Hypothesis:
    """The nominal gear pair with what the file says of it: known, expected, or a start.

    Of a standing one the stiffness is one number, and which teeth carry is not told: a contact ratio of 2 has them all
    carry always.
    """
    stated = {RENAMED.get(name, name): value for name, value in evidence.parameters.items()}
    uncertain = {RENAMED.get(name, name): relative for name, relative in evidence.known.uncertainty.items()}
    effects = [FourierMeshStiffness(), ViscousDamping()]
    ratio = stated.pop(DAMPING, 0.0) or FIRST_RATIO
    if stated.get("backlash.gap", 0.0) > 0:
        effects.append(Backlash())
    else:
        stated.pop("backlash.gap", None)
    defaults = {p.name: p.default for p in FourierMeshStiffness.parameters}
    high, low = (stated.get(f"{MESH}.{end}", defaults[end]) for end in ("maximum", "minimum"))
    contact_ratio = stated.get(f"{MESH}.contact_ratio") or _contact_ratio(stated)
    untold = PHASED if is_standing(evidence) else ()
    contact_ratio = 2.0 if untold else contact_ratio
    system = evidence.base(gear_torque_mode=evidence.gear_torque_mode)
    wave = {f"{MESH}.maximum": high, f"{MESH}.minimum": low, f"{MESH}.contact_ratio": contact_ratio}
    start = typical_torques(evidence) | stated | wave
    derived = Model(system, effects).prepare(Model(system, effects).values(1, **start)).derived
    damping = 2 * ratio * float((derived["mean_stiffness"] * derived["equivalent_mass"])[0]) ** 0.5
    free = [
        FreeParameter(f"{MESH}.maximum", high, logarithmic=True),
        FreeParameter(f"{MESH}.minimum", low, logarithmic=True),
        FreeParameter(f"{MESH}.contact_ratio", contact_ratio, 0.2, lower=1.02, upper=1.98),
    ]
    free = [FreeParameter(DAMPING, damping, logarithmic=True, lower=LEAST_DAMPING * damping / ratio), *free]
    if evidence.has_index:
        free = [FreeParameter("mesh_phase", 0.0, deviation=INDEX_ERROR if evidence.mesh_index else inf), *free]
    if untold:
        free = [_of_any_teeth(p, stated, uncertain) if p.name == f"{MESH}.maximum" else p for p in free]
    free = [expected_about(parameter, uncertain.pop(parameter.name, None)) for parameter in free]
    declared = Model(system, effects).parameters()
    free += [
        replace(uncertain_parameter(declared[name], stated[name], relative), name=name)
        for name, relative in uncertain.items()
        if name in stated
    ]
    told = tuple(parameter for parameter in free if parameter.name not in untold)
    return Hypothesis(system, tuple(effects), start | {DAMPING: damping}, told)


def _of_any_teeth(parameter: FreeParameter, stated: Mapping[str, float], uncertain: dict[str, float]) -> FreeParameter:
    """The one stiffness of a pair that stands, expected anywhere between that of one pair of teeth and that of two."""
    relative, low = uncertain.pop(parameter.name, None), stated.get(f"{MESH}.minimum")
    if not relative or not low:
        return parameter
    spread = abs(log(parameter.start / low)) / sqrt(12)  # the standard deviation of what is alike in between
    return replace(parameter, expected=sqrt(parameter.start * low), deviation=hypot(relative, spread))


def typical_torques(evidence: Evidence) -> dict[str, float]:
    """Torques that the deflection of a record has its size from, root mean square over records, in N*m.

    Every record is simulated with its own; sizes of effects, and the velocity that damping ratios belong to, are those
    of this one.
    """
    found = {}
    for name in TORQUES:
        stated = torch.tensor([record.conditions.get(name, 0.0) for record in evidence.fit], dtype=torch.float64)
        if bool(stated.any()):
            found[name] = float(stated.square().mean().sqrt() * stated.sum().sign())
    return {name: value for name, value in found.items() if value}


def standing(evidence: Evidence, solver: Solver | None = None) -> Outcome:
    """A standing gear pair, fitted from what is stated and from where it rings at the strongest line of a record."""
    first = first_gear_pair(evidence)
    record, own = evidence.fit[0], natural_frequency_hz(first.model, first.given)
    found = spectrum_of(record.response.numpy(), record.sampling_rate)
    begun = [first] if found is None else [first, with_stiffness(first, (found.strongest / own) ** 2)]
    tried = [fit_hypothesis(hypothesis, evidence, solver=solver) for hypothesis in begun]
    return min(tried, key=lambda outcome: outcome.fitted.cost)


def upright(found: Outcome, evidence: Evidence, solver: Solver | None = None) -> Outcome:
    """A fit whose larger stiffness is that of two pairs of teeth: the ideal wave upside down is the same one, moved.

    What stands to the mesh where one pair carries alone, as the error of a tooth, would be sought half a pitch away.
    """
    high, low, ratio = (found.values.get(f"{MESH}.{name}", 0.0) for name in ("maximum", "minimum", "contact_ratio"))
    if high >= low or not ratio:
        return found
    later = 2 * pi * (ratio - 1)
    turned = {f"{MESH}.maximum": low, f"{MESH}.minimum": high, f"{MESH}.contact_ratio": 3 - ratio}
    if "mesh_phase" in found.values:
        turned["mesh_phase"] = found.values["mesh_phase"] - later
    own = {name: value - later * name.startswith("mesh_phase") for name, value in found.of_records.items()}
    initial, settled = InitialValues(own=own, is_near=True), settled_at(found.hypothesis, turned)
    again = fit_hypothesis(settled, evidence, initial, Rounds(ROUGH_ITERATIONS), solver=solver)
    return again if again.fitted.cost <= UPRIGHT * found.fitted.cost else found


def shaped(rough: Outcome, evidence: Evidence, iterations: int, solver: Solver | None = None) -> Outcome:
    """A gear pair's nominal model with free harmonics of the stiffness, fitted from one without.

    Args:
        rough: The fit without.
        evidence: The records.
        iterations: At most so many linearisations; with none, the harmonics are free and still zero.
        solver: Settings of the solver.
    """
    rounds = Rounds(iterations)
    shaped = with_shape(rough, evidence, _shape_harmonics(rough, evidence, solver))
    found = fit_hypothesis(shaped, evidence, InitialValues(after=rough), rounds, solver=solver)
    if evidence.has_index or not iterations or leaves_noise(found, evidence):
        return found
    angles = angles_of(found.hypothesis, evidence, evidence.duration, solver)
    again = fit_hypothesis(found.hypothesis, evidence, InitialValues(own=angles), rounds, solver=solver)
    return again if again.fitted.cost < SCANNED * found.fitted.cost else found


def leaves_noise(found: Outcome, evidence: Evidence) -> bool:
    """Whether a fit leaves hardly more than the noise, so that nothing hides behind what it lacks."""
    return found.fitted.cost < SHAPED * noise_power(evidence)


def noise_power(evidence: Evidence) -> float:
    """What a fit costs that leaves the noise alone."""
    return sum(len(record.stacked) for record in evidence.fitted) * evidence.noise**2


def angles_of(hypothesis: Hypothesis, evidence: Evidence, horizon: float, solver: Solver | None) -> Mapping[str, float]:
    """The best angle of every record's mesh, of several."""
    segmented = in_segments(evidence.fit, evidence.segments)
    problem = OutputErrorProblem(hypothesis.model, hypothesis.given, hypothesis.free, segmented, solver, evidence.noise)
    return scanned(problem, torch.zeros(problem.n_shared, dtype=torch.float64), horizon, angle_bases(problem))


def phase_starts(hypothesis: Hypothesis) -> torch.Tensor | None:
    """Coordinates of starts all around the mesh, (starts, n); None where its angle is not fitted."""
    places = [i for i, p in enumerate(hypothesis.free) if p.name == "mesh_phase"]
    starts = torch.zeros(STARTS, len(hypothesis.common), dtype=torch.float64)
    starts[:, places] = torch.linspace(0, 2 * pi, STARTS + 1, dtype=torch.float64)[:-1, None]
    return starts if places else None


def with_stiffness(hypothesis: Hypothesis, factor: float) -> Hypothesis:
    """A gear pair whose mesh begins stiffer by a factor."""
    ends = [f"{MESH}.maximum", f"{MESH}.minimum"]
    given = hypothesis.given | {name: factor * hypothesis.given[name] for name in ends}
    free = tuple(replace(p, start=factor * p.start) if p.name in ends else p for p in hypothesis.free)
    return replace(hypothesis, given=given, free=free)


def with_edge(hypothesis: Hypothesis, edge: float) -> Hypothesis:
    """A gear pair whose pairs of teeth take up their load over a share of a mesh period."""
    return replace(hypothesis, given=hypothesis.given | {f"{MESH}.edge": edge})


def _contact_ratio(stated: Mapping[str, float]) -> float:
    """Of standard teeth with these numbers of teeth and pressure angle (ISO 21771), within what a spur pair has."""
    default = {p.name: p.default for p in GearPair.parameters}
    teeth = [stated.get(name, default[name]) for name in ("n_teeth_pinion", "n_teeth_gear")]
    angle = stated.get("pressure_angle", default["pressure_angle"])
    reach = sum(sqrt((z / 2 + 1) ** 2 - (z / 2 * cos(angle)) ** 2) for z in teeth) - sum(teeth) / 2 * sin(angle)
    return min(max(reach / (pi * cos(angle)), 1.1), 1.9)


def _shape_harmonics(rough: Outcome, evidence: Evidence, solver: Solver | None) -> int:
    """Harmonics of the mesh that the natural frequency lets through, or more where the sensors would show them.

    Up to the sampling rate: without a filter before it, those above half of it are folded back among the lower ones.
    """
    model, given = rough.hypothesis.model, rough.flat_given()
    count = passed_harmonics(model, given, evidence)
    resonance = harmonics_to_resonance(model, given, evidence.fit)
    sampled = resonance * evidence.sampling_rate / natural_frequency_hz(model, given)
    most = min(MOST_HARMONICS, floor(sampled))
    return max(count, _seen_harmonics(rough, most, evidence, solver)) if most > count else count


def passed_harmonics(model: Model, given: Given, evidence: Evidence) -> int:
    """Harmonics of the mesh that the natural frequency lets through."""
    resonance = harmonics_to_resonance(model, given, evidence.fit)
    return min(max(ceil(SHAPE_BAND * resonance), FEWEST_HARMONICS), MOST_OF_BAND)


def _seen_harmonics(rough: Outcome, most: int, evidence: Evidence, solver: Solver | None) -> int:
    """The highest harmonic that the records would show if it had the size that real teeth may give it."""
    hypothesis = with_shape(rough, evidence, most)
    probe = fit_hypothesis(hypothesis, evidence, InitialValues(after=rough), NONE, solver=solver)
    moved = probe.fitted.prediction.sensitivity[0].square().sum((0, 1))
    seen = [
        _order(p.name)
        for energy, p in zip(moved.tolist(), probe.problem.free, strict=False)
        if p.name.startswith(SHAPE)
        and energy * (p.deviation / p.scale) ** 2 > evidence.settings.seen_in_fit * evidence.noise**2
    ]
    return max(seen, default=0)


def with_shape(fitted: Outcome, evidence: Evidence, harmonics: int) -> Hypothesis:
    """Free harmonics take over from the contact ratio, which they contain.

    The ideal wave gets edges, and every harmonic that the natural frequency lets through: a load may move the edges.
    """
    rough = fitted.hypothesis
    free = tuple(p for p in rough.free if p.name not in PHASED)
    within = {"lower": -MOST_ADVANCE, "upper": MOST_ADVANCE, "deviation": ADVANCE, "expected": 0.0}
    advance = FreeParameter("contact_advance", 0.0, ADVANCE, **within)
    zeros = (0.0,) * harmonics
    edge = max(EDGE, float(rough.given.get(f"{MESH}.edge", 0.0)))
    given = rough.given | {f"{SHAPE}.in_phase": zeros, f"{SHAPE}.quadrature": zeros, f"{MESH}.edge": edge}
    passed = min(passed_harmonics(rough.model, fitted.flat_given(), evidence), harmonics)
    mesh = FourierMeshStiffness(n_harmonics=min(length for length in SERIES if length >= passed))
    return Hypothesis(
        rough.system,
        (*(mesh if effect.name == MESH else effect for effect in rough.effects), MeshStiffnessShape()),
        given,
        (*free, *free_harmonics(harmonics), advance),
        causes=rough.causes,
    )


def free_harmonics(count: int) -> list[FreeParameter]:
    """Free within what teeth can be: a harmonic that the fitted speeds hardly show must not be driven by noise."""
    names = [f"{SHAPE}.{part}[{h}]" for part in ("in_phase", "quadrature") for h in range(count)]
    within = {"scale": 0.02, "lower": -0.5, "upper": 0.5}
    return [FreeParameter(name, 0.0, **within, deviation=EXPECTED_SHAPE / _order(name)) for name in names]


def _order(name: str) -> int:
    """The order of the mesh that an element of the shape belongs to."""
    return int(name.partition("[")[2].rstrip("]")) + 1
