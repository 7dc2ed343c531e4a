"""A linear oscillator from measured records: mass-normalised parameters with intervals."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, pi
from typing import Any

import numpy as np
import torch
from torch import Tensor

from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.first_guess import first_motion
from gear_damping.identification.output_error.holdout import Frozen, predict_holdout, rmse
from gear_damping.identification.output_error.least_squares import Fitted, Rounds, fit
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.identification.output_error.segments import WHOLE, Segments, covered, in_segments, joined
from gear_damping.identification.output_error.uncertainty import covariance, interval
from gear_damping.identification.time_scale import characteristic_time
from gear_damping.physics.effects.offset_force import OffsetForce
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.physics.systems.traits import Trait
from gear_damping.simulation.solver_settings import Solver

DAMPING, FORCE = "viscous_damping.damping_coefficient", "offset_force.force"
TIME = "characteristic_time"
LAWS = dict.fromkeys(("damping_coefficient", "damping_ratio"), DAMPING)  # words of a file for the viscous damping
FIRST_RATIOS = (0.01, 0.05, 0.2)  # damping ratios of the starts
MOTION, STROKE = 0.999, 0.5  # share of the energy that is the motion; of a record: less is a stroke
FIRST_SHIFTS = (0.93, 1.0, 1.07)  # of the frequency of the starts
FIRST_RATES = (0.1, 1.0, 10.0)  # damping coefficients of the starts without a spring, over one by characteristic time
HORIZON_PERIODS = (4, 20, 100)  # natural periods of the rounds before the whole record
FEWEST_SAMPLES = 20  # of a round of the fit: several for each of its unknowns
CORRELATED_PERIODS = 3.0  # characteristic times over which residuals may be correlated
SEGMENT_TIMES = 5.0  # characteristic times of a segment
NOTHING = Known({}, {})


@dataclass(frozen=True)
class Estimate:
    """A quantity with its 95 % interval."""

    value: float
    interval95: tuple[float, float]
    unit: str


@dataclass(frozen=True)
class OscillatorFit:
    """What was found.

    Args:
        parameters: Mass-normalised stiffness, damping coefficient and force gain (forced records only).
        damping_ratio_percent: In % of critical; None without a spring, as the next two.
        natural_frequency_hz: Undamped.
        log_decrement: Of successive peaks.
        predictions: By record name, the response channels one after another.
        residuals: The same of what is left.
        rmse: By role, `fit` and `holdout` (None without such records), in the unit of the first channel.
        converged: Whether the search converged.
        given: Every parameter of the fitted model by flat name.
        own: What single records have of their own, such as offsets, by name.
        problem: The fit's statement.
        fitted: The fit.
        scale: Characteristic time in s.
        segments: How the records were cut.
    """

    parameters: dict[str, Estimate]
    damping_ratio_percent: Estimate | None
    natural_frequency_hz: Estimate | None
    log_decrement: Estimate | None
    predictions: dict[str, Tensor]
    residuals: dict[str, Tensor]
    rmse: dict[str, float | None]
    converged: bool
    given: dict[str, float]
    own: dict[str, float]
    problem: OutputErrorProblem = field(repr=False)
    fitted: Fitted = field(repr=False)
    scale: float
    segments: Segments = WHOLE

    def weighed(self, fitted: Fitted) -> "OscillatorFit":
        """The same with the quantities and intervals of another solution of its problem."""
        return replace(self, **_quantities(estimates(self.problem, fitted, self.scale)))


def fit_oscillator(
    fit_records: Sequence[FitRecord],
    holdout_records: Sequence[FitRecord] = (),
    report: Callable[[int, int], None] | None = None,
    solver: Solver | None = None,
    known: Known = NOTHING,
    segments: Segments | None = None,
) -> OscillatorFit:
    """Stiffness, damping and gain per unit of mass; offsets of force and response are nuisances.

    Args:
        fit_records: Records of one rig, all with the same inputs or as free decays.
        holdout_records: Records to predict with the parameters frozen.
        report: Told (done, total) rounds.
        solver: Settings of the solver.
        known: What is stated of the rig: starts, expectations, and 0 for what is not there.
        segments: How the records are cut; where absent they are whole, or in segments where there is no spring.
    """
    free, given, scale = linear_model(fit_records, known)
    spring = any(parameter.name == known.system.spring for parameter in free)
    if segments is None:
        segments = WHOLE if spring else Segments(SEGMENT_TIMES * scale)
    segmented = in_segments(fit_records, segments)
    problem = OutputErrorProblem(linear_oscillator(fit_records, known.system), given, free, segmented, solver)
    fitted = _fitted(problem, spring, scale, report)
    samples = max(float((problem.response.weights > 0).sum()), 1.0)
    problem.noise = float(fitted.prediction.residual.square().sum() / samples) ** 0.5
    if any(isfinite(parameter.deviation) for parameter in problem.free):  # weighed by the noise that is left
        fitted = fit(problem, fitted.shared.unsqueeze(0), states=fitted.states.unsqueeze(0))
    values = {name: float(value) for name, value in problem.unknowns.parameters(fitted.shared).items()}
    found = estimates(problem, fitted, scale)
    given = problem.given | {p.name: values[p.name] for p in free}
    residuals = _fit_residuals(problem, fitted, fit_records, segments)
    own = {name: value for name, value in values.items() if name not in given}
    if holdout_records:
        held = predict_holdout(Frozen(problem.model, given, solver=solver), holdout_records, scale, segments)
        residuals |= {record.name: left for record, left in zip(holdout_records, held.residuals, strict=True)}
        own |= held.own
    records = [*covered(fit_records, segments), *covered(holdout_records, segments)]
    return OscillatorFit(
        **_quantities(found),
        predictions={record.name: record.stacked - residuals[record.name] for record in records},
        residuals=residuals,
        rmse={"fit": _rmse(fit_records, residuals), "holdout": _rmse(holdout_records, residuals)},
        converged=fitted.converged,
        given=given,
        own=own,
        problem=problem,
        fitted=fitted,
        scale=scale,
        segments=segments,
    )


def _quantities(found: Mapping[str, Estimate]) -> dict[str, Any]:
    """Estimates where an `OscillatorFit` has them."""
    named = ("damping_ratio_percent", "natural_frequency_hz", "log_decrement")
    parameters = {k: v for k, v in found.items() if k not in named}
    return {"parameters": parameters} | {name: found.get(name) for name in named}


def linear_oscillator(records: Sequence[FitRecord], system: type[System] = Oscillator) -> Model:
    """The linear system of these records; one that is driven has a constant force beside its input."""
    return Model(system(), [ViscousDamping(), *([OffsetForce()] if records[0].inputs else [])])


def linear_model(
    records: Sequence[FitRecord], known: Known = NOTHING
) -> tuple[list[FreeParameter], dict[str, float], float]:
    """Free parameters of the linear oscillator with their starts, its given values, and its characteristic time."""
    stated, amplitude, system, mass = known.values, _amplitude(records, known.system), known.system, mass_of(known)
    name, spring = system.spring, stated.get(system.spring, 1.0) > 0
    rate = ((stated[name] / mass) ** 0.5 if stated.get(name) else 2 * pi * first_frequency(records[0])) * spring
    scale = characteristic_time(records, rate, stated.get("damping_coefficient", 0.0) / mass)
    given = _stated(known) | {"amplitude": amplitude} | ({} if spring else {name: 0.0, TIME: scale})
    free = [FreeParameter(name, rate**2 * mass, logarithmic=True)] if spring else []
    damping = 2 * FIRST_RATIOS[0] * rate * mass if spring else 1 / scale * mass
    if "damping_ratio" in stated and spring:
        damping = 2 * stated["damping_ratio"] * rate * mass
    damping = stated.get("damping_coefficient", damping)
    if damping > 0:
        free.append(FreeParameter(DAMPING, damping, logarithmic=True, lower=1e-9 * (rate or 1 / scale) * mass))
    else:
        given[DAMPING] = 0.0
    for drive, of_drive in system.gains.items():
        if drive in records[0].inputs:
            force = torch.cat([record.inputs[drive] for record in records])
            per_amplitude = rate**2 * 2 * FIRST_RATIOS[1] if spring else 1 / scale**2
            size = per_amplitude * amplitude * mass / float(force.std().clamp(min=1e-300))
            gain = stated.get(of_drive, size)
            free.append(FreeParameter(of_drive, gain, scale=abs(gain) or size))
    if records[0].inputs:
        free.append(FreeParameter(FORCE, 0.0, scale=(rate**2 if spring else 1 / scale**2) * amplitude * mass))
    free += [FreeParameter(one, stated[one], abs(stated[one]), logarithmic=stated[one] > 0) for one in _unsure(known)]
    expected = {LAWS.get(one, one): relative for one, relative in known.uncertainty.items() if stated[one]}
    return [expected_about(p, expected.get(p.name)) for p in free], given, scale


def mass_of(known: Known) -> float:
    """What moves, from what is stated of a rig; 1 of one that is described per unit of mass."""
    base = Model(known.system(), ())
    return float(base.prepare(base.values(1, **_stated(known))).derived["equivalent_mass"][0])


def _stated(known: Known) -> dict[str, float]:
    """Stated parameters of the system that are no part of the linear fit."""
    fitted = {known.system.spring, *known.system.gains.values()}
    own = {parameter.name for parameter in known.system.parameters} - fitted
    return {name: value for name, value in known.values.items() if name in own}


def _unsure(known: Known) -> list[str]:
    """Those that are stated with an uncertainty."""
    return [name for name in _stated(known) if name in known.uncertainty and known.values[name]]


def expected_about(parameter: FreeParameter, relative: float | None) -> FreeParameter:
    """The parameter with the expectation that it lies about its start, within a relative uncertainty."""
    if not relative:
        return parameter
    deviation = relative if parameter.logarithmic else relative * abs(parameter.start)
    return replace(parameter, deviation=deviation, expected=parameter.start)


def _amplitude(records: Sequence[FitRecord], system: type[System]) -> float:
    """Typical displacement, from whatever was recorded."""
    scales = [first_motion(record, 0.0, 0.0, Model(system(), ()), {})[1][0] for record in records]
    return float(torch.stack(scales).square().mean().sqrt())


def first_frequency(record: FitRecord, driven: bool = True) -> float:
    """A first guess of the natural frequency in Hz: the highest peak of the response per unit of force.

    Args:
        record: The record.
        driven: Whether the response is divided by the force, where there is one.
    """
    place, window = _motion(record)
    response = record.response.numpy()[place]
    response = response - float(record.response.mean())
    spectrum = np.abs(np.fft.rfft(response * window)) ** 2
    frequency = np.fft.rfftfreq(len(response), 1 / record.sampling_rate)
    width = max(1, len(spectrum) // 400)
    smooth = np.convolve(spectrum, np.ones(width) / width, mode="same")
    drives = [record.inputs[n][place] for n in ("force", "base_acceleration") if driven and n in record.inputs]
    drives = [drive for drive in drives if float(drive.max()) > float(drive.min())]  # a constant one drives nothing
    if drives:
        force = drives[0].numpy()
        drive = np.convolve(np.abs(np.fft.rfft((force - force.mean()) * window)) ** 2, np.ones(width) / width, "same")
        smooth = np.where(drive > 1e-3 * drive.max(), smooth / np.maximum(drive, 1e-300), 0)
    first = max(1, width // 2)
    return float(frequency[first + int(np.argmax(smooth[first:]))])


def _motion(record: FitRecord) -> tuple[slice, np.ndarray]:
    """The samples that hold the motion, and a window for their spectrum.

    A stroke that has long rung out fills a small part of its record, where a window over all of it has hardly risen.
    """
    energy = np.cumsum((record.response.numpy() - float(record.response.mean())) ** 2)
    first, last = np.searchsorted(energy, np.array([1 - MOTION, MOTION]) * energy[-1])
    if last - first >= STROKE * len(energy) or last - first < FEWEST_SAMPLES:
        return slice(0, len(energy)), np.hanning(len(energy))
    first = max(0, int(first) - (int(last) - int(first)) // 10)  # the stroke comes before what it moves
    tail = np.hanning(2 * ((last - first) // 4))
    return slice(first, int(last)), np.concatenate([np.ones(last - first - len(tail) // 2), tail[len(tail) // 2 :]])


def _fitted(
    problem: OutputErrorProblem, spring: bool, scale: float, report: Callable[[int, int], None] | None
) -> Fitted:
    """The best fit from several starts, over growing stretches of the records.

    Beside the peak per unit of force the response has one of its own. Where the force is short, as a stroke, that may
    be the better guess; and a stretch that ends in the stroke leads astray, so that it is tried over all at once.
    """
    found = fit(problem, _starts(problem, spring), Rounds(horizons=_horizons(problem, scale), report=report))
    rate = _first_rate(problem)
    own = 2 * pi * first_frequency(problem.records[0], driven=False) / rate if rate > 0 else 0.0
    is_new = not min(FIRST_SHIFTS) <= own <= max(FIRST_SHIFTS) or _is_stroke(problem.records[0])
    if not spring or own <= 0 or not is_new:
        return found
    other = fit(problem, _starts(problem, spring, (own,)))
    return min(found, other, key=lambda one: one.cost)


def _first_rate(problem: OutputErrorProblem) -> float:
    """The natural frequency in rad/s that the fit starts from; 0 without a spring."""
    stiffness = next((p.start for p in problem.free if p.name == problem.model.system.spring), 0.0)
    return (stiffness / _mass(problem)) ** 0.5 if stiffness > 0 else 0.0


def _mass(problem: OutputErrorProblem) -> float:
    """What moves, from the given values of a fit."""
    model = problem.model
    return float(model.prepare(model.values(1, **problem.given)).derived["equivalent_mass"][0])


def _is_stroke(record: FitRecord) -> bool:
    """Whether the motion fills a small part of a record."""
    place, _ = _motion(record)
    return place.stop - place.start < STROKE * len(record.response)


def _starts(problem: OutputErrorProblem, spring: bool, shifts: Sequence[float] = ()) -> Tensor:
    """Coordinates of the starts: every frequency with every damping ratio, or every time constant."""
    place = {parameter.name: i for i, parameter in enumerate(problem.free)}
    rows = []
    for shift in (shifts or FIRST_SHIFTS) if spring else (1.0,):
        for ratio in FIRST_RATIOS if spring else FIRST_RATES:
            row = torch.zeros(problem.n_shared, dtype=torch.float64)
            if spring:
                row[place[problem.model.system.spring]] = 2 * float(np.log(shift))
            if DAMPING in place:
                row[place[DAMPING]] = float(np.log(ratio / (FIRST_RATIOS[0] if spring else 1.0)))
            rows.append(row)
    return torch.stack(rows)


def _horizons(problem: OutputErrorProblem, scale: float) -> list[float | None]:
    rate, total = (f(record.sampling_rate for record in problem.records) for f in (min, max))
    whole = problem.response.length / total
    return [p * scale for p in HORIZON_PERIODS if FEWEST_SAMPLES / rate <= p * scale < whole] + [None]


def estimates(problem: OutputErrorProblem, fitted: Fitted, scale: float) -> dict[str, Estimate]:
    """What a solution says, with 95 % intervals: parameters, damping ratio, frequency, decrement."""
    covariances = covariance(problem, fitted, CORRELATED_PERIODS * scale)
    place = {parameter.name: i for i, parameter in enumerate(problem.free)}
    system, mass = problem.model.system, _mass(problem)
    stiffness, gain = system.spring, next(iter(system.gains.values()), "")

    def value(name: str, shared: Tensor) -> Tensor:
        if name not in place:
            return shared.new_tensor(problem.given[name])
        return problem.free[place[name]].value(shared[place[name]])

    def ratio(shared: Tensor) -> Tensor:
        return value(DAMPING, shared) / (2 * (value(stiffness, shared) * mass).sqrt())

    units = ("N*s/m", "N/m") if system.has(Trait.MASS) else ("1/s", "1/s^2")
    quantities = {"damping_coefficient": (lambda s: value(DAMPING, s), units[0])} if DAMPING in place else {}
    if stiffness in place:
        quantities[stiffness] = (lambda s: value(stiffness, s), units[1])
        quantities["natural_frequency_hz"] = (lambda s: (value(stiffness, s) / mass).sqrt() / (2 * pi), "Hz")
    if stiffness in place and DAMPING in place:
        quantities["damping_ratio_percent"] = (lambda s: 100 * ratio(s), "%")
        quantities["log_decrement"] = (lambda s: 2 * pi * ratio(s) / (1 - ratio(s) ** 2).sqrt(), "1")
    if gain in place:
        quantities[gain] = (lambda s: value(gain, s), "response unit / force unit / s^2")
    found = {
        name: (interval(function, fitted.shared, covariances), unit) for name, (function, unit) in quantities.items()
    }
    return {name: Estimate(number, bounds, unit) for name, ((number, bounds), unit) in found.items()}


def _fit_residuals(
    problem: OutputErrorProblem, fitted: Fitted, records: Sequence[FitRecord], segments: Segments
) -> dict[str, Tensor]:
    left = fitted.prediction.residual[0] / problem.response.weights.clamp(min=1e-300)
    whole = joined(left, covered(records, segments), segments, len(problem.response.channels))
    return {record.name: found for record, found in zip(records, whole, strict=True)}


def _rmse(records: Sequence[FitRecord], residuals: Mapping[str, Tensor]) -> float | None:
    if not records:
        return None
    return rmse([residuals[r.name] for r in records], [torch.zeros_like(residuals[r.name]) for r in records])
