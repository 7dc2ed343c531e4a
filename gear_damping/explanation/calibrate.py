"""Step 3: the nominal simulation at its best, so that wrong parameters do not masquerade as physics."""

from math import ceil, log, pi

import torch

from gear_damping.explanation.evidence import Evidence
from gear_damping.explanation.hypothesis import Hypothesis, Outcome, fit_hypothesis, natural_frequency_hz
from gear_damping.identification.oscillator import fit_oscillator
from gear_damping.identification.output_error.problem import OFFSET, FreeParameter
from gear_damping.physics.effects.backlash import Backlash
from gear_damping.physics.effects.fourier_mesh_stiffness import FourierMeshStiffness
from gear_damping.physics.effects.mesh_stiffness_shape import MeshStiffnessShape
from gear_damping.physics.effects.offset_force import OffsetForce
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.solver_settings import Solver

MESH, DAMPING, SHAPE = "fourier_mesh_stiffness", "viscous_damping.damping_coefficient", "mesh_stiffness_shape"
RENAMED = {
    "mesh_stiffness_max": f"{MESH}.maximum",
    "mesh_stiffness_min": f"{MESH}.minimum",
    "contact_ratio": f"{MESH}.contact_ratio",
    "backlash_gap": "backlash.gap",
}
NOT_OF_THE_MODEL = ("damping_ratio", "torque_gain", "torque_offset", "damping_coefficient")
LESS_DAMPING = 0.05  # of what was found: what a local minimum takes for damping
PHASES = 18  # starts of the mesh phase
SHAPE_ITERATIONS = 30
SHAPE_BAND = 1.6  # harmonics of the stiffness count up to this many natural frequencies, at the slowest record,
FEWEST_HARMONICS, MOST_HARMONICS = 6, 20  # within these
EXPECTED_SHAPE = 0.1  # of the mean stiffness over the harmonic: what real teeth add to the ideal wave
SHORT_PERIODS = 40.0  # natural periods of the first round
FIRST_RATIO = 0.01


def calibrated(evidence: Evidence, solver: Solver | None = None) -> Outcome:
    """The nominal model fitted to the evidence."""
    return _gear_pair(evidence, solver) if evidence.system == "gear_pair" else _oscillator(evidence, solver)


def _oscillator(evidence: Evidence, solver: Solver | None) -> Outcome:
    """Stiffness, damping, gain; offsets of force and response as nuisances."""
    found = fit_oscillator(evidence.fit)
    forced = "force" in evidence.fit[0].inputs
    spread = float(torch.cat([record.response for record in evidence.fit]).std())
    free = [
        FreeParameter("stiffness", found.given["stiffness"], logarithmic=True),
        FreeParameter(DAMPING, found.given[DAMPING], logarithmic=True),
        FreeParameter(OFFSET, found.offset, scale=spread),
    ]
    effects = [ViscousDamping()]
    if forced:
        gain, force = found.given["force_gain"], found.given["offset_force.force"]
        free += [
            FreeParameter("force_gain", gain, logarithmic=True)
            if gain > 0
            else FreeParameter("force_gain", gain, abs(gain))
        ]
        free += [FreeParameter("offset_force.force", force, scale=found.given["stiffness"] * spread)]
        effects.append(OffsetForce())
    nominal = Hypothesis(Oscillator(), tuple(effects), {"amplitude": spread}, tuple(free))
    return fit_hypothesis(nominal, evidence, solver=solver)


def recalibrated(nominal: Outcome, evidence: Evidence, solver: Solver | None = None) -> Outcome:
    """The nominal model fitted to the evidence in pieces, from where it was and from little damping."""
    hypothesis = nominal.hypothesis
    starts = torch.zeros(2, len(hypothesis.free), dtype=torch.float64)
    starts[1, [p.name for p in hypothesis.free].index(DAMPING)] = log(LESS_DAMPING)
    return fit_hypothesis(hypothesis, evidence, starts, iterations=SHAPE_ITERATIONS, solver=solver)


def restarted(evidence: Evidence, solver: Solver | None = None) -> Outcome | None:
    """A gear pair's nominal model before the shape of its stiffness was fitted, with that shape free.

    Where much is missing, the free shape bends to what it is not made for; a cause is better sought from here.
    """
    if evidence.system != "gear_pair" or evidence.piece:
        return None
    rough = _rough_gear_pair(evidence, solver)
    return _shaped(rough, evidence, 0, solver)


def _gear_pair(evidence: Evidence, solver: Solver | None) -> Outcome:
    """Mesh phase by a scan, then damping and stiffness, then free harmonics of the stiffness."""
    return _shaped(_rough_gear_pair(evidence, solver), evidence, SHAPE_ITERATIONS, solver)


def _shaped(rough: Outcome, evidence: Evidence, iterations: int, solver: Solver | None) -> Outcome:
    shaped = _with_shape(rough.hypothesis, _shape_harmonics(rough, evidence))
    return fit_hypothesis(shaped, evidence, after=rough, iterations=iterations, solver=solver)


def _rough_gear_pair(evidence: Evidence, solver: Solver | None) -> Outcome:
    first = _first_gear_pair(evidence)
    rate = evidence.sampling_rate
    total = max(len(record.response) for record in evidence.fit)
    short = min(total, round(SHORT_PERIODS * rate / 5000.0))
    starts = torch.zeros(PHASES, len(first.free), dtype=torch.float64)
    starts[:, 0] = torch.linspace(0, 2 * pi, PHASES + 1, dtype=torch.float64)[:-1]
    horizons = [short, total] if short < total else [total]
    return fit_hypothesis(first, evidence, starts, horizons=horizons, iterations=12, kept=0.12, solver=solver)


def _first_gear_pair(evidence: Evidence) -> Hypothesis:
    given = {RENAMED.get(k, k): v for k, v in evidence.parameters.items() if k not in NOT_OF_THE_MODEL}
    system = GearPair(gear_torque_mode=evidence.gear_torque_mode)
    effects = [FourierMeshStiffness(), ViscousDamping()]
    if given.get("backlash.gap", 0.0) > 0:
        effects.append(Backlash())
    else:
        given.pop("backlash.gap", None)
    high, low = given.get(f"{MESH}.maximum", 4e8), given.get(f"{MESH}.minimum", 2e8)
    ratio = evidence.parameters.get("damping_ratio", FIRST_RATIO)
    free = (
        FreeParameter("mesh_phase", 0.0),
        FreeParameter(DAMPING, 2 * ratio * ((high + low) / 2 * 0.27) ** 0.5, logarithmic=True, lower=1e-3),
        FreeParameter(f"{MESH}.maximum", high, logarithmic=True),
        FreeParameter(f"{MESH}.minimum", low, logarithmic=True),
        FreeParameter(f"{MESH}.contact_ratio", given.get(f"{MESH}.contact_ratio", 1.6), 0.2, lower=1.02, upper=1.98),
    )
    known = {k: v for k, v in given.items() if k not in {p.name for p in free}}
    return Hypothesis(system, tuple(effects), known, free)


def _shape_harmonics(rough: Outcome, evidence: Evidence) -> int:
    """Harmonics of the mesh that the natural frequency lets through, at the slowest record."""
    model, given = rough.hypothesis.model, rough.flat_given()
    default = float(given.get("pinion_speed", model.parameters()["pinion_speed"].default))
    slowest = min(abs(record.conditions.get("pinion_speed", default)) for record in evidence.fit)
    teeth = float(given.get("n_teeth_pinion", model.parameters()["n_teeth_pinion"].default))
    mesh_frequency = max(teeth * slowest / (2 * pi), 1e-9)
    count = ceil(SHAPE_BAND * natural_frequency_hz(model, given) / mesh_frequency)
    return min(max(count, FEWEST_HARMONICS), MOST_HARMONICS)


def _with_shape(rough: Hypothesis, harmonics: int) -> Hypothesis:
    """Free harmonics take over from the contact ratio, which they contain."""
    names = [f"{SHAPE}.{part}[{h}]" for part in ("in_phase", "quadrature") for h in range(harmonics)]
    free = tuple(p for p in rough.free if p.name in (DAMPING, f"{MESH}.maximum"))
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
