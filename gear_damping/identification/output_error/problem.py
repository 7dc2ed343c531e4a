"""What is fitted to what: free parameters, records, and predictions with their sensitivities in one batch."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, isinf, log

import torch
from torch import Tensor

from gear_damping.physics.model import Model
from gear_damping.simulation.runs import effect_state_units
from gear_damping.simulation.simulate import natural_units, simulate
from gear_damping.simulation.solver_settings import Solver

SENSOR_NOISE = "sensor_noise"
OFFSET = "response_offset"  # a free parameter that is added to the prediction itself
DIFFERENCE = 1e-6  # step of the sensitivities, in units of each parameter's scale
STRETCHES = 8  # of a record, over which the growth of an error is followed
PROBED = 64  # samples from which the scale of an initial state of an effect is found


@dataclass(frozen=True)
class FreeParameter:
    """A parameter to fit.

    Args:
        name: Flat name in the model, with an index for one element of a list (`profile_error.phases[1]`),
            or `response_offset`.
        start: First guess, SI or the rig's own unit.
        scale: What counts as a step of order one; for a logarithmic one the start itself does.
        logarithmic: Whether its logarithm is fitted, which keeps its sign.
        lower: Smallest value.
        upper: Largest value.
        deviation: How far from zero it is expected to lie at most, as a standard deviation; not for a
            logarithmic one. It counts like one sample of the record's noise.
    """

    name: str
    start: float
    scale: float = 1.0
    logarithmic: bool = False
    lower: float = -inf
    upper: float = inf
    deviation: float = inf

    def value(self, z: Tensor) -> Tensor:
        """The parameter from its fitted coordinate."""
        found = self.start * torch.exp(z) if self.logarithmic else self.start + self.scale * z
        return found.clamp(self.lower, self.upper)

    @property
    def range(self) -> tuple[float, float]:
        """Coordinates between which the fit moves: at either end a step of the sensitivities still counts."""
        ends = (self._coordinate(self.lower), self._coordinate(self.upper))
        return min(ends), max(ends) - 2 * DIFFERENCE

    def _coordinate(self, bound: float) -> float:
        if isinf(bound):
            return bound
        if not self.logarithmic:
            return (bound - self.start) / self.scale
        return log(bound / self.start) if bound / self.start > 0 else -inf


@dataclass(frozen=True)
class FitRecord:
    """A measured record as the fit sees it.

    Args:
        name: What it is called.
        response: Samples, (time,), float64.
        sampling_rate: Hz.
        inputs: Measured input series at the same instants, by the name that the simulator gives them.
        conditions: Parameters that are known for this record alone, by flat name.
        weight: Factor on its residuals, one over the noise level where records differ in it.
    """

    name: str
    response: Tensor
    sampling_rate: float
    inputs: Mapping[str, Tensor] = field(default_factory=dict)
    conditions: Mapping[str, float] = field(default_factory=dict)
    weight: float = 1.0


@dataclass(frozen=True)
class Prediction:
    """Weighted residuals (starts, records, time) and sensitivities (starts, records, time, columns).

    The columns are the shared parameters, then the states at the start of the record (`OutputErrorProblem.local`).
    Samples beyond the end of a shorter record are zero in both.
    """

    residual: Tensor
    sensitivity: Tensor


class OutputErrorProblem:
    """Predictions of records by a model whose parameters are partly free."""

    def __init__(
        self,
        model: Model,
        given: Mapping[str, float],
        free: Sequence[FreeParameter],
        records: Sequence[FitRecord],
        solver: Solver | None = None,
        noise: float = 0.0,
    ) -> None:
        """State the problem.

        Args:
            model: The simulator.
            given: Parameters that are known, by flat name.
            free: Parameters to fit; every record's initial state is free besides, those of effects with it.
            records: At least one; all of one sampling rate.
            solver: Settings of the solver; its sub-steps are fixed, so that sensitivities are smooth.
            noise: Standard deviation of the records' noise, against which expectations are weighed.
        """
        if len({record.sampling_rate for record in records}) != 1:
            raise ValueError("records must share one sampling_rate: resample them, or fit them by rate")
        self.model, self.given, self.free, self.records = model, dict(given), list(free), list(records)
        self.solver, self.noise = solver or Solver(), noise
        self.response = _padded([record.response for record in records])
        self.weights = _padded([torch.full_like(record.response, record.weight) for record in records])
        self.spread = torch.stack([r.response.std().clamp(min=1e-300) for r in self.records])
        self.rate_scale = torch.stack([_rate_spread(r) for r in self.records])
        self.logarithmic = torch.tensor([parameter.logarithmic for parameter in self.free], dtype=torch.bool)
        self.bounds = torch.tensor([p.range for p in self.free], dtype=torch.float64).reshape(-1, 2).unbind(1)
        self.extra = tuple(effect_state_units(model))
        self.scales = self._scales()

    @property
    def n_shared(self) -> int:
        """Number of shared parameters."""
        return len(self.free)

    def first_states(self) -> Tensor:
        """A first guess of every initial state in its own scale, (records, local): the first samples of the record."""
        guesses = torch.zeros_like(self.scales)
        for i, record in enumerate(self.records):
            guesses[i, 0] = record.response[0]
            guesses[i, 1] = (record.response[1] - record.response[0]) * record.sampling_rate
        return guesses / self.scales

    def states_of(self, other: "OutputErrorProblem", states: Tensor) -> Tensor:
        """Initial states found by another problem of the same records, (..., records, local), as they are called here.

        States of effects that the other does not have are those where the effect puts them.
        """
        found = states.new_zeros(*states.shape[:-1], len(self.local))
        for place, name in enumerate(self.local):
            if name in other.local:
                there = other.local.index(name)
                found[..., place] = states[..., there] * other.scales[:, there] / self.scales[:, place]
        return found

    @property
    def local(self) -> tuple[str, ...]:
        """What every record has of its own: displacement and velocity at its start, and departures of other states."""
        return ("displacement", "velocity", *self.extra)

    def _scales(self) -> Tensor:
        """Scale of every initial state, (records, local); of an effect's, what moves the response by its spread."""
        own = torch.stack([self.spread, self.rate_scale], dim=1)
        if not self.extra:
            return own
        units = natural_units(self.model, self.model.prepare(self.model.values(1, **self.given)))
        steps = torch.stack([DIFFERENCE * units[name].expand(len(own)) for name in self.extra], dim=1)
        self.scales = torch.cat([own, steps], dim=1)
        states = self.first_states().repeat(len(self.extra) + 1, 1, 1)
        states[1:, :, 2:] += torch.eye(len(self.extra), dtype=states.dtype).unsqueeze(1)
        shared = torch.zeros(len(states), self.n_shared, dtype=torch.float64)
        found = self.predict(shared, states, min(PROBED, self.response.shape[1]))
        moved = (found[1:] - found[:1]).square().mean(-1).sqrt().T / self.spread.unsqueeze(1)
        factor = torch.where(moved.isfinite() & (moved > 0), 1 / moved, torch.ones_like(moved))
        return torch.cat([own, steps * factor], dim=1)

    def parameters(self, shared: Tensor) -> dict[str, Tensor]:
        """Values of the shared parameters from their coordinates (..., n_shared)."""
        return {p.name: p.value(shared[..., i]) for i, p in enumerate(self.free)}

    def expectation(self, shared: Tensor) -> tuple[Tensor, Tensor]:
        """Residuals of what is expected of the parameters, (..., n_shared), and their slopes, (n_shared,)."""
        slope = torch.tensor([self.noise * p.scale / p.deviation for p in self.free], dtype=torch.float64)
        start = torch.tensor([self.noise * p.start / p.deviation for p in self.free], dtype=torch.float64)
        return -(start + slope * shared), slope

    def within(self, shared: Tensor) -> Tensor:
        """Coordinates of the shared parameters (..., n_shared) within their bounds."""
        return shared.clamp(*self.bounds)

    def at_bound(self, shared: Tensor) -> Tensor:
        """-1 where a shared parameter (..., n_shared) is at its lower bound, 1 at its upper one, 0 between."""
        low, high = self.bounds
        return (shared >= high).long() - (shared <= low).long()

    def predict(self, shared: Tensor, states: Tensor, samples: int | None = None) -> Tensor:
        """Predicted responses (points, records, time) at coordinates (points, n_shared), (points, records, local)."""
        points, n_records = shared.shape[0], len(self.records)
        samples = samples or self.response.shape[1]
        batch = points * n_records
        values = self.model.values(batch, **self.given)
        found = self.parameters(shared)
        offset = found.pop(OFFSET, torch.zeros(points, dtype=torch.float64))
        for name, value in found.items():
            set_value(values, name, value.repeat_interleave(n_records))
        for name in {name for record in self.records for name in record.conditions}:
            known = torch.tensor([r.conditions.get(name, float("nan")) for r in self.records], dtype=torch.float64)
            values[name] = torch.where(known.isnan().repeat(points), values[name], known.repeat(points))
        start = (states * self.scales).reshape(batch, -1)
        values["initial_displacement"], values["initial_velocity"] = start[:, 0], start[:, 1]
        departures = {name: start[:, 2 + i] for i, name in enumerate(self.extra)}
        names = self.records[0].inputs
        inputs = {n: _padded([r.inputs[n] for r in self.records])[:, :samples] for n in names}
        rate = self.records[0].sampling_rate
        runs = simulate(
            self.model,
            values,
            sampling_rate=rate,
            n_samples=samples,
            inputs=inputs,
            solver=self.solver,
            departures=departures,
        )
        recorded = runs.record(torch.Generator().manual_seed(0), skip=(SENSOR_NOISE,))
        return recorded.reshape(points, n_records, samples) + offset.reshape(-1, 1, 1)

    def linearise(self, shared: Tensor, states: Tensor, samples: int | None = None) -> Prediction:
        """Residuals and sensitivities at several starts at once; every column is a member of one batch."""
        samples = min(samples or self.response.shape[1], self.response.shape[1])
        starts, columns = shared.shape[0], self.n_shared + len(self.local)
        steps = torch.zeros(columns + 1, columns, dtype=torch.float64)
        steps[1:] = DIFFERENCE * torch.eye(columns, dtype=torch.float64)
        all_shared = shared.unsqueeze(1) + steps[:, : self.n_shared]
        all_states = states.unsqueeze(1) + steps[:, self.n_shared :].unsqueeze(1)
        points = starts * (columns + 1)
        found = self.predict(all_shared.reshape(points, -1), all_states.reshape(points, len(self.records), -1), samples)
        found = found.reshape(starts, columns + 1, len(self.records), samples)
        weights = self.weights[:, :samples]
        residual = (self.response[:, :samples] - found[:, 0]) * weights
        sensitivity = (found[:, 1:] - found[:, :1]) / DIFFERENCE * weights
        return Prediction(residual, sensitivity.permute(0, 2, 3, 1))


def growth(prediction: Prediction, n_shared: int) -> float:
    """How much an error of the initial state grows from the beginning of a record, in the record where it grows most.

    The largest of several stretches counts, against the first one. Where it exceeds 1, the record can be predicted
    from its start no better than it is known.
    """
    error = prediction.sensitivity[0, ..., n_shared:].square().sum(-1)
    stretches = torch.stack([stretch.mean(-1) for stretch in error.tensor_split(STRETCHES, dim=-1)])
    found = (stretches.amax(0) / stretches[0].clamp(min=1e-300)).max().sqrt()
    return float(found) if bool(found.isfinite()) else inf


def set_value(values: dict[str, Tensor], name: str, value: Tensor) -> None:
    """Put the values of one parameter, or of one element of a list, where they belong."""
    flat, _, index = name.partition("[")
    if index:
        values[flat][int(index.rstrip("]"))] = value
    else:
        values[flat] = value


def _padded(series: Sequence[Tensor]) -> Tensor:
    """Rows of equal length, the shorter ones continued by zeros."""
    return torch.nn.utils.rnn.pad_sequence([s.to(torch.float64) for s in series], batch_first=True)


def _rate_spread(record: FitRecord) -> Tensor:
    """Standard deviation of the response's rate."""
    return (record.response.diff() * record.sampling_rate).std().clamp(min=1e-300)
