"""A linear oscillator from measured records: mass-normalised parameters with intervals."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
import torch
from torch import Tensor

from gear_damping.identification.output_error.holdout import predict_holdout, rmse
from gear_damping.identification.output_error.least_squares import Fitted, fit
from gear_damping.identification.output_error.problem import OFFSET, FitRecord, FreeParameter, OutputErrorProblem
from gear_damping.identification.output_error.uncertainty import covariance, interval
from gear_damping.physics.effects.offset_force import OffsetForce
from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.systems.oscillator import Oscillator
from gear_damping.simulation.solver_settings import Solver

STIFFNESS, DAMPING, GAIN, FORCE = "stiffness", "viscous_damping.damping_coefficient", "force_gain", "offset_force.force"
FIRST_RATIOS = (0.01, 0.05, 0.2)  # damping ratios of the starts
FIRST_SHIFTS = (0.93, 1.0, 1.07)  # of the frequency of the starts
HORIZON_PERIODS = (4, 20, 100)  # natural periods of the rounds before the whole record
CORRELATED_PERIODS = 3.0


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
        damping_ratio_percent: In % of critical.
        natural_frequency_hz: Undamped.
        log_decrement: Of successive peaks.
        predictions: By record name, (time,).
        rmse: By role, `fit` and `holdout` (None without such records), in the unit of the response.
        converged: Whether the search came to rest.
        given: Every parameter of the fitted model by flat name.
        offset: Constant added to the response.
    """

    parameters: dict[str, Estimate]
    damping_ratio_percent: Estimate
    natural_frequency_hz: Estimate
    log_decrement: Estimate
    predictions: dict[str, Tensor]
    rmse: dict[str, float | None]
    converged: bool
    given: dict[str, float]
    offset: float


def fit_oscillator(
    fit_records: Sequence[FitRecord],
    holdout_records: Sequence[FitRecord] = (),
    report: Callable[[int, int], None] | None = None,
    solver: Solver | None = None,
) -> OscillatorFit:
    """Stiffness, damping and gain per unit of mass; offsets of force and response are nuisances.

    Args:
        fit_records: Records of one rig and one sampling rate, with the input `force` or as free decays.
        holdout_records: Records to predict with the parameters frozen.
        report: Told (done, total) rounds.
        solver: Settings of the solver.
    """
    forced = "force" in fit_records[0].inputs
    frequency = first_frequency(fit_records[0])
    problem = _problem(fit_records, frequency, forced, solver)
    starts = _starts(problem, forced)
    fitted = fit(problem, starts, _horizons(problem, frequency), report=report)
    values = {name: float(value) for name, value in problem.parameters(fitted.shared).items()}
    offset = values.pop(OFFSET)
    given = problem.given | values
    found = _estimates(problem, fitted, frequency)
    natural = found["natural_frequency_hz"].value
    predictions = _fit_predictions(problem, fitted)
    if holdout_records:
        held = predict_holdout(problem.model, given, offset, holdout_records, natural, solver).predictions
        predictions |= {record.name: found for record, found in zip(holdout_records, held, strict=True)}
    return OscillatorFit(
        parameters={k: v for k, v in found.items() if k in (STIFFNESS, GAIN, "damping_coefficient")},
        damping_ratio_percent=found["damping_ratio_percent"],
        natural_frequency_hz=found["natural_frequency_hz"],
        log_decrement=found["log_decrement"],
        predictions=predictions,
        rmse={"fit": _rmse(fit_records, predictions), "holdout": _rmse(holdout_records, predictions)},
        converged=fitted.converged,
        given=given,
        offset=offset,
    )


def first_frequency(record: FitRecord) -> float:
    """A first guess of the natural frequency in Hz: the highest peak of the response per unit of force."""
    response = record.response.numpy() - float(record.response.mean())
    window = np.hanning(len(response))
    spectrum = np.abs(np.fft.rfft(response * window)) ** 2
    frequency = np.fft.rfftfreq(len(response), 1 / record.sampling_rate)
    width = max(1, len(spectrum) // 400)
    smooth = np.convolve(spectrum, np.ones(width) / width, mode="same")
    if "force" in record.inputs:
        force = record.inputs["force"].numpy()
        drive = np.convolve(np.abs(np.fft.rfft((force - force.mean()) * window)) ** 2, np.ones(width) / width, "same")
        smooth = np.where(drive > 1e-3 * drive.max(), smooth / np.maximum(drive, 1e-300), 0)
    first = max(1, width // 2)
    return float(frequency[first + int(np.argmax(smooth[first:]))])


def _problem(records: Sequence[FitRecord], frequency: float, forced: bool, solver: Solver | None) -> OutputErrorProblem:
    spread = float(torch.cat([r.response for r in records]).std())
    rate = 2 * pi * frequency
    free = [
        FreeParameter(STIFFNESS, rate**2, logarithmic=True),
        FreeParameter(DAMPING, 2 * FIRST_RATIOS[0] * rate, logarithmic=True, lower=1e-9 * rate),
        FreeParameter(OFFSET, 0.0, scale=spread),
    ]
    effects = [ViscousDamping()]
    if forced:
        force = torch.cat([r.inputs["force"] for r in records])
        gain = rate**2 * 2 * FIRST_RATIOS[1] * spread / float(force.std())
        free += [FreeParameter(GAIN, gain, scale=gain), FreeParameter(FORCE, 0.0, scale=rate**2 * spread)]
        effects.append(OffsetForce())
    model = Model(Oscillator(), effects)
    return OutputErrorProblem(model, {"amplitude": spread}, free, records, solver)


def _starts(problem: OutputErrorProblem, forced: bool) -> Tensor:
    """Coordinates of the starts: every frequency with every damping ratio."""
    rows = []
    for shift in FIRST_SHIFTS:
        for ratio in FIRST_RATIOS:
            row = torch.zeros(problem.n_shared, dtype=torch.float64)
            row[0] = 2 * float(np.log(shift))
            row[1] = float(np.log(ratio / FIRST_RATIOS[0]))
            rows.append(row)
    return torch.stack(rows)


def _horizons(problem: OutputErrorProblem, frequency: float) -> list[int]:
    total, rate = problem.response.shape[1], problem.records[0].sampling_rate
    short = [round(periods * rate / frequency) for periods in HORIZON_PERIODS]
    return [samples for samples in short if 20 <= samples < total] + [total]


def _estimates(problem: OutputErrorProblem, fitted: Fitted, frequency: float) -> dict[str, Estimate]:
    lags = round(CORRELATED_PERIODS * problem.records[0].sampling_rate / frequency)
    spread = covariance(problem, fitted, lags)
    place = {parameter.name: i for i, parameter in enumerate(problem.free)}

    def value(name: str, shared: Tensor) -> Tensor:
        return problem.free[place[name]].value(shared[place[name]])

    def ratio(shared: Tensor) -> Tensor:
        return value(DAMPING, shared) / (2 * value(STIFFNESS, shared).sqrt())

    quantities = {
        STIFFNESS: (lambda s: value(STIFFNESS, s), "1/s^2"),
        "damping_coefficient": (lambda s: value(DAMPING, s), "1/s"),
        "damping_ratio_percent": (lambda s: 100 * ratio(s), "%"),
        "natural_frequency_hz": (lambda s: value(STIFFNESS, s).sqrt() / (2 * pi), "Hz"),
        "log_decrement": (lambda s: 2 * pi * ratio(s) / (1 - ratio(s) ** 2).sqrt(), "1"),
    }
    if GAIN in place:
        quantities[GAIN] = (lambda s: value(GAIN, s), "response unit / force unit / s^2")
    found = {name: (interval(function, fitted.shared, spread), unit) for name, (function, unit) in quantities.items()}
    return {name: Estimate(number, bounds, unit) for name, ((number, bounds), unit) in found.items()}


def _fit_predictions(problem: OutputErrorProblem, fitted: Fitted) -> dict[str, Tensor]:
    return {
        record.name: record.response - fitted.prediction.residual[0, i, : len(record.response)] / record.weight
        for i, record in enumerate(problem.records)
    }


def _rmse(records: Sequence[FitRecord], predictions: dict[str, Tensor]) -> float | None:
    if not records:
        return None
    return rmse([r.response for r in records], [predictions[r.name] for r in records])
