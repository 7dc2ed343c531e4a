"""What is fitted to what: free parameters, records, and predictions with their sensitivities in one batch."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import torch
from torch import Tensor

from gear_damping.identification.output_error.first_guess import first_motion, first_offset, static_deflection
from gear_damping.identification.output_error.observe import SENSOR_NOISE, filter_modes, interpolation, recorded
from gear_damping.identification.output_error.records import (
    DIFFERENCE,
    SEPARATOR,
    FitRecord,
    FreeParameter,
    Observed,
)
from gear_damping.physics.model import Model
from gear_damping.physics.terms import Sensor
from gear_damping.simulation.prepare import Planned, prepare_kernels
from gear_damping.simulation.runs import Runs, effect_state_units
from gear_damping.simulation.series import continued
from gear_damping.simulation.simulate import natural_units, simulate
from gear_damping.simulation.solver_settings import Solver

__all__ = ["DIFFERENCE", "SENSOR_NOISE", "FitRecord", "FreeParameter", "OutputErrorProblem", "Prediction", "growth"]
OFFSET, GAIN = "offset", "gain"  # `offset.velocity@run_1`, `gain.velocity`: of a channel, unknown to the model
STRETCHES = 8  # of a record, over which the growth of an error is followed
PROBED = 64  # samples from which the scale of an initial state of an effect is found


@dataclass(frozen=True)
class Prediction:
    """Weighted residuals (starts, records, samples) and sensitivities (starts, records, samples, columns).

    The columns are the shared parameters, then the states at the start of the record (`OutputErrorProblem.local`).
    The samples are those of the response channels one after another; beyond the end of a shorter record both are 0.
    """

    residual: Tensor
    sensitivity: Tensor
    channels: int = 1

    def pick(self, index: Tensor) -> "Prediction":
        """Some of the starts."""
        return replace(self, residual=self.residual[index], sensitivity=self.sensitivity[index])


class OutputErrorProblem:
    """Predictions of records by a model whose parameters are partly free.

    The shared coordinates are those of the free parameters, then those that single records have of their own (an
    offset, an angle at the start), each of which moves but its record, in all its segments.
    """

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
            free: Parameters to fit; every record's initial state and offsets are free besides.
            records: At least one; they may differ in rate and length.
            solver: Settings of the solver; its sub-steps are fixed, so that sensitivities are smooth.
            noise: Standard deviation of the records' noise, against which expectations are weighed.
        """
        self.model, self.records = model, list(records)
        self.given = {name: value for name, value in given.items() if _is_of_model(name)}
        self.gains = {name: value for name, value in given.items() if name.startswith(f"{GAIN}.")}
        self.solver, self.noise = solver or Solver(), noise
        self.channels = tuple(dict.fromkeys(c.name for record in self.records for c in record.channels))
        self.length = max(len(record.response) for record in self.records)
        self.response, self.weights = self._stack(_values), self._stack(_weights)
        self.static = static_deflection(model, self.given, self.records)
        common = [parameter for parameter in free if not parameter.per_record]
        own = [_own(template, record) for template in free if template.per_record for record in self._firsts]
        own += [_own(template, record) for record in self._firsts for template in record.own]
        self.free = [*common, *self._gains(common), *own, *self._offsets()]
        self.n_free = len(common)
        self.n_common = len(self.free) - len([p for p in self.free if SEPARATOR in p.name])
        self.logarithmic = torch.tensor([parameter.logarithmic for parameter in self.free], dtype=torch.bool)
        self.bounds = torch.tensor([p.range for p in self.free], dtype=torch.float64).reshape(-1, 2).unbind(1)
        self.extra = tuple(effect_state_units(model))
        self._padded_inputs: dict[tuple[tuple[int, ...], int], dict[str, Tensor]] = {}
        self.scales = self._scales()

    @property
    def n_shared(self) -> int:
        """Number of shared coordinates, those of single records among them."""
        return len(self.free)

    @cached_property
    def _firsts(self) -> list[FitRecord]:
        """The first segment of every record."""
        return list({record.record: record for record in reversed(self.records)}.values())[::-1]

    def _segments(self, record: str) -> list[int]:
        return [i for i, one in enumerate(self.records) if one.record == record]

    def _stack(self, of: object) -> Tensor:
        """(records, channels * time): what `of` gives of every channel that a record has, zeros elsewhere."""
        found = torch.zeros(len(self.records), len(self.channels), self.length, dtype=torch.float64)
        for i, record in enumerate(self.records):
            for channel, values in ((record.observed, record.response), *record.others):
                found[i, self.channels.index(channel.name), : len(values)] = of(record, channel, values)
        return found.flatten(1)

    def _gains(self, free: Sequence[FreeParameter]) -> list[FreeParameter]:
        """Gains of channels that are known with an uncertainty only."""
        known = {channel.name: channel.gain_uncertainty for record in self.records for channel in record.channels}
        names = {parameter.name for parameter in free}
        return [
            FreeParameter(f"{GAIN}.{name}", 1.0, logarithmic=True, deviation=relative)
            for name, relative in known.items()
            if relative and f"{GAIN}.{name}" not in {*names, *self.gains}
        ]

    def _offsets(self) -> list[FreeParameter]:
        found = []
        for first in self._firsts:
            places = self._segments(first.record)
            pieces = [self.records[i] for i in places]
            for channel in first.channels:
                if channel.offset:
                    start, scale = first_offset(pieces, channel, float(self.static[places[0]]))
                    found.append(FreeParameter(f"{OFFSET}.{channel.name}{SEPARATOR}{first.record}", start, scale))
        return found

    @cached_property
    def _alike(self) -> list[list[int]]:
        """Places of records that one simulation serves: of one rate, with the same inputs and sensors."""
        groups: dict[object, list[int]] = {}
        for i, record in enumerate(self.records):
            sensors = tuple(replace(channel, scale=1.0) for channel in record.channels)
            key = (record.sampling_rate, tuple(sorted(record.inputs)), record.held, sensors)
            groups.setdefault(key, []).append(i)
        return list(groups.values())

    @cached_property
    def _places(self) -> dict[int, list[tuple[Tensor, Tensor] | None]]:
        """By record, how the samples of each channel lie between those of the grid; None where they are on it."""
        found = {}
        for i, record in enumerate(self.records):
            at = torch.arange(len(record.response), dtype=torch.float64) if record.stamps is None else record.stamps
            late = [at - c.delay * record.sampling_rate for c in record.channels]
            even = record.stamps is None
            found[i] = [
                None if even and not c.delay else interpolation(positions, len(at))
                for c, positions in zip(record.channels, late, strict=True)
            ]
        return found

    def first_states(self) -> Tensor:
        """A first guess of every initial state in its own scale, (records, local), from the records' beginnings."""
        guesses = torch.zeros_like(self.scales)
        for i, record in enumerate(self.records):
            guesses[i, :2] = self._first_motion(record, i)[0]
        return guesses / self.scales

    def _first_motion(self, record: FitRecord, place: int) -> tuple[Tensor, Tensor]:
        return first_motion(record, self._first_offset(record), float(self.static[place]), self.model, self.given)

    def _first_offset(self, record: FitRecord) -> float:
        name = f"{OFFSET}.{record.observed.name}{SEPARATOR}{record.record}"
        return next((parameter.start for parameter in self.free if parameter.name == name), 0.0)

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

    def own_of(self, other: "OutputErrorProblem", shared: Tensor) -> Tensor:
        """Coordinates here of gains and of what single records have of their own, as another problem found them.

        Args:
            other: The problem.
            shared: Its coordinates, (other.n_shared,).

        Returns:
            (n_shared,), 0 for the free parameters.
        """
        known = {p.name: float(p.value(shared[i])) for i, p in enumerate(other.free[other.n_free :], other.n_free)}
        values = [p.coordinate(known[p.name]) if p.name in known else 0.0 for p in self.free[self.n_free :]]
        return torch.tensor([0.0] * self.n_free + values, dtype=torch.float64)

    def completed(self, shared: Tensor) -> Tensor:
        """Coordinates of the free parameters (..., any number of the first) with zeros for the others."""
        missing = self.n_shared - shared.shape[-1]
        return torch.nn.functional.pad(shared, (0, missing)) if missing else shared

    @property
    def local(self) -> tuple[str, ...]:
        """What every segment has of its own: displacement and velocity at its start, other states, those of filters."""
        return ("displacement", "velocity", *self.extra, *self._modes)

    @cached_property
    def _modes(self) -> tuple[str, ...]:
        """States of sensors at the start: of the model's on the first channel, then of declared filters by channel."""
        sensors = [e for e in self.model.effects if isinstance(e, Sensor)]
        names = [f"{sensor.name}.start[{i}]" for sensor in sensors for i in range(sensor.start_modes)]
        orders: dict[str, int] = {}
        for record in self.records:
            for channel in record.channels:
                orders[channel.name] = max(orders.get(channel.name, 0), sum(f.order for f in channel.filters))
        return (*names, *(f"{channel}.filter[{i}]" for channel, count in orders.items() for i in range(count)))

    def _scales(self) -> Tensor:
        """Scale of every initial state, (records, local); of an effect's, what moves the response by its spread."""
        own = torch.stack([self._first_motion(record, i)[1] for i, record in enumerate(self.records)])
        spread = torch.stack([record.response.std().clamp(min=1e-300) for record in self.records])
        modes = spread.unsqueeze(1).expand(-1, len(self._modes))
        if not self.extra:
            return torch.cat([own, modes], dim=1)
        units = natural_units(self.model, self.model.prepare(self.model.values(1, **self.given)))
        steps = torch.stack([DIFFERENCE * units[name].expand(len(own)) for name in self.extra], dim=1)
        self.scales = torch.cat([own, steps, modes], dim=1)
        states = self.first_states().repeat(len(self.extra) + 1, 1, 1)
        states[1:, :, 2 : 2 + len(self.extra)] += torch.eye(len(self.extra), dtype=states.dtype).unsqueeze(1)
        shared = torch.zeros(len(states), self.n_shared, dtype=torch.float64)
        found = self.predict(shared, states, PROBED / max(r.sampling_rate for r in self.records))
        moved = (found[1:] - found[:1]).square().mean(-1).sqrt().T / spread.unsqueeze(1)
        factor = torch.where(moved.isfinite() & (moved > 0), 1 / moved, torch.ones_like(moved))
        return torch.cat([own, steps * factor, modes], dim=1)

    def parameters(self, shared: Tensor) -> dict[str, Tensor]:
        """Values of the shared parameters from their coordinates (..., n_shared)."""
        return {p.name: p.value(shared[..., i]) for i, p in enumerate(self.free[: shared.shape[-1]])}

    def expectation(self, shared: Tensor) -> tuple[Tensor, Tensor]:
        """Residuals of what is expected of the parameters, (..., n_shared), and their slopes, (n_shared,)."""
        start, slope = torch.tensor([p.surprise for p in self.free], dtype=torch.float64).reshape(-1, 2).unbind(1)
        return -self.noise * (start + slope * shared), self.noise * slope

    def within(self, shared: Tensor) -> Tensor:
        """Coordinates of the shared parameters (..., n_shared) within their bounds."""
        return shared.clamp(*self.bounds)

    def at_bound(self, shared: Tensor) -> Tensor:
        """-1 where a shared parameter (..., n_shared) is at its lower bound, 1 at its upper one, 0 between."""
        low, high = self.bounds
        return (shared >= high).long() - (shared <= low).long()

    def samples_within(self, horizon: float | None) -> int:
        """Samples of the longest segment within so many seconds, or all of them."""
        if horizon is None:
            return self.length
        fastest = max(record.sampling_rate for record in self.records)
        return min(self.length, max(2, round(horizon * fastest)))

    def _cut(self, stacked: Tensor, samples: int) -> Tensor:
        """(records, channels * time) cut to the first samples of every channel."""
        return stacked.unflatten(-1, (len(self.channels), -1))[..., :samples].flatten(-2)

    def _beyond(self, horizon: float | None, samples: int) -> Tensor | float:
        """1 within the horizon and 0 beyond it, (records, channels * samples), where rates differ."""
        if horizon is None or len({record.sampling_rate for record in self.records}) == 1:
            return 1.0
        limit = torch.tensor([round(horizon * record.sampling_rate) for record in self.records])
        return (torch.arange(samples) < limit.unsqueeze(1)).double().repeat(1, len(self.channels))

    def predict(self, shared: Tensor, states: Tensor, horizon: float | None = None) -> Tensor:
        """Predicted responses (points, records, samples) at coordinates (points, n), (points, records, local).

        Args:
            shared: Of the shared parameters; those that are left out at the end are 0.
            states: Of the initial states.
            horizon: Seconds of every record that are predicted; all where absent.
        """
        samples, points = self.samples_within(horizon), shared.shape[0]
        values = self._values(self.completed(shared), points)
        found = shared.new_zeros(points, len(self.records), len(self.channels), samples)
        for rows in self._alike:
            rate = self.records[rows[0]].sampling_rate
            own = max(len(self.records[i].response) for i in rows)
            count = min(own, samples, max(2, round(horizon * rate)) if horizon else own)
            runs = self._simulated(values, states[:, rows], rows, count)
            self._observe(found, runs, values, states[:, rows], rows)
        return found.flatten(-2)

    def _values(self, shared: Tensor, points: int) -> dict[str, Tensor]:
        """Values by name, (points, records); nan where a record has none of its own."""
        found: dict[str, Tensor] = {}
        for name, value in self.parameters(shared).items():
            base, _, record = name.partition(SEPARATOR)
            if not record:
                found[base] = value.unsqueeze(1).expand(points, len(self.records))
                continue
            if base not in found:
                found[base] = shared.new_full((points, len(self.records)), torch.nan)
            found[base][:, self._segments(record)] = value.unsqueeze(1)
        return found

    def _simulated(self, values: Mapping[str, Tensor], states: Tensor, rows: list[int], samples: int) -> Runs:
        """Every point and record of these rows as members of one batch."""
        records, points = [self.records[i] for i in rows], states.shape[0]
        batch = points * len(rows)
        chosen = self.model.values(batch, **self.given)
        for name in {name for record in records for name in record.conditions if _is_of_model(name)}:
            known = torch.tensor([r.conditions.get(name, torch.nan) for r in records], dtype=torch.float64)
            _place(chosen, name, known.repeat(points))
        for name, value in values.items():
            if _is_of_model(name):
                _place(chosen, name, value[:, rows].reshape(-1))
        if "pinion_angle" in chosen:
            begins = torch.tensor([record.begins for record in records], dtype=torch.float64).repeat(points)
            chosen["pinion_angle"] = chosen["pinion_angle"] + chosen["pinion_speed"] * begins
        start = (states * self.scales[rows]).reshape(batch, -1)
        chosen["initial_displacement"], chosen["initial_velocity"] = start[:, 0], start[:, 1]
        departures = {name: start[:, 2 + i] for i, name in enumerate(self.extra)}
        return simulate(
            self.model,
            chosen,
            sampling_rate=records[0].sampling_rate,
            n_samples=samples,
            inputs=self._inputs(tuple(rows), samples),
            solver=self.solver,
            departures=departures,
            acceleration=any(channel.derivatives == 2 for channel in records[0].channels),
            held=records[0].held,
        )

    def _inputs(self, rows: tuple[int, ...], samples: int) -> dict[str, Tensor]:
        """Input series of some records at one length, made once."""
        if (rows, samples) not in self._padded_inputs:
            records = [self.records[i] for i in rows]
            names = records[0].inputs
            found = {n: torch.stack([continued(r.inputs[n], samples) for r in records]) for n in names}
            self._padded_inputs[rows, samples] = found
        return self._padded_inputs[rows, samples]

    def _observe(
        self, found: Tensor, runs: Runs, values: Mapping[str, Tensor], states: Tensor, rows: list[int]
    ) -> None:
        """Fill in what the channels of these records show, `found` (points, records, channels, time)."""
        points, n_rows, samples = states.shape[0], len(rows), len(runs.time)
        channels = self.records[rows[0]].channels
        modes = (states * self.scales[rows])[..., 2 + len(self.extra) :]
        begins = torch.tensor([self.records[i].begins for i in rows], dtype=torch.float64).repeat(points)
        for number, channel in enumerate(channels):
            shown = recorded(runs, channel, number == 0, begins).reshape(points, n_rows, samples)
            shown = shown + self._left_of_start(runs, channel, modes, number == 0)
            shown = _between(shown, [self._places[i][number] for i in rows])
            gain = values.get(f"{GAIN}.{channel.name}")
            shown = shown * (self.gains.get(f"{GAIN}.{channel.name}", 1.0) if gain is None else gain[:, rows, None])
            if (offset := values.get(f"{OFFSET}.{channel.name}")) is not None:
                shown = shown + offset[:, rows].nan_to_num(0.0).unsqueeze(-1)
            scale = shown.new_tensor([self.records[i].channels[number].scale for i in rows]).unsqueeze(1)
            found[:, rows, self.channels.index(channel.name), :samples] = shown * scale

    def _left_of_start(self, runs: Runs, channel: Observed, modes: Tensor, first: bool) -> Tensor | float:
        """What the states of the sensors at the start leave in a channel, (points, records, time)."""
        parts, total = [], 0.0
        if first:
            for sensor in (e for e in runs.model.effects if isinstance(e, Sensor) and e.start_modes):
                own = {p.name: runs.values[f"{sensor.name}.{p.name}"] for p in sensor.parameters}
                shape = (sensor.start_modes, *modes.shape[:2], len(runs.time))
                parts.append((f"{sensor.name}.start", sensor.left_of_start(own, runs.time).reshape(shape)))
        if channel.filters:
            shapes = filter_modes(channel.filters, runs.sampling_rate, len(runs.time))
            parts.append((f"{channel.name}.filter", shapes[:, None, None]))
        for name, shapes in parts:
            for i, shape in enumerate(shapes):
                place = self._modes.index(f"{name}[{i}]")
                total = total + modes[..., place, None] * shape
        return total

    def residuals(self, shared: Tensor, states: Tensor, horizon: float | None = None) -> Tensor:
        """Weighted residuals (starts, records, samples) at coordinates; arguments as for `predict`."""
        samples = self.samples_within(horizon)
        found = self.predict(shared, states, horizon)
        return (self._cut(self.response, samples) - found) * self._weighing(horizon, samples)

    def _weighing(self, horizon: float | None, samples: int) -> Tensor:
        """Weights of the samples within a horizon, (records, channels * samples)."""
        return self._cut(self.weights, samples) * self._beyond(horizon, samples)

    def linearise(
        self,
        shared: Tensor,
        states: Tensor,
        horizon: float | None = None,
        only: Collection[int] | None = None,
        residual: Tensor | None = None,
    ) -> Prediction:
        """Residuals and sensitivities at several starts at once; every column is a member of one batch.

        What single records have of their own shares a member where it bears the same name: it moves but its record.

        Args:
            shared: Coordinates of the shared parameters, (starts, any number of the first).
            states: Initial states, (starts, records, local).
            horizon: Seconds of every record that are predicted; all where absent.
            only: Shared coordinates whose sensitivities are worked out; those of the others are 0. All where absent.
            residual: Weighted residuals at these starts, where they are known.
        """
        shared = self.completed(shared)
        starts, moved = shared.shape[0], self._moved
        moved = moved if only is None else [columns for columns in moved if not {*columns}.isdisjoint(only)]
        steps = torch.zeros(len(moved) + len(self.local), self.n_shared + len(self.local), dtype=torch.float64)
        for row, columns in enumerate([*moved, *([self.n_shared + i] for i in range(len(self.local)))]):
            steps[row, columns] = DIFFERENCE
        if residual is None:
            steps = torch.cat([torch.zeros_like(steps[:1]), steps])
        points = starts * len(steps)
        at = (shared.unsqueeze(1) + steps[:, : self.n_shared]).reshape(points, -1)
        begun = (states.unsqueeze(1) + steps[:, None, self.n_shared :]).reshape(points, len(self.records), -1)
        left = self.residuals(at, begun, horizon).unflatten(0, (starts, -1))
        if residual is None:
            residual, left = left[:, 0], left[:, 1:]
        slopes = (residual.unsqueeze(1) - left) / DIFFERENCE
        reach = self.reach[:, None]
        columns = [slopes[:, row, :, :, None] * reach[..., moved[row]] for row in range(len(moved))]
        columns.append(slopes[:, len(moved) :].permute(0, 2, 3, 1))
        sensitivity = residual.new_zeros(*residual.shape, self.n_shared + len(self.local))
        places = [c for cs in moved for c in cs] + list(range(self.n_shared, sensitivity.shape[-1]))
        sensitivity[..., places] = torch.cat(columns, -1)
        return Prediction(residual, sensitivity, len(self.channels))

    @cached_property
    def _moved(self) -> list[list[int]]:
        """Shared coordinates that one member moves together."""
        groups: dict[str, list[int]] = {}
        for i, parameter in enumerate(self.free):
            groups.setdefault(parameter.name.partition(SEPARATOR)[0], []).append(i)
        return list(groups.values())

    @cached_property
    def reach(self) -> Tensor:
        """1 where a shared coordinate moves a record, (records, n_shared)."""
        reach = torch.ones(len(self.records), self.n_shared, dtype=torch.float64)
        for place, parameter in enumerate(self.free):
            own = parameter.name.partition(SEPARATOR)[2]
            if own:
                reach[:, place] = torch.tensor([float(one.record == own) for one in self.records])
        return reach


def prepare_predictions(
    models: Sequence[tuple[Model, Mapping[str, float]]], records: Sequence[FitRecord], solver: Solver | None = None
) -> None:
    """Compile what problems of these models need, on every core at once.

    Args:
        models: The simulators with their known parameters, as for `OutputErrorProblem`.
        records: What they will be fitted to.
        solver: Settings of the solver.
    """
    driven = {tuple(sorted(record.inputs)) for record in records}
    known = [(model, {k: v for k, v in given.items() if _is_of_model(k)}) for model, given in models]
    prepare_kernels([Planned(model, model.values(1, **g), names) for model, g in known for names in driven], solver)


def growth(prediction: Prediction, n_shared: int) -> float:
    """How much an error of the initial state grows from the beginning of a record, in the record where it grows most.

    The largest of several stretches counts, against the first one. Where it exceeds 1, the record can be predicted
    from its start no better than it is known.
    """
    error = prediction.sensitivity[0, ..., n_shared:].square().sum(-1)
    error = error.unflatten(-1, (prediction.channels, -1)).sum(1)
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


def is_of_model(name: str) -> bool:
    """Whether a fitted value is a parameter of the simulator, and not of a channel or of a single record."""
    return _is_of_model(name) and SEPARATOR not in name


def _is_of_model(name: str) -> bool:
    return name.partition(".")[0] not in (OFFSET, GAIN)


def _own(template: FreeParameter, record: FitRecord) -> FreeParameter:
    """What a record has of its own, beginning at what is known of it."""
    start = record.conditions.get(template.name, template.start)
    return replace(template, name=f"{template.name}{SEPARATOR}{record.record}", start=start, per_record=False)


def _place(values: dict[str, Tensor], name: str, value: Tensor) -> None:
    """As `set_value`, but for members without a value."""
    flat, _, index = name.partition("[")
    old = values[flat][int(index.rstrip("]"))] if index else values[flat]
    set_value(values, name, torch.where(value.isnan(), old, value))


def _values(record: FitRecord, channel: Observed, values: Tensor) -> Tensor:
    return values * channel.scale


def _weights(record: FitRecord, channel: Observed, values: Tensor) -> Tensor:
    """What the record counts; nothing of what a late channel shows from before its beginning."""
    positions = torch.arange(len(values), dtype=torch.float64) if record.stamps is None else record.stamps
    late = channel.delay * record.sampling_rate
    return record.weight * ((positions >= late) & (positions - late <= len(values) - 1)).double()


def _between(shown: Tensor, places: Sequence[tuple[Tensor, Tensor] | None]) -> Tensor:
    """Samples (points, records, time) at the instants at which each record was taken."""
    if all(place is None for place in places):
        return shown
    found, samples = shown.clone(), shown.shape[-1]
    for i, place in enumerate(places):
        if place is not None:
            inside = place[0].clamp(max=samples - 1)[:samples]
            found[:, i, : len(inside)] = (shown[:, i][:, inside] * place[1][:samples]).sum(-1)
    return found
