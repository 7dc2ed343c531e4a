"""A column of a bare file of data: its values, and what they look like."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError
from gear_damping.measurement.column_kinds import (
    CONSTANT,
    EDGES,
    ELSEWHERE,
    EMPTY,
    ROW_NUMBER,
    SIGNAL,
    TIME,
    TURNING,
    UNREADABLE,
    kind_of,
    may_be_edges,
    turn_of,
)
from gear_damping.measurement.formats.table import Table
from gear_damping.measurement.recordings import past_overflow
from gear_damping.measurement.resolution import step_of
from gear_damping.measurement.rows import LEAST_SAMPLES
from gear_damping.measurement.spectral_floor import Spectrum, spectrum_of
from gear_damping.measurement.time_column import ENDINGS, Stamps, counts_from_1970, named_clock
from gear_damping.measurement.timebase import TimeBase
from gear_damping.units import to_si

_EVEN = 1e-6  # of an advance from sample to sample: differences below it are rounding
_ANY_SIGNAL = re.compile(r"^(values?|data|signal|[xyzt]|time\w*)$", re.I)  # a name that tells no record from a channel
_CERAMIC = 0.01  # by which the clock of a small board may be fast or slow: its resonator is good to half of that


@dataclass(frozen=True, eq=False)
class Column:
    """A column of a file and what it looks like.

    Args:
        reference: What a measurement.yaml calls it: its name, or its index where it has none of its own.
        values: (n,) all of it.
        finite: (first, stop) of its longest stretch of finite values.
        unit: The unit that the file gives, or None.
        kind: One of those of `column_kinds`.
        says: What that was seen by, for people.
        step: The quantisation step, 0.0 where none was seen.
        spectrum: Of a signal with a constant rate; in cycles a sample where no rate is known.
        rate: Its own samples a second, or None.
        stamps: What it is as the time stamps of columns beside it; None of all but further clocks.
    """

    reference: str | int
    values: NDArray[np.float64]
    finite: tuple[int, int]
    unit: str | None
    kind: str = SIGNAL
    says: str = ""
    step: float = 0.0
    spectrum: Spectrum | None = None
    rate: float | None = None
    stamps: Stamps | None = None

    @property
    def inside(self) -> NDArray[np.float64]:
        """The longest stretch of finite values."""
        return self.values[self.finite[0] : self.finite[1]]

    @property
    def deviation(self) -> float:
        """The standard deviation about the line through the values."""
        values = self.inside
        place = np.linspace(-1.0, 1.0, values.size)
        centred = values - values.mean() if values.size else values
        return float(np.std(centred - place * (centred @ place) / (place @ place))) if values.size > 1 else 0.0


def column_of(table: Table, index: int) -> Column:
    """A column of a file as it is read, nothing of it looked at; one that cannot be read says why."""
    name = table.names[index]
    reference = name if name and table.names.count(name) == 1 else index
    try:
        values = table.values(index)
    except InputError as error:
        return Column(reference, np.empty(0), (0, 0), None, UNREADABLE, error.problems[0].rule)
    return Column(reference, values, longest_finite(values), table.unit(index))


def of_one_group(columns: list[Column]) -> list[Column]:
    """The columns, of groups with members of the same names (`run1/acc`, `run2/acc`) those of the first alone."""
    groups: dict[str, list[str]] = {}
    for column in columns:
        group, stroke, member = str(column.reference).rpartition("/")
        if stroke and not isinstance(column.reference, int):
            groups.setdefault(group, []).append(member)
    first = next(iter(groups), "")
    own = {member for member in groups.get(first, ()) if not _ANY_SIGNAL.search(member)}
    others = [group for group in groups if group != first and own & {*groups[group]}]
    if not others or sum(map(len, groups.values())) < len(columns):
        return columns
    nothing = {"values": np.empty(0), "finite": (0, 0), "kind": ELSEWHERE, "says": f"as that of '{first}'"}
    return [replace(c, **nothing) if str(c.reference).rpartition("/")[0] in others else c for c in columns]


def longest_finite(values: NDArray[np.float64]) -> tuple[int, int]:
    """First row and end of the longest stretch of finite values."""
    edges = np.flatnonzero(np.diff(np.r_[False, np.isfinite(values), False]))
    starts, stops = edges[::2], edges[1::2]
    if not starts.size:
        return 0, 0
    longest = int(np.argmax(stops - starts))
    return int(starts[longest]), int(stops[longest])


def seen_as(
    column: Column,
    stamps: Stamps | None,
    columns: Sequence[Column],
    base: TimeBase | None,
    length: int,
    clock: tuple[float, float] | None,
) -> Column:
    """A column with what it looks like beside the others of its file.

    Args:
        column: As it is read.
        stamps: The time stamps of the file, if it has any.
        columns: All of the file.
        base: The time of its rows, where it is known.
        length: The rows of a record.
        clock: (start, rate) that the file gives of this column alone, s and Hz.
    """
    if stamps is not None and column is columns[stamps.index]:
        return replace(column, kind=TIME, says=stamps.says)
    if column.kind in (UNREADABLE, ELSEWHERE):
        return column
    if stamps is not None and np.array_equal(column.values, columns[stamps.index].values, equal_nan=True):
        return replace(column, kind=TIME, says=f"the same as '{columns[stamps.index].reference}'")
    kind, says = kind_of(column.inside, str(column.reference), column.unit)
    if kind in (CONSTANT, EMPTY, ROW_NUMBER):
        return replace(column, kind=kind, says=says)
    if stamps is not None and (unit := _counts_time(column, columns[stamps.index], stamps)):
        return replace(column, kind=TIME, says=f"goes on with the time stamps, in {unit}: another clock")
    if stamps is not None and counts_from_1970(column.inside):
        return replace(column, kind=TIME, says="advances, and may be counted from 1970: another clock")
    if stamps is not None and (other := named_clock(column)):
        return replace(column, kind=TIME, says=f"{other.says}: another clock", stamps=other)
    if column.values.size != length and _is_alone(column, columns) and may_be_edges(column.inside):
        return replace(column, kind=EDGES, says="rise at each: perhaps the times at which a shaft's pulses begin")
    own = clock[1] if clock else None
    rate = base.sampling_rate if base is not None and column.values.size == length else own
    seen = replace(column, kind=kind, says=says, rate=rate)
    whole = whole_of(seen)
    return replace(seen, step=_step_of(whole), spectrum=spectrum_of(whole, rate or 1.0))


def _is_alone(column: Column, columns: Sequence[Column]) -> bool:
    """Whether no other column has its length, and its unit is one of stamps, if it has any."""
    return column.unit in (None, *ENDINGS) and sum(one.values.size == column.values.size for one in columns) == 1


def _counts_time(column: Column, clock: Column, stamps: Stamps) -> str | None:
    """The unit in which whole numbers without a name go on as stamps beside them do, as `micros()`; None of others."""
    values = past_overflow(column.inside)
    if isinstance(column.reference, str) or column.finite != clock.finite or values.size < LEAST_SAMPLES:
        return None
    if np.any(values != np.round(values)) or np.any(np.diff(values) < 0):
        return None
    lasts = np.ptp(clock.inside) * stamps.in_seconds
    return next(
        (unit for unit in ENDINGS[1:] if abs(np.ptp(values) * to_si(1, unit, "s") / lasts - 1) < _CERAMIC), None
    )


def whole_of(column: Column) -> NDArray[np.float64]:
    """The longest stretch of a column, of an angle that falls back once a turn unwrapped."""
    turn = turn_of(column.inside) if column.kind == TURNING else None
    return column.inside if turn is None else np.unwrap(column.inside, period=turn)


def _step_of(values: NDArray[np.float64]) -> float:
    """The quantisation step; of values that go on with every sample that of their advance, which is their speed."""
    advance = np.diff(values)
    is_ramp = advance.size and np.ptp(advance) <= _EVEN * np.abs(advance).max()
    goes_on = advance.size and (advance.min() > 0 or advance.max() < 0)
    return 0.0 if is_ramp else step_of(advance if goes_on else values)
