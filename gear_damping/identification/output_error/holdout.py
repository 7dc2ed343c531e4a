"""A fitted model on records that it never met: parameters frozen, only the start of each is found."""

from collections.abc import Sequence

import torch
from torch import Tensor

from gear_damping.identification.output_error.least_squares import fit
from gear_damping.identification.output_error.problem import FitRecord, FreeParameter, OutputErrorProblem
from gear_damping.physics.model import Model
from gear_damping.simulation.solver_settings import Solver

START_PERIODS = 1.25  # natural periods at the start of a record that its initial state is found from


def predict_holdout(
    model: Model,
    given: dict[str, float],
    offset: float,
    record: FitRecord,
    natural_frequency_hz: float,
    solver: Solver | None = None,
) -> Tensor:
    """The prediction of one record, (time,).

    Args:
        model: The simulator.
        given: Every parameter, by flat name.
        offset: Constant that is added to the response.
        record: The record; beyond its first 1.25 natural periods only its inputs are used.
        natural_frequency_hz: Sets those periods.
        solver: Settings of the solver.
    """
    samples = max(6, round(START_PERIODS / natural_frequency_hz * record.sampling_rate))
    samples = min(samples, len(record.response))
    beginning = FitRecord(
        record.name,
        record.response[:samples],
        record.sampling_rate,
        {name: series[:samples] for name, series in record.inputs.items()},
        record.conditions,
    )
    free = [FreeParameter("response_offset", offset, scale=0.0)]
    start = fit(OutputErrorProblem(model, given, free, [beginning], solver), torch.zeros(1, 1, dtype=torch.float64))
    whole = OutputErrorProblem(model, given, free, [record], solver)
    scaled = start.states.unsqueeze(0) * _ratio(beginning, record)
    return whole.predict(torch.zeros(1, 1, dtype=torch.float64), scaled)[0, 0]


def _ratio(beginning: FitRecord, record: FitRecord) -> Tensor:
    """From the scale of the beginning to that of the whole record."""
    problems = [OutputErrorProblem(None, {}, [], [r]) for r in (beginning, record)]
    scales = [torch.stack([p.spread[0], p.rate_scale[0]]) for p in problems]
    return scales[0] / scales[1]


def rmse(measured: Sequence[Tensor], predicted: Sequence[Tensor]) -> float:
    """Root mean square of the residual over all samples of several records."""
    total = sum(float((m - p).square().sum()) for m, p in zip(measured, predicted, strict=True))
    return (total / sum(len(m) for m in measured)) ** 0.5
