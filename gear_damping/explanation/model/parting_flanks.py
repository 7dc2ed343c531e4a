"""A gear pair whose flanks may part, fitted from what is stated of it.

Where flanks part in most records, a model in which they cannot bends its stiffness, its damping and the angles of the
mesh to what the impacts do, and from there no fit finds back to a gap. What is stated of the rig is the better start.
"""

from dataclasses import replace

import torch
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.fitting import InitialValues, error_amplification_over, fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis, Outcome, segments_of
from gear_damping.explanation.model.nominal_gear_pair import (
    ANGLES_KEPT,
    ROUGH_ITERATIONS,
    angles_of,
    first_gear_pair,
    phase_starts,
    with_shape,
)
from gear_damping.identification.output_error.least_squares import Rounds
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.physics.effects.backlash import GAPS, Backlash
from gear_damping.physics.terms import Contact
from gear_damping.simulation.solver_settings import Solver

GAP = f"{Backlash.name}.gap"
STARTS = tuple(share / GAPS[-1] for share in GAPS)  # of the largest usual gap
RESPONSE, TORQUE = "transmission_error", "pinion_torque"
CLEAR, PARTED = 3.0, 0.01  # noises; share of samples: noise alone, wherever it lies, reaches it in one of 700
LOOKS = 2  # at the angles of the mesh, each followed by a fit: with the damping that is stated, and with what was found
ITERATIONS = 30  # over whole records, and with a free shape of the stiffness


def flanks_part(evidence: Evidence) -> bool:
    """Whether a transmission error that was measured from its zero on shows flanks that part, well beyond the noise.

    Where the torque drives the other flank, the error of closed flanks is negative; without one nobody knows which.
    """
    seen = [record for record in evidence.fit if record.observed.name == RESPONSE and not record.observed.offset]
    closed = [record.response * _driven_flank(record) for record in seen]
    parted = sum(int((error < -CLEAR * evidence.noise).sum()) for error in closed)
    return parted > PARTED * sum(len(error) for error in closed)


def _driven_flank(record: FitRecord) -> Tensor:
    """1 where the torque closes the driven flanks, -1 where it closes the others, 0 without one, of every sample."""
    stated = torch.full_like(record.response, record.conditions.get(TORQUE, 0.0))
    return record.inputs.get(TORQUE, stated).sign()


def with_parting_flanks(evidence: Evidence, harmonics: int, solver: Solver | None) -> Outcome | None:
    """The fit with a gap; None where a gap is stated, and so is in the nominal model already.

    Args:
        evidence: The records.
        harmonics: Of the free shape of the stiffness.
        solver: Settings of the solver.
    """
    first = first_gear_pair(evidence)
    if any(isinstance(effect, Contact) for effect in first.effects):
        return None
    module = first.given.get("module") or next(p.default for p in first.system.parameters if p.name == "module")
    gap = GAPS[-1] * float(module)
    hypothesis = first.with_effect([Backlash()], {GAP: gap}, [_gap(gap)], Backlash.name)
    tried = []
    for _ in range(LOOKS):
        tried.append(_rough(hypothesis, evidence, solver))
        hypothesis = tried[-1].hypothesis
        if evidence.has_index:  # the angle is fitted all around at once
            break
    rough = min((fit for fit in tried if fit.is_finite), key=lambda fit: fit.fitted.cost, default=None)
    if rough is None:
        return None
    found = _shaped(rough, evidence, harmonics, solver)
    return found if found.is_finite else None


def _shaped(rough: Outcome, evidence: Evidence, harmonics: int, solver: Solver | None) -> Outcome:
    """With a free shape of the stiffness, over whole records where these can be predicted from their start."""
    own, rounds = rough.of_records, Rounds(ITERATIONS)
    whole = fit_hypothesis(rough.hypothesis, evidence, InitialValues(own=own, is_near=True), rounds, solver=solver)
    if whole.is_finite and whole.error_amplification <= evidence.settings.most_growth:
        initial = InitialValues(after=whole, is_near=True)
        return fit_hypothesis(with_shape(whole, evidence, harmonics), evidence, initial, rounds, solver=solver)
    short = _in_short(rough.hypothesis, evidence)
    found = fit_hypothesis(with_shape(rough, evidence, harmonics), short, InitialValues(own=own), rounds, solver=solver)
    growth = error_amplification_over(found.hypothesis, evidence.fit, solver)
    return replace(found, error_amplification=growth)


def _in_short(hypothesis: Hypothesis, evidence: Evidence) -> Evidence:
    """The evidence in segments: over more than these no motion of flanks that part is foretold from afar."""
    return replace(evidence, segments=segments_of(hypothesis, evidence))


def _gap(gap: float) -> FreeParameter:
    limits = next(p for p in Backlash.parameters if p.name == "gap")
    return FreeParameter(GAP, gap, logarithmic=True, lower=max(limits.lower, 1e-3 * gap), upper=limits.upper)


def _rough(hypothesis: Hypothesis, evidence: Evidence, solver: Solver | None) -> Outcome:
    """With the ideal wave of the stiffness, from the best angles of the mesh."""
    rounds = Rounds(ROUGH_ITERATIONS)
    if evidence.has_index:
        starts = phase_starts(hypothesis)
        few = replace(rounds, kept=ANGLES_KEPT)
        return fit_hypothesis(hypothesis, _in_short(hypothesis, evidence), InitialValues(starts), few, solver=solver)
    short = _in_short(hypothesis, evidence)
    own = angles_of(hypothesis, short, evidence.duration, solver)
    starts = torch.zeros(len(STARTS), len(hypothesis.common), dtype=torch.float64)
    place = next(i for i, parameter in enumerate(hypothesis.common) if parameter.name == GAP)
    starts[:, place] = torch.tensor(STARTS, dtype=torch.float64).log()
    return fit_hypothesis(hypothesis, short, InitialValues(starts, own=own), rounds, solver=solver)
