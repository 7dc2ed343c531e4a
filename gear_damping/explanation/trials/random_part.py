"""The random part of residuals: of a load, of the colour of a sensor, and how it is made white."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import log

import torch
from torch import Tensor

from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.explanation.statistics.bursts import BURST_KURTOSIS, kurtosis
from gear_damping.explanation.statistics.load_error import LoadError
from gear_damping.explanation.statistics.load_noise import MEMORY, LoadNoise
from gear_damping.explanation.statistics.whitening import Autoregression, autoregression
from gear_damping.explanation.trials.innovations import RandomLoad

RANDOM_PART = "raised to the random part of the residuals"
PER_LOAD = 2  # numbers of a load's part: its level and the sensor's


@dataclass(frozen=True)
class Random:
    """The random part of the residuals, by channel and rate.

    Args:
        laws: The autoregression of each group of rows, of what is left beside the random load's part.
        loads: The random load's part of each row; none where its likelihood is no better for it.
        groups: Group of every row and channel of the problem, (rows, channels); -1 where there is nothing.
        variance: Of the random part of the fitted records, in the unit of the first channel, unweighted.
        correlation: Sum of its squared autocorrelations.
        by_record: Variance by record.
        deviance: Minus twice the logarithm of its likelihood, with what its numbers cost.
        sensor: Variance beside what loads add, where these are a part.
        errors: Variance that the known error of a load adds, by record, those that were not fitted among them.
    """

    laws: tuple[Autoregression, ...]
    groups: Tensor
    variance: float
    correlation: float
    by_record: dict[str, float]
    loads: tuple[LoadNoise | LoadError, ...] = ()
    deviance: float = 0.0
    sensor: float = 0.0
    errors: Mapping[str, float] = field(default_factory=dict)

    @property
    def is_coloured(self) -> bool:
        """Whether it is more than white noise."""
        return bool(self.loads) or any(law.order for law in self.laws)

    @property
    def is_white(self) -> bool:
        """Whether it is white, of one level in all channels."""
        return len(self.laws) == 1 and not self.is_coloured

    def joined(self, noise: NoiseLevel) -> NoiseLevel:
        """The noise of every record, where the random part is larger than what was known of it.

        That of a record that was not fitted may be as much more than its own floor as of those that were.
        """
        levels = {name: max(level, self._of(name) ** 0.5) for name, level in noise.by_record.items()}
        if levels == noise.by_record:
            return noise
        if not self.loads and not self.errors and self.by_record.keys() & levels:
            floor = {name: level for name, level in noise.by_record.items() if name in self.by_record}
            known, below = (replace(noise, by_record={n: one[n] for n in floor}) for one in (levels, floor))
            levels |= {n: known.elsewhere(below, own) for n, own in noise.by_record.items() if n not in floor}
        correlation = max(noise.correlation, self.correlation)
        return replace(noise, by_record=levels, correlation=correlation, method=f"{noise.method}; {RANDOM_PART}")

    def _of(self, record: str) -> float:
        """Variance in a record: its own; else of a sensor and what the error of its load adds; else the typical one.

        Where that error is a part of the fitted records their initial states may have taken most of it, so that another
        colour tells as much; records that were not fitted have it all the same.
        """
        if record in self.by_record:
            return self.by_record[record]
        if record not in self.errors:
            return self.variance
        return self.sensor + self.errors[record] if self.loads else max(self.variance, self.errors[record])


def random_part(
    left: Tensor, taken: float, outcome: Outcome, loads_of: Callable[[], list[RandomLoad] | None]
) -> Random:
    """The random part of what is left, everything that has a shape projected out.

    An autoregression of each channel; or, where that tells more (Schwarz 1978), a random load's part of each record
    beside one. A load that comes in bursts, after each of which the motion rings, is no random one but what makes them.

    Args:
        left: (samples,).
        taken: Degrees of freedom that were taken out.
        outcome: The fitted model.
        loads_of: How a random load moves each record; None where that is not known.
    """
    problem = outcome.problem
    groups, count = _grouped(outcome)
    rows = left.reshape(-1, problem.response.length)
    weights = problem.response.weights.reshape(rows.shape)
    total = float((weights > 0).sum())
    regressed = _Regressed(groups.reshape(-1), count, weights > 0, (taken + problem.n_shared) / max(total, 1.0))
    laws, loads = regressed.of(rows), ()
    kept, least = laws, regressed.deviance(laws)
    if any(law.order for law in laws) and (known := loads_of()) is not None:
        parts = [moved.part(row.numpy()) for row, moved in zip(rows, known, strict=True)]
        left_of_it = innovations(rows.unsqueeze(-1), parts).squeeze(-1)
        whitened = regressed.of(left_of_it)
        deviance = sum(part.deviance + PER_LOAD * log(total) for part in parts) + regressed.deviance(whitened)
        if deviance < least and kurtosis(left_of_it[weights > 0].numpy()) < BURST_KURTOSIS:
            kept, loads, least = whitened, tuple(parts), deviance
    scale = total / max(total - taken - problem.n_shared, 1.0)
    correlation = [laws[int(g)].correlation for g in groups.reshape(-1) if g >= 0]
    by_record = _by_record(rows, weights, outcome, scale)
    mean = sum(by_record.values()) / len(by_record)
    sensors = [part.sensor / record.weight**2 for part, record in zip(loads, problem.records, strict=False)]
    sensor = sum(sensors) / max(len(sensors), 1)
    return Random(kept, groups, mean, sum(correlation) / len(correlation), by_record, loads, least, sensor)


@dataclass(frozen=True)
class _Regressed:
    """How rows are pooled to groups that share an autoregression: their group, whether samples count, what was taken
    of each.
    """

    groups: Tensor
    count: int
    counts: Tensor
    taken: float

    def of(self, rows: Tensor) -> tuple[Autoregression, ...]:
        """The autoregression of each group of rows (rows, time)."""
        found = []
        for number in range(self.count):
            places = (self.groups == number).nonzero().flatten().tolist()
            kept = [rows[i][self.counts[i]] for i in places if bool(self.counts[i].any())]
            found.append(autoregression(kept, self.taken * sum(len(row) for row in kept)))
        return tuple(found)

    def deviance(self, laws: Sequence[Autoregression]) -> float:
        """Minus twice the logarithm of their likelihood, with what their coefficients cost.

        Of as many samples of each row as a load's part has innovations of.
        """
        rows = (self.counts.sum(-1) - MEMORY).clamp(min=0)
        samples = [float(rows[self.groups == number].sum()) for number in range(self.count)]
        pairs = zip(laws, samples, strict=True)
        return sum(n * log(max(law.innovation, 1e-300)) + law.order * log(max(n, 2.0)) for law, n in pairs)


def _grouped(outcome: Outcome) -> tuple[Tensor, int]:
    """Group of every record and channel, (records, channels), -1 where there is nothing; and how many there are."""
    problem = outcome.problem
    keys: dict[object, int] = {}
    groups = torch.full((len(problem.records), len(problem.response.channels)), -1)
    for place, record in enumerate(problem.records):
        for channel in record.channels:
            key = (channel.name, round(record.sampling_rate))
            groups[place, problem.response.channels.index(channel.name)] = keys.setdefault(key, len(keys))
    return groups, len(keys)


def _by_record(rows: Tensor, weights: Tensor, outcome: Outcome, scale: float) -> dict[str, float]:
    """Variance of the first channel of each record, unweighted."""
    problem, squares, samples = outcome.problem, {}, {}
    for place, record in enumerate(problem.records):
        row = place * len(problem.response.channels) + problem.response.channels.index(record.observed.name)
        kept, name = rows[row][weights[row] > 0] / record.weight, record.name
        squares[name] = squares.get(name, 0.0) + float(kept.square().sum())
        samples[name] = samples.get(name, 0) + len(kept)
    return {name: scale * squares[name] / max(samples[name], 1) for name in squares}


class Whitener:
    """Applies what is known of the random part to signals in the order of the problem's samples."""

    def __init__(self, random: Random, outcome: Outcome) -> None:
        self.random, self.problem = random, outcome.problem
        weights = self.problem.response.weights.reshape(-1, self.problem.response.length)
        lost = max((law.memory for law in random.laws), default=0) + (MEMORY if random.loads else 0)
        self.used = _valid(weights, lost)

    def __call__(self, signal: Tensor) -> Tensor:
        """`signal` (samples, n) white where its random part is, at the noise of the evidence."""
        rows = self._with_load(signal.reshape(*self.used.shape, -1))
        found = torch.zeros_like(rows)
        for number, law in enumerate(self.random.laws):
            places = (self.random.groups.reshape(-1) == number).nonzero().flatten()
            white = law.whitened_columns(rows[places])
            found[places] = white * self.problem.noise / max(law.innovation, 1e-300) ** 0.5
        return (found * self.used.unsqueeze(-1)).reshape(signal.shape)

    def _with_load(self, rows: Tensor) -> Tensor:
        """Innovations of rows (rows, time, n) where a random load is part of them."""
        if not self.random.loads:
            return rows
        return innovations(rows, self.random.loads)

    def padded(self, signal: Tensor) -> Tensor:
        """The same for a signal that has the residuals of what is expected behind its samples."""
        count = self.problem.response.weights.numel()
        return torch.cat([self(signal[:count]), signal[count:]])


def _valid(weights: Tensor, order: int) -> Tensor:
    """1 where a sample and the `order` before it count, (rows, time)."""
    counts = (weights > 0).double()
    sums = torch.nn.functional.pad(counts, (order + 1, 0)).cumsum(1)
    found = (sums[:, order + 1 :] - sums[:, : -order - 1] > order + 0.5).double()
    found[:, :order] = 0.0
    return found


def innovations(rows: Tensor, loads: Sequence[LoadNoise | LoadError]) -> Tensor:
    """Rows (rows, time, n) with the random load's part made white, of unit variance."""
    found = torch.zeros_like(rows)
    for place, load in enumerate(loads):
        found[place, : load.samples] = torch.as_tensor(load.innovations(rows[place, : load.samples].numpy()))
    return found
