"""A fitted model on records that it never met: parameters frozen, only the start of each is found."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.identification.output_error.least_squares import fit, own_basis, without_own
from gear_damping.identification.output_error.pieces import in_pieces, joined, part
from gear_damping.identification.output_error.problem import (
    OFFSET,
    FitRecord,
    FreeParameter,
    OutputErrorProblem,
    Prediction,
    growth,
)
from gear_damping.physics.model import Model
from gear_damping.simulation.solver_settings import Solver

START_PERIODS = 1.25  # natural periods at the start of a record that its initial state is found from,
LARGEST_START = 0.25  # but at most this share of the shortest record


@dataclass(frozen=True)
class HeldOut:
    """Predictions of records that were held out.

    Args:
        predictions: Each (time,).
        beside_start: Residuals without what another initial state would have changed, each (time,): the start is
            found from few samples, and its error tells nothing of the model.
        growth: How much an error of the initial state grew at most, in the record where it grew most.
    """

    predictions: list[Tensor]
    beside_start: list[Tensor]
    growth: float


def predict_holdout(
    model: Model,
    given: Mapping[str, float],
    offset: float,
    records: Sequence[FitRecord],
    natural_frequency_hz: float,
    solver: Solver | None = None,
    piece: int = 0,
) -> HeldOut:
    """Predict records of one sampling rate.

    Args:
        model: The simulator.
        given: Every parameter, by flat name.
        offset: Constant that is added to the response.
        records: The records; beyond their first 1.25 natural periods only their inputs are used.
        natural_frequency_hz: Of the slowest mode; sets those periods.
        solver: Settings of the solver.
        piece: Samples after which the state is found anew; 0 for once in each record.
    """
    pieces = in_pieces(records, piece)
    wanted = START_PERIODS / natural_frequency_hz * records[0].sampling_rate
    samples = max(6, round(min(wanted, LARGEST_START * min(len(record.response) for record in pieces))))
    beginnings = [part(record, slice(0, samples)) for record in pieces]
    frozen = [FreeParameter(OFFSET, offset, scale=0.0)]
    none = torch.zeros(1, 1, dtype=torch.float64)
    short = OutputErrorProblem(model, given, frozen, beginnings, solver)
    start = fit(short, none)
    whole = OutputErrorProblem(model, given, frozen, pieces, solver)
    states = whole.states_of(short, start.states)
    found = whole.linearise(none, states.unsqueeze(0))
    weights = whole.weights.clamp(min=1e-300)
    predicted = whole.response - found.residual[0] / weights
    beside = _beside_start(found, whole.n_shared) / weights
    return HeldOut(joined(predicted, records, piece), joined(beside, records, piece), growth(found, whole.n_shared))


def _beside_start(found: Prediction, n_shared: int) -> Tensor:
    """Weighted residuals (records, time) of one start beside what the initial states could change."""
    residual, sensitivity = found.residual[0], found.sensitivity[0]
    if not bool(sensitivity.isfinite().all() & residual.isfinite().all()):
        return residual
    return without_own(residual.unsqueeze(-1), own_basis(sensitivity, n_shared)).squeeze(-1)


def rmse(measured: Sequence[Tensor], predicted: Sequence[Tensor]) -> float:
    """Root mean square of the residual over all samples of several records."""
    total = sum(float((m - p).square().sum()) for m, p in zip(measured, predicted, strict=True))
    return (total / sum(len(m) for m in measured)) ** 0.5
