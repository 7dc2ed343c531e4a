"""What a fit moves beside the states at the start of its records: parameters, and what single records have of them."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import torch
from torch import Tensor

from gear_damping.identification.output_error.records import DIFFERENCE, SEPARATOR, FitRecord, FreeParameter

OFFSET, GAIN = "offset", "gain"  # `offset.velocity@run_1`, `gain.velocity`: of a channel, unknown to the model


class Unknowns:
    """The shared coordinates of a fit, in order.

    First those of the free parameters, then gains of channels, then what single records have of their own (a phase, an
    offset), each of which moves but its record, in all its segments.
    """

    def __init__(
        self,
        free: Sequence[FreeParameter],
        records: Sequence[FitRecord],
        known_gains: Collection[str] = (),
        offsets: Sequence[FreeParameter] = (),
    ) -> None:
        """Put them in order.

        Args:
            free: Parameters to fit; those with `per_record` become one for each record.
            records: What is fitted, segments of one record side by side.
            known_gains: Gains of channels (`gain.velocity`) that are not fitted, however uncertain they are.
            offsets: Of channels, one for each record that has one.
        """
        self._records = records
        firsts = first_segments(records)
        common = [parameter for parameter in free if not parameter.per_record]
        own = [_own(template, record) for template in free if template.per_record for record in firsts]
        own += [_own(template, record) for record in firsts for template in record.own]
        gains = _gains(records, {parameter.name for parameter in common} | set(known_gains))
        self.free = [*common, *gains, *own, *offsets]
        self.n_free = len(common)
        self.n_common = len([parameter for parameter in self.free if SEPARATOR not in parameter.name])
        self.logarithmic = torch.tensor([parameter.logarithmic for parameter in self.free], dtype=torch.bool)
        self.bounds = torch.tensor([p.range for p in self.free], dtype=torch.float64).reshape(-1, 2).unbind(1)

    def __len__(self) -> int:
        """Number of coordinates."""
        return len(self.free)

    def own_of(self, other: "Unknowns", shared: Tensor) -> Tensor:
        """Coordinates here of gains and of what single records have of their own, as another fit found them.

        Args:
            other: Its unknowns.
            shared: Its coordinates, (len(other),).

        Returns:
            (len(self),), 0 for the free parameters.
        """
        known = {p.name: float(p.value(shared[i])) for i, p in enumerate(other.free[other.n_free :], other.n_free)}
        values = [p.coordinate(known[p.name]) if p.name in known else 0.0 for p in self.free[self.n_free :]]
        return torch.tensor([0.0] * self.n_free + values, dtype=torch.float64)

    def completed(self, shared: Tensor) -> Tensor:
        """Coordinates of the free parameters (..., any number of the first) with zeros for the others."""
        missing = len(self) - shared.shape[-1]
        return torch.nn.functional.pad(shared, (0, missing)) if missing else shared

    def coordinates(self, values: Mapping[str, float]) -> Tensor:
        """Coordinates (len(self),) of values by name, 0 for those that have none."""
        found = [p.coordinate(values[p.name]) if p.name in values else 0.0 for p in self.free]
        return torch.tensor(found, dtype=torch.float64)

    def parameters(self, shared: Tensor) -> dict[str, Tensor]:
        """Values by name from coordinates (..., any number of the first)."""
        return {p.name: p.value(shared[..., i]) for i, p in enumerate(self.free[: shared.shape[-1]])}

    def by_record(self, shared: Tensor) -> dict[str, Tensor]:
        """Values by name, (points, records); nan where a record has none of its own.

        Args:
            shared: Coordinates, (points, len(self)).
        """
        found: dict[str, Tensor] = {}
        for name, value in self.parameters(shared).items():
            base, _, record = name.partition(SEPARATOR)
            if not record:
                found[base] = value.unsqueeze(1).repeat(1, len(self._records))
                continue
            if base not in found:
                found[base] = shared.new_full((len(shared), len(self._records)), torch.nan)
            found[base][:, segments_of(self._records, record)] = value.unsqueeze(1)
        return found

    def expectation(self, shared: Tensor, noise: Tensor) -> tuple[Tensor, Tensor]:
        """Residuals of what is expected of the parameters, and their slopes, both (..., len(self)).

        Args:
            shared: Coordinates, (..., len(self)).
            noise: Standard deviation against which expectations are weighed, (..., 1).
        """
        start, slope = torch.tensor([p.surprise for p in self.free], dtype=torch.float64).reshape(-1, 2).unbind(1)
        return -noise * (start + slope * shared), noise * slope

    def within(self, shared: Tensor) -> Tensor:
        """Coordinates (..., len(self)) within their bounds."""
        return shared.clamp(*self.bounds)

    def at_bound(self, shared: Tensor) -> Tensor:
        """-1 where a coordinate (..., len(self)) is at its lower bound, 1 at its upper one, 0 between."""
        low, high = self.bounds
        return (shared >= high).long() - (shared <= low).long()

    def moved_together(self, only: Collection[int] | None = None) -> list[list[int]]:
        """Coordinates that one simulation moves: those of single records that bear the same name.

        Args:
            only: Coordinates of which at least one shall be among them; any where absent.
        """
        groups = self._groups.values()
        return [group for group in groups if only is None or not {*group}.isdisjoint(only)]

    @cached_property
    def _groups(self) -> Mapping[str, list[int]]:
        groups: dict[str, list[int]] = {}
        for i, parameter in enumerate(self.free):
            groups.setdefault(parameter.name.partition(SEPARATOR)[0], []).append(i)
        return groups

    @cached_property
    def reach(self) -> Tensor:
        """1 where a coordinate moves a record, (records, len(self))."""
        reach = torch.ones(len(self._records), len(self), dtype=torch.float64)
        for place, parameter in enumerate(self.free):
            own = parameter.name.partition(SEPARATOR)[2]
            if own:
                reach[:, place] = torch.tensor([float(one.record == own) for one in self._records])
        return reach

    def steps(self, only: Collection[int] | None, n_local: int) -> tuple[Tensor, list[list[int]]]:
        """Moves whose differences give the sensitivities.

        Args:
            only: Coordinates that are moved; all where absent. Initial states always are.
            n_local: Initial states of every record.

        Returns:
            (moves, len(self) + n_local), and the coordinates that each of the first moves moves.
        """
        moved = self.moved_together(only)
        steps = torch.zeros(len(moved) + n_local, len(self) + n_local, dtype=torch.float64)
        for row, columns in enumerate([*moved, *([len(self) + i] for i in range(n_local))]):
            steps[row, columns] = DIFFERENCE
        return steps, moved


def first_segments(records: Sequence[FitRecord]) -> list[FitRecord]:
    """The first segment of every record."""
    return list({record.record: record for record in reversed(records)}.values())[::-1]


def segments_of(records: Sequence[FitRecord], name: str) -> list[int]:
    """Places of the segments of one record."""
    return [i for i, one in enumerate(records) if one.record == name]


def is_of_simulator(name: str) -> bool:
    """Whether a parameter is one of the simulator, in every record or in one, and not one of a channel."""
    return name.partition(".")[0] not in (OFFSET, GAIN)


def is_of_model(name: str) -> bool:
    """Whether a fitted value is a parameter of the simulator, and not of a channel or of a single record."""
    return is_of_simulator(name) and SEPARATOR not in name


def _own(template: FreeParameter, record: FitRecord) -> FreeParameter:
    """What a record has of its own, beginning at what is known of it."""
    start = record.conditions.get(template.name, template.start)
    return replace(template, name=f"{template.name}{SEPARATOR}{record.record}", start=start, per_record=False)


def _gains(records: Sequence[FitRecord], settled: Collection[str]) -> list[FreeParameter]:
    """Gains of channels that are known with an uncertainty only."""
    uncertain: dict[str, float] = {}
    for channel in (channel for record in records for channel in record.channels):
        uncertain[channel.name] = max(channel.gain_uncertainty, uncertain.get(channel.name, 0.0))
    return [
        FreeParameter(f"{GAIN}.{name}", 1.0, logarithmic=True, deviation=relative)
        for name, relative in uncertain.items()
        if relative and f"{GAIN}.{name}" not in settled
    ]
