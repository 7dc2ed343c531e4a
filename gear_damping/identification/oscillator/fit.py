"""The fit of a linear oscillator to measured records: mass-normalised parameters with intervals."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, log, pi
from typing import Any

import numpy as np
import torch
from torch import Tensor

from gear_damping.identification.observation import Known
from gear_damping.identification.oscillator.estimates import Estimate, estimates
from gear_damping.identification.oscillator.first_frequency import FEWEST_SAMPLES, first_frequency, is_stroke
from gear_damping.identification.oscillator.linear_model import (
    DAMPING,
    FIRST_RATIOS,
    NOTHING,
    fitted_mass,
    linear_model,
    linear_oscillator,
)
from gear_damping.identification.output_error.holdout import Frozen, predict_holdout, rmse
from gear_damping.identification.output_error.least_squares import Fitted, Rounds, fit
from gear_damping.identification.output_error.problem import OutputErrorProblem
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import WHOLE, Segments, covered, in_segments, joined
from gear_damping.simulation.solver_settings import Solver

FIRST_SHIFTS = (0.93, 1.0, 1.07)  # of the frequency of the starts
FIRST_RATES = (0.1, 1.0, 10.0)  # damping coefficients of the starts without a spring, over one by characteristic time
HORIZON_PERIODS = (4, 20, 100)  # natural periods of the rounds before the whole record
SEGMENT_TIMES = 5.0  # characteristic times of a segment
FEWEST_SEGMENTS = 2  # of a record that is cut
UNDYING = 0.01  # of a motion, that it loses within the longest record: then a damping may have run to none on the way
LOSES = (0.1, 1.0)  # times that a motion then dies by a factor of e within that record, of two more starts
LOST = 0.5  # of a record's motion: a frequency that changes with the amplitude has run out of step by then


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
        rmse: Of the first channel, in its unit, by role: `fit` and `holdout` (None without such records).
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

    def first_residual(self, record: FitRecord) -> Tensor:
        """What is left of the first channel of a record, (time,), in its unit; others are weighed beside it."""
        return _first(record, self.residuals)

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
        segments: How the records are cut; where absent they are whole, or in segments where there is no spring, or
            where the nearest linear oscillator loses step with one of them.
    """
    free, given, scale = linear_model(fit_records, known)
    spring = any(parameter.name == known.system.spring for parameter in free)
    short = Segments(SEGMENT_TIMES * scale)
    may_cut = segments is None and spring and max(r.duration for r in fit_records) > FEWEST_SEGMENTS * short.seconds
    if segments is None:
        segments = WHOLE if spring else short
    segmented = in_segments(fit_records, segments)
    problem = OutputErrorProblem(linear_oscillator(fit_records, known), given, free, segmented, solver)
    fitted = _fitted(problem, spring, scale, report)
    samples = max(float((problem.response.weights > 0).sum()), 1.0)
    problem.noise = float(fitted.prediction.residual.square().sum() / samples) ** 0.5
    if any(isfinite(parameter.deviation) for parameter in problem.free):  # weighed by the noise that is left
        fitted = fit(problem, fitted.shared.unsqueeze(0), states=fitted.states.unsqueeze(0))
    values = {name: float(value) for name, value in problem.unknowns.parameters(fitted.shared).items()}
    found = estimates(problem, fitted, scale)
    given = problem.given | {p.name: values[p.name] for p in free}
    residuals = _fit_residuals(problem, fitted, fit_records, segments)
    if may_cut and any(_is_lost(residuals[record.name], record) for record in fit_records):
        return fit_oscillator(fit_records, holdout_records, report, solver, known, short)
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


def _is_lost(residual: Tensor, record: FitRecord) -> bool:
    """Whether more than half of a record's motion is left, beyond the noise."""
    moved = record.stacked - record.stacked.mean()
    noise = _noise_energy(residual)
    return float(residual.square().sum()) - noise > LOST * (float(moved.square().sum()) - noise)


def _noise_energy(residual: Tensor) -> float:
    """The sum of squares of the white noise in what is left, by the median of its periodogram: a motion has few lines.

    Powers of white noise are exponential, with a median of ln 2 of their mean.
    """
    return float(torch.fft.rfft(residual).abs().square().median()) / log(2)


def _quantities(found: Mapping[str, Estimate]) -> dict[str, Any]:
    """Estimates where an `OscillatorFit` has them."""
    named = ("damping_ratio_percent", "natural_frequency_hz", "log_decrement")
    parameters = {k: v for k, v in found.items() if k not in named}
    return {"parameters": parameters} | {name: found.get(name) for name in named}


def _fitted(
    problem: OutputErrorProblem, spring: bool, scale: float, report: Callable[[int, int], None] | None
) -> Fitted:
    """The best fit from several starts, over growing stretches of the records.

    Beside the peak per unit of force the response has one of its own. Where the force is short, as a stroke, that may
    be the better guess; and a stretch that ends in the stroke leads astray, so that it is tried over all at once. So
    does one in which nothing moves yet, as of a motor on a ramp of its voltage, to a damping of none.
    """
    found = fit(problem, _starts(problem, spring), Rounds(horizons=_horizons(problem, scale), report=report))
    if not spring:
        return min(found, fit(problem, _starts(problem, spring)), key=lambda one: one.cost)
    found = _that_dies(found, problem)
    rate = _first_rate(problem)
    own = 2 * pi * first_frequency(problem.records[0], driven=False) / rate if rate > 0 else 0.0
    is_new = not min(FIRST_SHIFTS) <= own <= max(FIRST_SHIFTS) or is_stroke(problem.records[0])
    if own <= 0 or not is_new:
        return found
    other = fit(problem, _starts(problem, spring, (own,)))
    return min(found, other, key=lambda one: one.cost)


def _that_dies(found: Fitted, problem: OutputErrorProblem) -> Fitted:
    """The fit, or a better one from motions that die away, where it found one that does not.

    Over a first stretch of few periods a small damping is not told from none; in the logarithm of what runs there,
    none is a place without a slope.
    """
    place = next((i for i, parameter in enumerate(problem.free) if parameter.name == DAMPING), None)
    if place is None:
        return found
    lasts = max(record.duration for record in problem.records)
    rate = float(problem.unknowns.parameters(found.shared)[DAMPING]) / (2 * fitted_mass(problem))
    if not 0 < rate * lasts < UNDYING:
        return found
    starts = found.shared.repeat(len(LOSES), 1)
    starts[:, place] += torch.tensor([log(times / (rate * lasts)) for times in LOSES], dtype=starts.dtype)
    other = fit(problem, starts, states=found.states.expand(len(LOSES), *found.states.shape))
    return min(found, other, key=lambda one: one.cost)


def _first_rate(problem: OutputErrorProblem) -> float:
    """The natural frequency in rad/s that the fit starts from; 0 without a spring."""
    stiffness = next((p.start for p in problem.free if p.name == problem.model.system.spring), 0.0)
    return (stiffness / fitted_mass(problem)) ** 0.5 if stiffness > 0 else 0.0


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


def _fit_residuals(
    problem: OutputErrorProblem, fitted: Fitted, records: Sequence[FitRecord], segments: Segments
) -> dict[str, Tensor]:
    left = fitted.prediction.residual[0] / problem.response.weights.clamp(min=1e-300)
    whole = joined(left, covered(records, segments), segments, problem.response.channels)
    return {record.name: found for record, found in zip(records, whole, strict=True)}


def _first(record: FitRecord, residuals: Mapping[str, Tensor]) -> Tensor:
    return residuals[record.name][: len(record.response)]


def _rmse(records: Sequence[FitRecord], residuals: Mapping[str, Tensor]) -> float | None:
    if not records:
        return None
    first = [_first(record, residuals) for record in records]
    return rmse(first, [torch.zeros_like(one) for one in first])
