"""What is fitted to what: free parameters, records, and predictions with their sensitivities in one batch."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import torch
from torch import Tensor

from gear_damping.identification.output_error.first_guess import (
    first_motion,
    first_offset,
    participation,
    static_deflection,
)
from gear_damping.identification.output_error.records import (
    DIFFERENCE,
    SEPARATOR,
    FitRecord,
    FreeParameter,
    Observed,
)
from gear_damping.identification.output_error.response import Response
from gear_damping.identification.output_error.unknowns import (
    GAIN,
    OFFSET,
    Unknowns,
    first_segments,
    is_of_simulator,
    segments_of,
)
from gear_damping.physics.model import Model
from gear_damping.physics.systems.traits import Trait
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.prepare import Planned, prepare_kernels
from gear_damping.simulation.runs import Runs, effect_state_units
from gear_damping.simulation.series import continued
from gear_damping.simulation.simulate import natural_units, simulate
from gear_damping.simulation.solver_settings import Solver

STRETCHES = 8  # of a record, over which the amplification of an error is followed
BY_CHANCE = 3.0  # deviations by which lines of white noise differ, one in a thousand times
PROBED = 64  # samples from which the scale of an initial state of an effect is found


@dataclass(frozen=True)
class Prediction:
    """Weighted residuals (starts, records, samples) and sensitivities (starts, records, samples, columns).

    The columns are the shared parameters, then the states at the start of the record (`OutputErrorProblem.local`).
    The samples are those of the response channels one after another; beyond the end of a shorter record both are 0.
    `level` (starts,) is what expectations of the parameters were weighed by there; None where nobody asks.
    """

    residual: Tensor
    sensitivity: Tensor
    channels: int = 1
    level: Tensor | None = None

    def along(self, changes: Tensor) -> Tensor:
        """What changes of the columns' coordinates (starts, records, columns) do to the response, linearised."""
        return (self.sensitivity @ changes.unsqueeze(-1)).squeeze(-1)

    def pick(self, index: Tensor) -> "Prediction":
        """Some of the starts."""
        level = None if self.level is None else self.level[index]
        return replace(self, residual=self.residual[index], sensitivity=self.sensitivity[index], level=level)


def samples_alike(residual: Tensor) -> Tensor:
    """How many samples of residuals (..., records, samples) say together what one of white noise says, (...).

    The power of white noise is spread over all lines of a spectrum, and that of what a model lacks stands in a few:
    N sum(P^2) / (2 sum(P)^2) of N lines is 1 for the one, within 1 / sqrt(N), and N / 2n for n lines alike.
    """
    if residual.numel() == 0:
        return residual.new_ones(residual.shape[:-2])
    power = torch.fft.rfft(residual).abs().square().flatten(-2)
    lines = power.shape[-1]
    found = lines * power.square().sum(-1) / (2 * power.sum(-1).square()).clamp(min=1e-300)
    return torch.where(found > 1 + BY_CHANCE / lines**0.5, found, 1.0)  # nor where it is not finite


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
            free: Parameters to fit; every record's initial state and offsets are free besides.
            records: At least one; they may differ in rate and length.
            solver: Settings of the solver; its sub-steps are fixed, so that sensitivities are smooth.
            noise: Standard deviation of the records' noise, against which expectations are weighed.
        """
        self.model, self.records = model, list(records)
        self.given = {name: value for name, value in given.items() if is_of_simulator(name)}
        accelerates = any(channel.derivatives == 2 for record in records for channel in record.channels)
        self.solver, self.noise = replace(solver or Solver(), acceleration=accelerates), noise
        gains = {name: value for name, value in given.items() if name.startswith(f"{GAIN}.")}
        self.response = Response(model, self.records, gains)
        self.static = static_deflection(model, self.given, self.records)
        self.unknowns = Unknowns(free, self.records, gains, self._offsets())
        self.extra = tuple(effect_state_units(model))
        self._padded_inputs: dict[tuple[tuple[int, ...], int], dict[str, Tensor]] = {}
        self.scales = self._scales()

    @property
    def free(self) -> list[FreeParameter]:
        """Every shared coordinate in order."""
        return self.unknowns.free

    @property
    def n_shared(self) -> int:
        """Number of shared coordinates, those of single records among them."""
        return len(self.unknowns)

    @property
    def local(self) -> tuple[str, ...]:
        """What every segment has of its own: displacement and velocity at its start, other states, those of filters."""
        return ("displacement", "velocity", *self.extra, *self.response.modes)

    def _offsets(self) -> list[FreeParameter]:
        """Zeros of channels that are not known, one for each record, and how they change slowly."""
        found, parts = [], self.model.flanks_may_part
        for first in first_segments(self.records):
            places = segments_of(self.records, first.record)
            its_records = [self.records[i] for i in places]
            for channel in (c for c in first.channels if c.offset):
                start, scale = first_offset(its_records, channel, float(self.static[places[0]]), parts)
                found.append(FreeParameter(_offset_of(first, channel.name), start, scale))
            for channel in (c for c in first.channels if c.slow):
                size = channel.slow.deviation
                names = [_offset_of(first, f"{channel.name}[{k + 1}]") for k in range(channel.slow.terms)]
                found += [FreeParameter(name, 0.0, size, deviation=size, expected=0.0) for name in names]
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
    def _factors(self) -> dict[Observed, float]:
        """What first channels show of the motion."""
        return {one: participation(one, self.model, self.given) for one in {r.observed for r in self.records}}

    def first_states(self) -> Tensor:
        """A first guess of every initial state in its own scale, (records, local), from the records' beginnings."""
        guesses = torch.zeros_like(self.scales)
        for i, record in enumerate(self.records):
            guesses[i, :2] = self._first_motion(record, i)[0]
        return guesses / self.scales

    def safe_states(self, shared: Tensor) -> Tensor:
        """The first guess, or rest for records that run away from it, (records, local).

        A displacement that was integrated from an acceleration may be far off, and beyond the edge of the well of a
        softening spring.

        Args:
            shared: Coordinates of everything else, (n_shared,).
        """
        guess, rest = self.first_states(), self.states_at_rest()
        tried = torch.stack([guess, (guess + rest) / 2, rest])
        stays = self.residuals(shared.expand(len(tried), -1), tried).isfinite().all(-1)
        first = stays.long().argmax(0)  # 0, the guess itself, where none stays
        return tried[first, torch.arange(len(guess))]

    def states_at_rest(self) -> Tensor:
        """The initial states of records that begin where their load holds them, (records, local)."""
        rest = torch.zeros_like(self.scales)
        rest[:, 0] = self.static / self.scales[:, 0]
        return rest

    def _first_motion(self, record: FitRecord, place: int) -> tuple[Tensor, Tensor]:
        name = _offset_of(record, record.observed.name)
        offset = next((parameter.start for parameter in self.free if parameter.name == name), 0.0)
        return first_motion(record, offset, float(self.static[place]), self._factors[record.observed])

    def states_of(self, other: "OutputErrorProblem", states: Tensor, places: Sequence[int]) -> Tensor:
        """Initial states found by another problem, (..., its records, local), as they are called here.

        States of effects that the other does not have are those where the effect puts them.

        Args:
            other: The other problem.
            states: What it found.
            places: For each record here, the one there that begins with it.
        """
        kept, scales = states[..., list(places), :], other.scales[list(places)]
        found = states.new_zeros(*kept.shape[:-1], len(self.local))
        for place, name in enumerate(self.local):
            if name in other.local:
                there = other.local.index(name)
                found[..., place] = kept[..., there] * scales[:, there] / self.scales[:, place]
        return found

    def _scales(self) -> Tensor:
        """Scale of every initial state, (records, local); of an effect's, what moves the response by its deviation."""
        own = torch.stack([self._first_motion(record, i)[1] for i, record in enumerate(self.records)])
        deviation = torch.stack([record.response.std().clamp(min=1e-300) for record in self.records])
        modes = deviation.unsqueeze(1).expand(-1, len(self.response.modes))
        if not self.extra:
            return torch.cat([own, modes], dim=1)
        units = natural_units(self.model, self.model.prepare(self.model.values(1, **self.given)))
        steps = torch.stack([DIFFERENCE * units[name].expand(len(own)) for name in self.extra], dim=1)
        self.scales = torch.cat([own, steps, modes], dim=1)
        states = self.first_states().repeat(len(self.extra) + 1, 1, 1)
        states[1:, :, 2 : 2 + len(self.extra)] += torch.eye(len(self.extra), dtype=states.dtype).unsqueeze(1)
        shared = torch.zeros(len(states), self.n_shared, dtype=torch.float64)
        found = self.predict(shared, states, PROBED / max(r.sampling_rate for r in self.records))
        moved = (found[1:] - found[:1]).square().mean(-1).sqrt().T / deviation.unsqueeze(1)
        factor = torch.where(moved.isfinite() & (moved > 0), 1 / moved, torch.ones_like(moved))
        return torch.cat([own, steps * factor, modes], dim=1)

    def expectation(self, shared: Tensor, residual: Tensor, level: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Residuals of what is expected of the parameters, and their slopes, both (..., n_shared).

        They are weighed against what is left where that is more than noise: a model that lacks something tells its
        parameters no better than it follows. Weighed against the noise, a stated inertia bends by thirteen of its
        deviations for the last per mille of a residual that is thirty times the noise. Lines of a mesh count as the few
        that they are, however many samples show them: else it bends by twelve for 3 %.

        Args:
            shared: Coordinates, (..., n_shared).
            residual: Weighted residuals there, (..., records, samples).
            level: What they are weighed against, (...); what is left there where absent.
        """
        level = self.level(residual) if level is None else level
        return self.unknowns.expectation(shared, level.unsqueeze(-1))

    def level(self, residual: Tensor) -> Tensor:
        """What expectations are weighed against, of residuals (..., records, samples), (...).

        A mesh repeats itself, and what a model lacks of it with it; a motion that dies away, or is driven at random,
        says something else in every sample.
        """
        level = self._level(residual)
        return level * samples_alike(residual).sqrt() if self._repeats else level

    def held_level(self, residual: Tensor) -> Tensor | None:
        """The same, where it is held until the next linearisation; None where it follows what is left at once."""
        return self.level(residual) if self._repeats else None

    @property
    def _repeats(self) -> bool:
        return self.model.system.has(Trait.TEETH)

    def expected_information(self, shared: Tensor, residual: Tensor) -> Tensor:
        """What is expected of the parameters as information beside that of the samples, (n_shared,).

        Each counts as one sample, so that what no sample speaks of keeps its stated deviation.
        """
        return self.unknowns.expectation(shared, self._level(residual).unsqueeze(-1))[1].square()

    def cost(self, shared: Tensor, residual: Tensor, level: Tensor | None = None) -> Tensor:
        """Sum of squares of what is left and of what is expected of the parameters, (...); arguments as before."""
        return residual.square().sum((-2, -1)) + self.expectation(shared, residual, level)[0].square().sum(-1)

    def _level(self, residual: Tensor) -> Tensor:
        """Root mean square of what is left, (...), or the noise where that is more; 0 where no noise is known."""
        if not self.noise:
            return residual.new_zeros(residual.shape[:-2])
        told = (residual != 0).sum((-2, -1)).clamp(min=1)  # those beyond the end of a record are 0
        found = (residual.square().sum((-2, -1)) / told).sqrt().clamp(min=self.noise)
        return found.nan_to_num(self.noise, self.noise)  # of a start that runs away

    def predict(self, shared: Tensor, states: Tensor, horizon: float | None = None) -> Tensor:
        """Predicted responses (points, records, samples) at coordinates (points, n), (points, records, local).

        Args:
            shared: Of the shared parameters; those that are left out at the end are 0.
            states: Of the initial states.
            horizon: Seconds of every record that are predicted; all where absent.
        """
        samples, points = self.response.samples_within(horizon), shared.shape[0]
        values = self.unknowns.by_record(self.unknowns.completed(shared))
        found = shared.new_zeros(points, len(self.records), len(self.response.channels), samples)
        for rows in self._alike:
            rate = self.records[rows[0]].sampling_rate
            own = max(len(self.records[i].response) for i in rows)
            count = min(own, samples, max(2, round(horizon * rate)) if horizon else own)
            start = states[:, rows] * self.scales[rows]
            runs = self._simulated(values, start, rows, count)
            self.response.show(found, runs, values, start[..., 2 + len(self.extra) :], rows)
        return found.flatten(-2)

    def motion(self, shared: Tensor, states: Tensor) -> list[Tensor]:
        """Displacement and velocity of every record at one point, (2, time).

        Args:
            shared: Coordinates of the shared parameters, (n_shared,).
            states: Initial states, (records, local).
        """
        values = self.unknowns.by_record(shared.unsqueeze(0))
        found: list[Tensor] = [torch.empty(0)] * len(self.records)
        for rows in self._alike:
            count = max(len(self.records[i].response) for i in rows)
            runs = self._simulated(values, states[None, rows] * self.scales[rows], rows, count)
            path = torch.stack([runs.states["displacement"], runs.states["velocity"]], 1)
            for place, row in enumerate(rows):
                found[row] = path[place, :, : len(self.records[row].response)]
        return found

    def _simulated(self, values: Mapping[str, Tensor], start: Tensor, rows: list[int], samples: int) -> Runs:
        """Every point and record of these rows as members of one batch, from states (points, rows, local) in SI."""
        records = [self.records[i] for i in rows]
        start = start.flatten(0, 1)
        chosen = self._chosen(values, rows, len(start))
        chosen["initial_displacement"], chosen["initial_velocity"] = start[:, 0], start[:, 1]
        return simulate(
            self.model,
            chosen,
            sampling_rate=records[0].sampling_rate,
            n_samples=samples,
            inputs=Driven(
                self._inputs(tuple(rows), samples),
                records[0].held,
                {name: start[:, 2 + i] for i, name in enumerate(self.extra)},
            ),
            solver=self.solver,
        )

    def _chosen(self, values: Mapping[str, Tensor], rows: list[int], batch: int) -> dict[str, Tensor]:
        """Parameters of a batch: what is given, then conditions of its records, then unknowns (points, records)."""
        records, points = [self.records[i] for i in rows], batch // len(rows)
        chosen = self.model.values(batch, **self.given)
        for name in {name for record in records for name in record.conditions if is_of_simulator(name)}:
            known = torch.tensor([r.conditions.get(name, torch.nan) for r in records], dtype=torch.float64)
            _place(chosen, name, known.repeat(points))
        for name, value in values.items():
            if is_of_simulator(name):
                _place(chosen, name, value[:, rows].reshape(-1))
        begins = torch.tensor([record.begins for record in records], dtype=torch.float64).repeat(points)
        return chosen | self.model.system.begun_later(chosen, begins)

    def _inputs(self, rows: tuple[int, ...], samples: int) -> dict[str, Tensor]:
        """Input series of some records at one length, made once."""
        if (rows, samples) not in self._padded_inputs:
            records = [self.records[i] for i in rows]
            names = records[0].inputs
            found = {n: torch.stack([continued(r.inputs[n], samples) for r in records]) for n in names}
            self._padded_inputs[rows, samples] = found
        return self._padded_inputs[rows, samples]

    def residuals(self, shared: Tensor, states: Tensor, horizon: float | None = None) -> Tensor:
        """Weighted residuals (starts, records, samples) at coordinates; arguments as for `predict`."""
        return self.response.left(self.predict(shared, states, horizon), horizon)

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
        shared, starts = self.unknowns.completed(shared), len(shared)
        steps, moved = self.unknowns.steps(only, len(self.local))
        if residual is None:
            steps = torch.cat([torch.zeros_like(steps[:1]), steps])
        at = (shared.unsqueeze(1) + steps[:, : self.n_shared]).flatten(0, 1)
        initial = (states.unsqueeze(1) + steps[:, None, self.n_shared :]).flatten(0, 1)
        left = self.residuals(at, initial, horizon).unflatten(0, (starts, -1))
        if residual is None:
            residual, left = left[:, 0], left[:, 1:]
        slopes = (residual.unsqueeze(1) - left) / DIFFERENCE
        reach = self.unknowns.reach[:, None]
        columns = [slopes[:, row, :, :, None] * reach[..., moved[row]] for row in range(len(moved))]
        columns.append(slopes[:, len(moved) :].permute(0, 2, 3, 1))
        sensitivity = residual.new_zeros(*residual.shape, steps.shape[1])
        places = [c for cs in moved for c in cs] + list(range(self.n_shared, steps.shape[1]))
        sensitivity[..., places] = torch.cat(columns, -1)
        return Prediction(residual, sensitivity, len(self.response.channels), self.held_level(residual))


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
    known = [(model, {k: v for k, v in given.items() if is_of_simulator(k)}) for model, given in models]
    prepare_kernels([Planned(model, model.values(1, **g), names) for model, g in known for names in driven], solver)


def error_amplification(prediction: Prediction, n_shared: int) -> float:
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


def _offset_of(record: FitRecord, channel: str) -> str:
    """The name of the unknown zero of a channel."""
    return f"{OFFSET}.{channel}{SEPARATOR}{record.record}"


def _place(values: dict[str, Tensor], name: str, value: Tensor) -> None:
    """As `set_value`, but for members without a value."""
    flat, _, index = name.partition("[")
    old = values[flat][int(index.rstrip("]"))] if index else values[flat]
    set_value(values, name, torch.where(value.isnan(), old, value))
