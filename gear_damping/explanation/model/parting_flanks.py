"""A gear pair whose flanks may part, fitted from what is stated of it.

Where flanks part in most records, a model in which they cannot bends its stiffness, its damping and the angles of the
mesh to what the impacts do, and from there no fit finds back to a gap. What is stated of the rig is the better start.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import inf, pi

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs, savgol_filter
from torch import Tensor

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.model.fitting import InitialValues, error_amplification_over, fit_hypothesis
from gear_damping.explanation.model.hypothesis import Hypothesis, Outcome, segments_of, settled_at
from gear_damping.explanation.model.nominal_gear_pair import (
    ANGLES_KEPT,
    ROUGH_ITERATIONS,
    angles_of,
    first_gear_pair,
    phase_starts,
    with_shape,
)
from gear_damping.explanation.model.rig import rig_of
from gear_damping.identification.output_error.first_guess import participation
from gear_damping.identification.output_error.least_squares import NONE, Rounds
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.physics.effects.backlash import GAPS, Backlash
from gear_damping.physics.systems.traits import Trait
from gear_damping.simulation.solver_settings import Solver

GAP = f"{Backlash.name}.gap"
STARTS = tuple(share / GAPS[-1] for share in GAPS)  # of the largest usual gap
RESPONSE, TORQUE = "transmission_error", "pinion_torque"
CLEAR, PARTED = 3.0, 0.01  # noises; share of samples: noise alone, wherever it lies, reaches it in one of 700
LIGHT = 0.2  # of the load: what the mesh carries where flanks part, beside a wrong inertia or torque
CROSSED = 4.0  # static deflections: twice what flanks move by that just do not part
FAR_OUT = 6.0  # deviations of the noise of three samples, 1.2 times that of one: a million samples hold none beyond
LONG = 0.05  # of a record: a wave of the force that just touches zero stays below a fifth for four times as long
PARABOLA, SHORTEST = 2, 3  # degree, and least samples of the window in which the motion is one
SHOWN = 0.9  # of an acceleration at the natural frequency, by a window that is not too wide
LOOKS = 2  # at the angles of the mesh, each followed by a fit: with the damping that is stated, and with what was found
FAR = 4.0  # times the cost in segments: whole records have fewer initial states to bend, and no more is their doing
WIDER, NEARLY = 2.0, 1.1  # times the gap, and the cost: of one that is crossed a wider one leaves many times as much
ITERATIONS = 30  # over whole records, and with a free shape of the stiffness


def flanks_part(evidence: Evidence) -> bool:
    """Whether flanks part: their error crosses its zero, or the mesh carries next to nothing for long."""
    return evidence.has(Trait.TEETH) and (_crosses_zero(evidence) or _is_unloaded(evidence))


def flanks_change(evidence: Evidence) -> bool:
    """Whether flanks part, or an error whose zero nobody knows goes farther than over closed ones."""
    return flanks_part(evidence) or (evidence.has(Trait.TEETH) and any(are_crossed(evidence)))


def _crosses_zero(evidence: Evidence) -> bool:
    """Whether a transmission error that was measured from its zero on shows flanks that part, well beyond the noise.

    Where the torque drives the other flank, the error of closed flanks is negative; without one nobody knows which.
    """
    seen = [record for record in evidence.fit if record.observed.name == RESPONSE and not record.observed.offset]
    closed = [record.response * _driven_flank(record) for record in seen]
    parted = sum(int((error < -CLEAR * evidence.noise).sum()) for error in closed)
    return parted > PARTED * sum(len(error) for error in closed)


def _is_unloaded(evidence: Evidence) -> bool:
    """Whether the force in the mesh stays near zero in a record: flanks push and do not pull."""
    return any(float(np.mean(carried < LIGHT)) > LONG for carried in _carried(evidence) if carried is not None)


def are_crossed(evidence: Evidence) -> list[bool]:
    """By fitted record, whether its error moves farther at once than the load presses the flanks together.

    At once is within half a natural period, from the middle of where it was half a period before and is half a period
    later, which runouts hardly change. A wave of closed flanks moves by two static deflections so, where it just does
    not part them; over a gap the teeth go by many.
    """
    rig = first_gear_pair(evidence)
    values = rig_of(rig, evidence).values
    return [_is_crossed(record, values, evidence.noise) for record in evidence.fit]


def _is_crossed(record: FitRecord, values: Mapping[str, float], noise: float) -> bool:
    half = round(record.sampling_rate * pi / values["natural_frequency"])
    if record.observed.name != RESPONSE or record.observed.derivatives or half < 1 or len(record.response) <= 2 * half:
        return False
    load = values["load_per_pinion_torque"] * float(_stated(record, TORQUE).abs().mean())
    error = record.response
    moved = (error[half:-half] - (error[: -2 * half] + error[2 * half :]) / 2).abs().max()
    return bool(load > 0 and moved > CROSSED * load / values["mean_stiffness"] + FAR_OUT * noise / record.weight)


def stay_closed(evidence: Evidence) -> bool:
    """Whether the mesh carries a part of the load all the time, in every record: then no gap has ever opened."""
    return evidence.has(Trait.TEETH) and all(
        carried is not None and float(carried.min()) > LIGHT for carried in _carried(evidence)
    )


def _carried(evidence: Evidence) -> Iterator[NDArray | None]:
    """By record, the force in the mesh over the load; None where the noise does not let it be seen.

    It is the load less the inertia of the relative motion, F - m_e x'' (d'Alembert), whatever the stiffness, the errors
    of the teeth or the zero of the sensor are. The motion is differentiated by the narrowest window through which noise
    is small beside the load.
    """
    rig = first_gear_pair(evidence)
    values = rig_of(rig, evidence).values
    for record in evidence.fit:
        load = (values["load_per_pinion_torque"] * _stated(record, TORQUE)).numpy()
        curved = _curved(record, LIGHT * float(np.abs(load).mean()), rig, values, evidence.noise)
        if curved is None:
            yield None
        else:  # where there is no load nothing is said
            yield np.divide(load - curved, load, out=np.ones_like(load), where=load != 0)


def _curved(
    record: FitRecord, near: float, rig: Hypothesis, values: Mapping[str, float], noise: float
) -> NDArray | None:
    """The inertia of the relative motion in N, known to within `near`; None where noise hides it."""
    rate, order = record.sampling_rate, 2 - record.observed.derivatives
    inertia = values["equivalent_mass"] / participation(record.observed, rig.model, rig.given) * rate**order
    for width in range(SHORTEST, len(record.response), 2):
        weights = savgol_coeffs(width, PARABOLA, deriv=order)
        if _shown(weights, values["natural_frequency"] / rate, order) < SHOWN:
            return None
        if CLEAR * noise * abs(inertia) * float(np.linalg.norm(weights)) <= near:
            curved = savgol_filter(record.response.numpy(), width, PARABOLA, deriv=order)
            return inertia * (curved - curved.mean())
    return None


def _shown(weights: NDArray, angle: float, order: int) -> float:
    """What a window shows of the derivative of a wave, as a share of it, samples lying `angle` rad of it apart."""
    place = np.arange(len(weights)) - len(weights) // 2
    return abs(np.exp(1j * angle * place) @ weights) / angle**order


def _driven_flank(record: FitRecord) -> Tensor:
    """1 where the torque closes the driven flanks, -1 where it closes the others, 0 without one, of every sample."""
    return _stated(record, TORQUE).sign()


def _stated(record: FitRecord, name: str) -> Tensor:
    """A torque as it was measured or is stated, of every sample; 0 where it is neither."""
    if name in record.inputs:
        return record.at_samples(name)
    return torch.full_like(record.response, record.conditions.get(name, 0.0))


def with_parting_flanks(evidence: Evidence, harmonics: int, solver: Solver | None) -> Outcome | None:
    """The fit with a gap; None where a gap is stated, and so is in the nominal model already.

    Args:
        evidence: The records.
        harmonics: Of the free shape of the stiffness.
        solver: Settings of the solver.
    """
    first = first_gear_pair(evidence)
    if first.model.flanks_may_part:
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
    return _out_of_reach(found, evidence, solver) if found.is_finite else None


def _out_of_reach(found: Outcome, evidence: Evidence, solver: Solver | None) -> Outcome:
    """The fit, or one with a gap that no motion crosses, where that leaves no more.

    A gap just as wide as the widest motion is a place from which no fit goes on: a wider one changes nothing.
    """
    wider = settled_at(found.hypothesis, {GAP: WIDER * float(found.values[GAP])})
    if found.error_amplification > evidence.settings.most_growth:
        evidence = _in_short(found.hypothesis, evidence)
    initial = InitialValues(after=found, is_near=True)
    there = fit_hypothesis(wider, evidence, initial, NONE, solver=solver)
    if not there.is_finite or there.fitted.cost > NEARLY * found.fitted.cost:
        return found
    again = fit_hypothesis(wider, evidence, initial, Rounds(ITERATIONS), solver=solver)
    is_better = again.is_finite and again.fitted.cost <= found.fitted.cost
    return replace(again, error_amplification=found.error_amplification) if is_better else found


def _shaped(rough: Outcome, evidence: Evidence, harmonics: int, solver: Solver | None) -> Outcome:
    """With a free shape of the stiffness, over whole records where these can be predicted from their start.

    Near a resonance a motion whose flanks part goes on as it began, large or small: whole records are fitted from the
    shape and the initial states that their segments tell.
    """
    short, rounds, own = _in_short(rough.hypothesis, evidence), Rounds(ITERATIONS), rough.of_records
    found = fit_hypothesis(with_shape(rough, evidence, harmonics), short, InitialValues(own=own), rounds, solver=solver)
    growth = error_amplification_over(found.hypothesis, evidence.fit, solver)
    if found.is_finite and growth <= evidence.settings.most_growth:
        initial = InitialValues(after=found, is_near=True)
        whole = fit_hypothesis(found.hypothesis, evidence, initial, rounds, solver=solver)
        if whole.is_finite and whole.fitted.cost <= FAR * found.fitted.cost:
            return whole
        growth = inf  # a fit of segments is none of whole records, however slowly errors grow
    return replace(found, error_amplification=growth)


def are_missed(found: Outcome, nominal: Outcome, evidence: Evidence, solver: Solver | None) -> bool:
    """Whether a fit with a gap takes most of what a model without one leaves of the same segments.

    Over segments, each with a start of its own, any model leaves less than over whole records.
    """
    short = _in_short(found.hypothesis, evidence)
    initial = InitialValues(own=nominal.of_records)
    without = fit_hypothesis(nominal.hypothesis, short, initial, Rounds(ROUGH_ITERATIONS), solver=solver)
    return found.fitted.cost <= evidence.settings.lost_share * without.fitted.cost


def _in_short(hypothesis: Hypothesis, evidence: Evidence) -> Evidence:
    """The evidence in segments: over more than these no motion of flanks that part is foretold from afar.

    Where it is cut already it stays as it is: models are held against each other sample by sample.
    """
    return evidence if evidence.segments else replace(evidence, segments=segments_of(hypothesis, evidence))


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
