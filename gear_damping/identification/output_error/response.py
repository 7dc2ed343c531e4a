"""The response channels of several records: what was measured, and what a simulated motion would have shown there."""

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

import torch
from torch import Tensor

from gear_damping.identification.output_error.observe import filter_modes, interpolation, recorded
from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.identification.output_error.unknowns import GAIN, OFFSET
from gear_damping.physics.model import Model
from gear_damping.physics.terms import Sensor
from gear_damping.simulation.runs import Runs

Values = Callable[[FitRecord, Observed, Tensor], Tensor]
Places = tuple[Tensor, Tensor] | None


class Response:
    """What the channels of records show, side by side: channels one after another, zeros beyond a record's end."""

    def __init__(self, model: Model, records: Sequence[FitRecord], gains: Mapping[str, float]) -> None:
        """Stack the records.

        Args:
            model: The simulator, whose sensor effects act on the first channel.
            records: At least one; they may differ in rate, length and channels.
            gains: Known gains of channels, by `gain.<channel>`.
        """
        self._records, self._gains = records, gains
        self._sensors = [e for e in model.effects if isinstance(e, Sensor) and e.start_modes]
        self.channels = tuple(dict.fromkeys(c.name for record in records for c in record.channels))
        self.length = max(len(record.response) for record in records)
        self.values, self.weights = self._stacked(_values), self._stacked(_weights)

    def _stacked(self, of: Values) -> Tensor:
        """(records, channels * time): what `of` gives of every channel that a record has, zeros elsewhere."""
        found = torch.zeros(len(self._records), len(self.channels), self.length, dtype=torch.float64)
        for i, record in enumerate(self._records):
            for channel, values in ((record.observed, record.response), *record.others):
                found[i, self.channels.index(channel.name), : len(values)] = of(record, channel, values)
        return found.flatten(1)

    @cached_property
    def modes(self) -> tuple[str, ...]:
        """States of sensors at the start: of the model's on the first channel, then of declared filters by channel."""
        names = [f"{sensor.name}.start[{i}]" for sensor in self._sensors for i in range(sensor.start_modes)]
        orders: dict[str, int] = {}
        for record in self._records:
            for channel in record.channels:
                orders[channel.name] = max(orders.get(channel.name, 0), sum(f.order for f in channel.filters))
        return (*names, *(f"{channel}.filter[{i}]" for channel, count in orders.items() for i in range(count)))

    @cached_property
    def _places(self) -> dict[int, list[Places]]:
        """By record, how the samples of each channel lie between those of the grid; None where they are on it."""
        found = {}
        for i, record in enumerate(self._records):
            at = record.instants
            late = [at - c.delay * record.sampling_rate for c in record.channels]
            even = record.stamps is None
            found[i] = [
                None if even and not c.delay else interpolation(positions, len(at))
                for c, positions in zip(record.channels, late, strict=True)
            ]
        return found

    def show(self, found: Tensor, runs: Runs, values: Mapping[str, Tensor], modes: Tensor, rows: Sequence[int]) -> None:
        """Fill in what the channels of some records show.

        Args:
            found: Where it goes, (points, records, channels, time); of all records.
            runs: Every point and row as members of one batch.
            values: Of the unknowns by name, (points, records).
            modes: States of the sensors at the start, (points, rows, len(self.modes)).
            rows: The records, alike in their channels.
        """
        (points, n_rows), samples = modes.shape[:2], len(runs.time)
        begins = torch.tensor([self._records[i].begins for i in rows], dtype=torch.float64).repeat(points)
        for number, channel in enumerate(self._records[rows[0]].channels):
            shown = recorded(runs, channel, number == 0, begins).reshape(points, n_rows, samples)
            shown = shown + self._left_of_start(runs, channel, modes, number == 0)
            shown = _between(shown, [self._places[i][number] for i in rows])
            gain = values.get(f"{GAIN}.{channel.name}")
            shown = shown * (self._gains.get(f"{GAIN}.{channel.name}", 1.0) if gain is None else gain[:, rows, None])
            if (offset := values.get(f"{OFFSET}.{channel.name}")) is not None:
                shown = shown + offset[:, rows].nan_to_num(0.0).unsqueeze(-1)
            if channel.slow:
                shown = shown + self._slow_change(channel, values, rows, runs.time)
            scale = shown.new_tensor([self._records[i].channels[number].scale for i in rows]).unsqueeze(1)
            found[:, rows, self.channels.index(channel.name), :samples] = shown * scale

    def _slow_change(
        self, channel: Observed, values: Mapping[str, Tensor], rows: Sequence[int], time: Tensor
    ) -> Tensor:
        """What changes slowly in a channel, (points, records, time)."""
        shapes = channel.slow.shapes(torch.stack([_instants(self._records[i], time) for i in rows]))
        sizes = [values[f"{OFFSET}.{channel.name}[{k + 1}]"][:, rows] for k in range(channel.slow.terms)]
        return torch.einsum("kpr,krt->prt", torch.stack(sizes), shapes)

    def _left_of_start(self, runs: Runs, channel: Observed, modes: Tensor, first: bool) -> Tensor | float:
        """What the states of the sensors at the start leave in a channel, (points, records, time)."""
        parts, total = [], 0.0
        for sensor in self._sensors if first else ():
            own = {p.name: runs.values[f"{sensor.name}.{p.name}"] for p in sensor.parameters}
            shape = (sensor.start_modes, *modes.shape[:2], len(runs.time))
            parts.append((f"{sensor.name}.start", sensor.left_of_start(own, runs.time).reshape(shape)))
        if channel.filters:
            shapes = filter_modes(channel.filters, runs.sampling_rate, len(runs.time))
            parts.append((f"{channel.name}.filter", shapes[:, None, None]))
        for name, shapes in parts:
            for i, shape in enumerate(shapes):
                total = total + modes[..., self.modes.index(f"{name}[{i}]"), None] * shape
        return total

    def samples_within(self, horizon: float | None) -> int:
        """Samples of the longest record within so many seconds, or all of them."""
        if horizon is None:
            return self.length
        fastest = max(record.sampling_rate for record in self._records)
        return min(self.length, max(2, round(horizon * fastest)))

    def left(self, shown: Tensor, horizon: float | None) -> Tensor:
        """Weighted residuals (points, records, channels * samples) beside what was predicted within a horizon."""
        samples = self.samples_within(horizon)
        return (self._cut(self.values, samples) - shown) * self.cut(self.weights, horizon)

    def cut(self, weighted: Tensor, horizon: float | None) -> Tensor:
        """Weighted samples (..., records, channels * time) within a horizon, 0 beyond it."""
        samples = self.samples_within(horizon)
        return self._cut(weighted, samples) * self._beyond(horizon, samples)

    def _cut(self, stacked: Tensor, samples: int) -> Tensor:
        """(..., records, channels * time) cut to the first samples of every channel."""
        return stacked.unflatten(-1, (len(self.channels), -1))[..., :samples].flatten(-2)

    def _beyond(self, horizon: float | None, samples: int) -> Tensor | float:
        """1 within the horizon and 0 beyond it, (records, channels * samples), where rates differ."""
        if horizon is None or len({record.sampling_rate for record in self._records}) == 1:
            return 1.0
        limit = torch.tensor([round(horizon * record.sampling_rate) for record in self._records])
        return (torch.arange(samples) < limit.unsqueeze(1)).double().repeat(1, len(self.channels))


def _values(record: FitRecord, channel: Observed, values: Tensor) -> Tensor:
    return values * channel.scale


def _weights(record: FitRecord, channel: Observed, values: Tensor) -> Tensor:
    """What the record counts; nothing of what a late channel shows from before its beginning."""
    late = channel.delay * record.sampling_rate
    return record.weight * ((record.instants >= late) & (record.instants - late <= len(values) - 1)).double()


def _between(shown: Tensor, places: Sequence[Places]) -> Tensor:
    """Samples (points, records, time) at the instants at which each record was taken."""
    if all(place is None for place in places):
        return shown
    found, samples = shown.clone(), shown.shape[-1]
    for i, place in enumerate(places):
        if place is not None:
            inside = place[0].clamp(max=samples - 1)[:samples]
            found[:, i, : len(inside)] = (shown[:, i][:, inside] * place[1][:samples]).sum(-1)
    return found


def _instants(record: FitRecord, time: Tensor) -> Tensor:
    """Of a record's samples from the beginning of the whole record in s, the last one repeated to (time,)."""
    if record.stamps is None:
        return record.begins + time
    own = record.begins + record.stamps / record.sampling_rate
    return torch.cat([own, own[-1:].expand(max(0, len(time) - len(own)))])[: len(time)]
