"""A fitted model on records that it never met: parameters frozen, only what each record has of its own is found."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

import torch
from torch import Tensor

from gear_damping.identification.output_error.angles import MESH_PHASE, angle_bases, scanned, steady_horizon
from gear_damping.identification.output_error.least_squares import Fitted, Rounds, fit
from gear_damping.identification.output_error.normal_equations import nuisance_basis, project_out
from gear_damping.identification.output_error.problem import OutputErrorProblem, Prediction, error_amplification
from gear_damping.identification.output_error.records import FitRecord, FreeParameter
from gear_damping.identification.output_error.segments import WHOLE, Segments, covered, in_segments, joined
from gear_damping.physics.model import Model
from gear_damping.simulation.solver_settings import Solver

FIRST_PERIODS = 1.25  # characteristic times at the start of a record that its initial state is first sought in
FIRST_ITERATIONS, LAST_ITERATIONS = 20, 20  # over a part of the record, and over all of it
FIRST_PART, MOST_OF_IT = 0.25, 0.75  # of a record; share of what is left in it that a wrong start would leave there
STRETCH_RATIO = 3.0  # of a stretch to the next: a speed found over one is that much surer over the next


@dataclass(frozen=True)
class HeldOut:
    """Predictions of records that were held out, with the initial state of each fitted over all of it.

    Args:
        predictions: The channels of each one after another, (channels * time,).
        residuals: The same of what is left, and without what another initial state would have changed.
        error_amplification: How much an error of the initial state grew at most, in the record where it grew most.
        own: What single records have of their own (offsets, angles), by name.
    """

    predictions: list[Tensor]
    residuals: list[Tensor]
    error_amplification: float
    own: dict[str, float]


@dataclass(frozen=True)
class Frozen:
    """A model whose parameters are known, but for what every record has of its own.

    Args:
        model: The simulator.
        given: Every parameter, by flat name.
        own: Parameters that every record has of its own.
        noise: Standard deviation of the records' noise, against which what is expected of these counts.
        solver: Settings of the solver.
    """

    model: Model
    given: Mapping[str, float]
    own: Sequence[FreeParameter] = ()
    noise: float = 0.0
    solver: Solver | None = None


def predict_holdout(
    frozen: Frozen,
    records: Sequence[FitRecord],
    characteristic_s: float,
    segments: Segments = WHOLE,
    initial: Mapping[str, float] | None = None,
) -> HeldOut:
    """Predict records.

    Args:
        frozen: The model.
        records: The records.
        characteristic_s: Time scale of the motion in s: sets the first stretch that the initial state is sought in.
        segments: How they are cut; each segment has an initial state.
        initial: Where parameters of single records begin, by name; angles that are not among them are tried all around.
    """
    segmented = in_segments(records, segments)
    problem = OutputErrorProblem(frozen.model, frozen.given, list(frozen.own), segmented, frozen.solver, frozen.noise)
    known = dict(initial or {})
    starts = problem.unknowns.coordinates(known).unsqueeze(0)
    unknown = [base for base in angle_bases(problem) if not any(name.startswith(base) for name in known)]
    states = problem.safe_states(starts[0])
    horizons = _horizons(problem, characteristic_s, unknown)
    iterations = (*(FIRST_ITERATIONS for _ in horizons[1:]), LAST_ITERATIONS)
    turned = _turned(problem, starts, horizons[0], unknown, states)
    first = fit(problem, turned, Rounds(iterations, horizons), states.unsqueeze(0))
    if unknown and len(horizons) > 1:  # or at the speed as it is stated, which short stretches may lead away from
        turned = _turned(problem, starts, None, unknown, states)
        other = fit(problem, turned, Rounds(LAST_ITERATIONS), states.unsqueeze(0))
        first = min(first, other, key=lambda one: one.cost)
    found = _restarted(problem, first, iterations[-1])
    prediction, weights = found.prediction, problem.response.weights.clamp(min=1e-300)
    left = prediction.residual[0] / weights
    projected = _projected_out(prediction, problem.n_shared) / weights
    counted = (problem.response.weights > 0).double()
    kept, channels = covered(records, segments), problem.response.channels
    whole = [
        joined(series * counted, kept, segments, channels) for series in (problem.response.values - left, projected)
    ]
    values = {name: float(value) for name, value in problem.unknowns.parameters(found.shared).items()}
    return HeldOut(*whole, error_amplification(prediction, problem.n_shared), values)


def _turned(
    problem: OutputErrorProblem, starts: Tensor, horizon: float | None, unknown: Sequence[str], states: Tensor
) -> Tensor:
    """Starts (1, n) with the angles that are unknown at the best of all around, over so many seconds."""
    found = starts.clone()
    places = {parameter.name: place for place, parameter in enumerate(problem.free)}
    for name, angle in scanned(problem, starts[0], horizon, unknown, states).items() if unknown else ():
        found[0, places[name]] = problem.free[places[name]].coordinate(angle)
    return found


def _horizons(problem: OutputErrorProblem, characteristic_s: float, unknown: Sequence[str]) -> list[float | None]:
    """Seconds of the records over which one fit after another goes, None for all of them.

    So short a stretch as shows how an oscillator begins tells nothing of an angle, which would leave the valley that
    it was begun in. A speed that is uncertain turns the mesh away from any angle in time, and is followed from there;
    where the angle of the mesh is known, its speed is.
    """
    if not angle_bases(problem):
        return [FIRST_PERIODS * characteristic_s, None]
    steady = steady_horizon(problem) if MESH_PHASE in unknown else inf
    longest, found = max(len(record.response) / record.sampling_rate for record in problem.records), []
    while steady < longest:
        found.append(steady)
        steady *= STRETCH_RATIO
    return [*found, None]


def _restarted(problem: OutputErrorProblem, found: Fitted, iterations: int) -> Fitted:
    """The fit with records that seem to start wrong restarted from rest, or half way to it, where that is better.

    What is left of such a record lies at its beginning. A displacement that was integrated twice from an acceleration
    may be so far off that no small step leads back.
    """
    residual = found.prediction.residual[0].unflatten(-1, (len(problem.response.channels), -1)).square().sum(1)
    lengths = torch.tensor([len(record.response) for record in problem.records])
    is_first = torch.arange(residual.shape[1]) < (FIRST_PART * lengths).unsqueeze(1)
    wrong = (residual * is_first).sum(1) > MOST_OF_IT * residual.sum(1)
    rest, best = problem.states_at_rest(), found
    for share in (1.0, 0.5) if bool(wrong.any()) else ():
        states = torch.where(wrong.unsqueeze(1), found.states + share * (rest - found.states), found.states)
        again = fit(problem, found.shared.unsqueeze(0), Rounds(iterations), states.unsqueeze(0))
        best = again if again.cost < best.cost else best
    return best


def _projected_out(found: Prediction, n_shared: int) -> Tensor:
    """Weighted residuals (records, samples) of one start, what the initial states could change projected out."""
    residual, sensitivity = found.residual[0], found.sensitivity[0]
    if not bool(sensitivity.isfinite().all() & residual.isfinite().all()):
        return residual
    return project_out(residual.unsqueeze(-1), nuisance_basis(sensitivity, n_shared)).squeeze(-1)


def rmse(measured: Sequence[Tensor], predicted: Sequence[Tensor]) -> float:
    """Root mean square of the residual over all samples of several records."""
    total = sum(float((m - p).square().sum()) for m, p in zip(measured, predicted, strict=True))
    return (total / sum(len(m) for m in measured)) ** 0.5
