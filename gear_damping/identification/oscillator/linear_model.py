"""The linear oscillator that records are fitted with: its free parameters, their starts, and what is stated of them."""

from collections.abc import Sequence
from dataclasses import replace
from math import pi

import numpy as np
import torch
from torch import Tensor

from gear_damping.identification.observation import Known
from gear_damping.identification.oscillator.first_frequency import first_frequency
from gear_damping.identification.output_error.first_guess import first_motion
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.identification.time_scale import characteristic_time
from gear_damping.physics.effects.offset_force import OffsetForce
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.parameter import Parameter

DAMPING, FORCE = "viscous_damping.damping_coefficient", "offset_force.force"
TIME = "characteristic_time"
LAWS = dict.fromkeys(("damping_coefficient", "damping_ratio"), DAMPING)  # words of a file for the viscous damping
STRETCHES, GAINED = 20, 0.1  # of a record, whose mean speeds are compared; of the highest, what noise does not make
FIRST_RATIOS = (0.01, 0.05, 0.2)  # damping ratios of the starts
STAYS = 1e-9  # of the size of an input: less movement is rounding
NOTHING = Known({}, {})


def linear_oscillator(records: Sequence[FitRecord], known: Known = NOTHING) -> Model:
    """The linear system of these records; what is driven or pushed has a constant force."""
    return Model(known.system(), [ViscousDamping(), *([OffsetForce()] if _is_pushed(records, known) else [])])


def _is_pushed(records: Sequence[FitRecord], known: Known) -> bool:
    """Whether a constant force is fitted: beside a measured input, or where a rig without a spring gains speed alone.

    What coasts loses speed from its first sample on; a motor behind a step of its voltage does not.
    """
    spring = known.values.get(known.system.spring, 1.0) > 0
    return bool(records[0].inputs) or (not spring and any(_gains_speed(record) for record in records))


def _gains_speed(record: FitRecord) -> bool:
    speeds = np.abs(_speeds(record))
    return bool(len(speeds)) and bool(speeds.max() - speeds[0] > GAINED * speeds.max())


def moves_one_way(record: FitRecord) -> bool:
    """Whether the mean speeds of all stretches of a record have one sign; not where its speed is not known."""
    speeds = _speeds(record)
    return bool(len(speeds)) and bool((speeds > 0).all() or (speeds < 0).all())


def _speeds(record: FitRecord) -> np.ndarray:
    """Mean speed of each stretch of a record; none where its speed is not known."""
    if record.observed.derivatives > 1 or (record.observed.derivatives == 1 and record.observed.offset):
        return np.empty(0)
    values = record.response.numpy()
    rate = np.gradient(values) if record.observed.derivatives == 0 else values
    return np.array([stretch.mean() for stretch in np.array_split(rate, min(STRETCHES, len(rate)))])


def linear_model(
    records: Sequence[FitRecord], known: Known = NOTHING
) -> tuple[list[FreeParameter], dict[str, float], float]:
    """Free parameters of the linear oscillator with their starts, its given values, and its characteristic time."""
    stated, amplitude, system, mass = known.values, _amplitude(records), known.system, mass_of(known)
    name, spring = system.spring, stated.get(system.spring, 1.0) > 0
    rate = ((stated[name] / mass) ** 0.5 if stated.get(name) else 2 * pi * first_frequency(records[0])) * spring
    scale = characteristic_time(records, rate, stated.get("damping_coefficient", 0.0) / mass)
    given = _stated(known) | {"amplitude": amplitude} | ({} if spring else {name: 0.0, TIME: scale})
    free = [FreeParameter(name, rate**2 * mass, logarithmic=True)] if spring else []
    damping = 2 * FIRST_RATIOS[0] * rate * mass if spring else 1 / scale * mass
    if stated.get("damping_ratio") and spring:
        damping = 2 * stated["damping_ratio"] * rate * mass
    damping = stated.get("damping_coefficient") or damping
    free.append(FreeParameter(DAMPING, damping, logarithmic=True, lower=1e-9 * (rate or 1 / scale) * mass))
    for drive, of_drive in system.gains.items():
        if drive in records[0].inputs:
            moved = _moved(torch.cat([record.inputs[drive] for record in records]))
            if not moved:
                given[of_drive] = stated.get(of_drive, 1.0)
                continue
            per_amplitude = rate**2 * 2 * FIRST_RATIOS[1] if spring else 1 / scale**2
            size = per_amplitude * amplitude * mass / moved
            gain = stated.get(of_drive, size)
            free.append(FreeParameter(of_drive, gain, scale=abs(gain) or size))
    if _is_pushed(records, known):
        free.append(FreeParameter(FORCE, 0.0, scale=(rate**2 if spring else 1 / scale**2) * amplitude * mass))
    expected = {LAWS.get(one, one): relative for one, relative in known.uncertainty.items() if stated[one]}
    free = [expected_about(p, expected.get(p.name)) for p in free]
    declared = {parameter.name: parameter for parameter in system.parameters}
    unsure = [uncertain_parameter(declared[one], stated[one], known.uncertainty[one]) for one in _unsure(known)]
    return [*free, *unsure], given, scale


def _moved(force: Tensor) -> float:
    """How far an input moves, or how large it is where it stays; 0 where it is nothing."""
    spread, size = float(force.std()), float(force.square().mean().sqrt())
    return spread if spread > STAYS * size else size


def mass_of(known: Known) -> float:
    """What moves, from what is stated of a rig; 1 of one that is described per unit of mass."""
    base = Model(known.system(), ())
    return float(base.prepare(base.values(1, **_stated(known))).derived["equivalent_mass"][0])


def fitted_mass(problem: OutputErrorProblem) -> float:
    """What moves, from the given values of a fit."""
    model = problem.model
    return float(model.prepare(model.values(1, **problem.given)).derived["equivalent_mass"][0])


def _stated(known: Known) -> dict[str, float]:
    """Stated parameters of the system that are no part of the linear fit."""
    fitted = {known.system.spring, *known.system.gains.values()}
    own = {parameter.name for parameter in known.system.parameters} - fitted
    return {name: value for name, value in known.values.items() if name in own}


def _unsure(known: Known) -> list[str]:
    """Those that are stated with an uncertainty."""
    return [name for name in _stated(known) if name in known.uncertainty and known.values[name]]


def uncertain_parameter(declared: Parameter, value: float, relative: float) -> FreeParameter:
    """What is stated with an uncertainty, free about that; what may have either sign can change it.

    Args:
        declared: The parameter as its system or effect declares it.
        value: As it is stated.
        relative: Its standard deviation over the value.
    """
    grows = value > 0 and declared.lower >= 0
    scale = abs(value) * (1.0 if grows else max(1.0, relative))
    return expected_about(FreeParameter(declared.name, value, scale, logarithmic=grows), relative)


def expected_about(parameter: FreeParameter, relative: float | None) -> FreeParameter:
    """The parameter with the expectation that it lies about its start, within a relative uncertainty."""
    if not relative:
        return parameter
    deviation = relative if parameter.logarithmic else relative * abs(parameter.start)
    return replace(parameter, deviation=deviation, expected=parameter.start)


def _amplitude(records: Sequence[FitRecord]) -> float:
    """Typical displacement, from whatever was recorded."""
    scales = [first_motion(record, 0.0, 0.0)[1][0] for record in records]
    return float(torch.stack(scales).square().mean().sqrt())
