"""Which rows of its file a record holds: those of its slice or window, without blank, repeated and foreign ones."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError
from gear_damping.measurement.formats.table import Table
from gear_damping.measurement.record import Finding
from gear_damping.measurement.timebase import written_significantly

Array = NDArray[np.float64]
Column = str | int
LEAST_SAMPLES = 8  # of a record, for a spectrum at all
MOST_DOUBLED = 0.01  # of the rows of a record; where more come twice, something else is wrong
DOUBLED_WITHIN = 100  # rows behind the one that a row is stored again of
MOST_MISSING = 0.01  # of a record: a sheet whose last cells are blank, and no channel of another rate


@dataclass(frozen=True)
class Rows:
    """The rows of a record within its file.

    Args:
        first: The first row.
        stop: The row behind the last.
        blank: Rows behind them that hold nothing.
        doubled: Rows that hold what an earlier one does, and no later stamp.
        filled: Rows of the record in which its slower channels have values.
        foreign: Rows of other signals, in a table of signals by turns.
    """

    first: int = 0
    stop: int = 0
    blank: int = 0
    doubled: tuple[int, ...] = ()
    filled: slice | None = None
    foreign: tuple[int, ...] = ()

    @property
    def count(self) -> int:
        """Rows from the first to the last, whatever they hold."""
        return self.stop - self.first

    @property
    def whole(self) -> "Rows":
        """The same with the rows between filled ones."""
        return replace(self, filled=None)

    @property
    def step(self) -> int:
        """Rows of the file from one sample of the record to the next."""
        return self.filled.step if self.filled else 1

    def of(self, values: Array) -> Array:
        """(n,) the values of a column between the first row and the last, all of them or the filled ones."""
        values = values[self.first : self.stop]
        return values[self.filled] if self.filled else values

    def places(self, rows: Sequence[int]) -> NDArray[np.int_]:
        """Where rows of the file stand among those of the record."""
        return np.array(rows, int) - self.first

    def said(self) -> tuple[Finding, ...]:
        """Notes of the rows that are left out."""
        found = {}
        if self.blank:
            message = f"the last {self.blank} rows hold nothing in the columns of the record, which ends before them"
            found["blank_rows"] = message
        if self.filled:
            message = f"the record holds one row in {self.step}, those in which its slower channels have values"
            found["filled_rows"] = message
        if self.foreign:
            message = f"{len(self.foreign)} rows hold nothing in the columns of the record, as where signals speak by "
            found["foreign_rows"] = f"{message}turns; they are left out, and samples are taken at their stamps"
        if self.doubled:
            message = f"{len(self.doubled)} row(s) hold the values of an earlier one where stamps do not go on, the "
            found["doubled_rows"] = f"{message}first row {self.doubled[0]} of the file; they are left out"
        return tuple(Finding(name, message, severity="note") for name, message in found.items())


@dataclass(frozen=True, eq=False)
class Columns:
    """The columns of one record in its table.

    Args:
        table: What the file holds.
        time: The column of stamps, if the record has one.
        shared: The columns of channels and encoders that share the record's time.
        time_key: The key that names the column of stamps.
    """

    table: Table
    time: Column | None
    shared: Sequence[Column]
    time_key: str

    def all(self, column: Column, key: str = "") -> Array:
        """(n,) values of a column, whatever rows are used; `key` is named where there is no such column."""
        return self.table.values(self.table.index(column, key))

    def size(self, column: Column) -> int | None:
        """The length of a column; None where it cannot be read, which its channel will say."""
        try:
            return self.all(column).size
        except InputError:
            return None

    def blank_at_the_end(self, columns: Sequence[Column], n: int) -> int:
        """How many of the last of n rows hold nothing in any column: those of a longer run beside this one.

        A few in which the stamps, the first of the columns where there are any, alone go on count too.
        """
        sound = (self.all(column) if self.size(column) is not None else np.zeros(0) for column in columns)
        filled = [last_number(values[:n]) for values in sound]
        last = max(filled)
        own = max(filled[1:], default=last) if self.time is not None else last
        last = own if last - own <= MOST_MISSING * last else last
        return n - last if last else 0

    def without(self, rows: Rows) -> Rows:
        """The rows, with those among them that are told apart: doubled, else filled, else foreign ones."""
        if doubled := self._doubled(rows):
            return replace(rows, doubled=doubled)
        if filled := self._filled(rows):
            return replace(rows, filled=filled)
        return replace(rows, foreign=self._foreign(rows))

    def _covering(self, rows: Rows) -> list[Column]:
        """The shared columns that can be read; none where one of them ends before the record."""
        sizes = {column: size for column in self.shared if (size := self.size(column)) is not None}
        return [] if any(size < rows.stop for size in sizes.values()) else list(sizes)

    def _doubled(self, rows: Rows) -> tuple[int, ...]:
        """Rows with the values of an earlier one where stamps do not go on: a recorder has stored that again.

        It is the row of such a stamp or the one before it. None where that does not mend all of them.
        """
        if self.time is None:
            return ()
        stamps = rows.of(self.all(self.time, self.time_key))
        late = np.flatnonzero(np.diff(stamps) <= 0) + 1 + rows.first
        columns = self._covering(rows) if late.size else []
        if not columns:
            return ()
        values = np.stack([self.all(one)[: rows.stop] for one in columns], 1)
        if _is_each_row_stored_again(stamps, values[rows.first :]):
            return tuple(late.tolist())
        if late.size > MOST_DOUBLED * stamps.size or written_significantly(stamps) is not None:
            return ()

        def is_again(k: int) -> bool:
            """Whether a row holds the values of one before it."""
            return bool(np.any(np.all(values[max(rows.first, k - DOUBLED_WITHIN) : k] == values[k], 1)))

        again = [next((row for row in (k, k - 1) if is_again(row)), None) for k in late.tolist()]
        kept = np.delete(stamps, [k - rows.first for k in again if k is not None])
        return () if None in again or np.any(np.diff(kept) <= 0) else tuple(sorted({*again}))

    def _filled(self, rows: Rows) -> slice | None:
        """Every k-th row, where slower channels have blank cells in all others; None where none has, or they differ."""
        found = set()
        for column in self.shared:
            with suppress(InputError):  # which its channel will say
                found.add(filled_in(rows.of(self.all(column))))
        found -= {None}
        return slice(*found.pop()) if len(found) == 1 else None

    def _foreign(self, rows: Rows) -> tuple[int, ...]:
        """Rows with a stamp in which other columns hold something and those of the record nothing: signals by turns."""
        columns = self._covering(rows)
        if self.time is None or not columns:
            return ()
        own, within = {self.table.index(one, "") for one in columns}, set(range(rows.first, rows.stop))
        foreign = within.intersection(*(self._empty_cells(place) for place in own))
        if not foreign:
            return ()
        own.add(self.table.index(self.time, ""))
        others = (set(self._empty_cells(place)) for place in range(len(self.table.names)) if place not in own)
        spoken = set().union(*(within - empty for empty in others if empty))
        return tuple(sorted(foreign)) if foreign == spoken else ()

    def _empty_cells(self, place: int) -> list[int]:
        with suppress(InputError):  # a column of texts
            self.table.values(place)
        return self.table.empty_cells(place)

    def sound_beside(self, rows: Rows, most: int) -> tuple[int, int]:
        """How many rows before and behind the record hold numbers in all of its columns, at most so many each.

        None where there are no such columns: stamps of pulses alone end with the record.
        """
        before = behind = most if self.shared else 0
        for column in self.shared:
            with suppress(InputError):  # which its channel will say
                values = np.isfinite(self.all(column))
                before = min(before, _leading(values[: rows.first][::-1]))
                behind = min(behind, _leading(values[rows.stop :]))
        return before, behind


def last_number(values: Array) -> int:
    """How many of (n,) values there are up to the last that is a number."""
    places = np.flatnonzero(np.isfinite(values))
    return int(places[-1]) + 1 if places.size else 0


def filled_in(values: Array) -> tuple[int, int, int] | None:
    """First, end and step of the rows that hold numbers, where (n,) values do in every second or later row alone."""
    rows = np.flatnonzero(np.isfinite(values))
    if rows.size < LEAST_SAMPLES:
        return None
    steps = np.diff(rows)
    is_regular = steps[0] > 1 and bool(np.all(steps == steps[0]))
    return (int(rows[0]), int(rows[-1]) + 1, int(steps[0])) if is_regular else None


def _is_each_row_stored_again(stamps: Array, values: NDArray[np.float64]) -> bool:
    """Whether every one of (n,) rows is stored equally often, one behind the other, with all of its (n, k) values."""
    new = np.flatnonzero(np.diff(stamps)) + 1
    times = np.diff(new)
    if times.size < LEAST_SAMPLES or times[0] < 2 or np.any(times != times[0]) or np.any(np.diff(stamps) < 0):
        return False
    is_last_whole = max(new[0], stamps.size - new[-1]) <= times[0]
    again = np.diff(stamps) == 0
    return bool(is_last_whole and np.all((np.diff(values, axis=0) == 0)[again]))


def _leading(true: NDArray[np.bool_]) -> int:
    """How many of (n,) are true before the first that is not."""
    return int(true.size if true.all() else np.argmin(true))
