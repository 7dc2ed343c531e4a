"""Reading what a record's plan asks for out of its file, before units are compared."""

from collections.abc import Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.checks import refuse_not_finite
from gear_damping.measurement.cutting import rows_beside, slower, window_rows
from gear_damping.measurement.declaration import ChannelPlan, EncoderPlan, RecordPlan, TimePlan
from gear_damping.measurement.encoders import ReadColumn, ShaftAngle, pulse_times, shaft_angle
from gear_damping.measurement.file_clocks import FileClocks, conflict_with_file
from gear_damping.measurement.formats.table import Table
from gear_damping.measurement.record import Finding
from gear_damping.measurement.stamp_units import (
    refuse_endless,
    refuse_other_clock,
    refuse_other_unit,
    refuse_row_numbers,
)
from gear_damping.measurement.time_column import is_time
from gear_damping.measurement.timebase import (
    TimeBase,
    stamped_time,
    steady_time,
    written_significantly,
)
from gear_damping.schema.values import Problems
from gear_damping.units import multiple_of_a_unit, parse_unit, scaled_unit, to_si

LEAST_SAMPLES = 8  # of a record, for a spectrum at all
MOST_DOUBLED = 0.01  # of the rows of a record; where more come twice, something else is wrong
DOUBLED_WITHIN = 100  # rows behind the one that a row is stored again of
MOST_MISSING = 0.01  # of a record: a sheet whose last cells are blank, and no channel of another rate
_SAME_RATE = 1e-3  # how far a declared rate may lie from the file's
SAME_UNIT = 1e-9  # the same of units


@dataclass(frozen=True, eq=False)
class RawChannel:
    """A channel's values as they stand in the file, with their unit there."""

    plan: ChannelPlan
    values: NDArray[np.float64]
    unit: str
    header_unit: str | None
    own_time: TimeBase | None = None


@dataclass(frozen=True, eq=False)
class RawRecord:
    """A record as it stands in its file; `angles` holds the shafts' angles by encoder."""

    plan: RecordPlan
    table: Table
    sha256: str
    base: TimeBase
    channels: list[RawChannel]
    angles: dict[str, ShaftAngle]
    complete: bool


class RawReader:
    """Reads one record; what is wrong goes to `problems`."""

    def __init__(self, plan: RecordPlan, table: Table, problems: Problems, source: str) -> None:
        self.plan, self.table, self.problems, self.source = plan, table, problems, source
        self.file, self.clocks = str(table.path), FileClocks(plan, table)
        self.first, self.stop = plan.rows or (0, 0)
        self.blank = 0  # rows at the end that hold nothing
        self.begins = 0.0  # s, of a record that nothing but pulses of encoders tells
        self.doubled: list[int] = []  # rows that hold what an earlier one does, and no later stamp
        self.foreign: list[int] = []  # rows of other signals, in a table of signals by turns
        self.filled: slice | None = None  # rows of the record in which its slower channels have values

    def read(self, sha256: str) -> RawRecord | None:
        """The record, or None where it has no time base; `complete` where all of it could be read."""
        before, base, within = len(self.problems), None, None
        with self.problems.collecting():
            self._find_rows()
            self.doubled = self._find_doubled()
            self.filled = None if self.doubled else self._find_filled()
            self.foreign = [] if self.doubled or self.filled else self._find_foreign()
            base = self._base()
            base, within = self._with_rows_beside(base)
            base = base and self._said_of_rows(base)
        channels = []
        for plan in self.plan.channels:
            with self.problems.collecting():
                channels.append(self._channel(plan, base))
        angles = {}
        for plan in self.plan.encoders if base else ():
            with self.problems.collecting():
                angles[plan.name] = shaft_angle(self._with_unit(plan), base, self.sliced, self.unsliced, self.file)
        if base is None:
            return None
        with self.problems.collecting():
            base = self._at_its_rate(base, within)
        complete = len(self.problems) == before
        return RawRecord(self.plan, self.table, sha256, base, channels, angles, complete)

    def _with_unit(self, plan: EncoderPlan) -> EncoderPlan:
        """An encoder with the unit of its column: as declared, else that of the file, else s of times and V."""
        unit = plan.unit or self.table.unit(self.table.index(plan.column, f"{plan.key}.column"))
        return replace(plan, unit=unit or ("s" if plan.timestamps else "V"))

    def _find_rows(self) -> None:
        """The number of rows is that of the time stamps, else of the first column that can be read."""
        time = f"{self.plan.key}.channels.time"
        shared = [plan for plan in self.plan.channels if plan.timing is None]
        counted = [plan for plan in self.plan.encoders if not plan.timestamps]
        columns = [(self.plan.timing.column, time)] if self.plan.timing.column is not None else []
        columns += [(plan.column, f"{plan.key}.column") for plan in (*shared, *counted)]
        sizes = (self._size(column) for column, _ in columns)
        n = next((size for size in sizes if size is not None), None) or self._samples(columns)
        if self.stop > n:
            self.stop = n
            rule, remedy = f"{self.table.path.name} has {n} rows", f"end the slice at {n} or before"
            raise InputError(Problem(f"{self.plan.key}.slice", rule, list(self.plan.rows), remedy, self.source))
        self.blank = 0 if self.stop or not columns else self._blank_at_the_end([column for column, _ in columns], n)
        self.stop = self.stop or n - self.blank
        if self.plan.window:
            rows = window_rows(self._seconds(), self.plan.window, f"{self.plan.key}.window", self.source)
            self.first, self.stop = self.first + rows[0], self.first + rows[1]
        if self.stop - self.first < LEAST_SAMPLES:
            rule = f"{self.stop - self.first} samples; a record needs at least {LEAST_SAMPLES}"
            remedy = "use a longer slice, window or file"
            if n < LEAST_SAMPLES and columns:
                rule += f", and {columns[0][1]} = {columns[0][0]!r} holds {n}"
                remedy = f"name another column: {self.table.path.name} holds {self.table.listing(True)}"
                remedy = remedy if max(self.table.lengths) >= LEAST_SAMPLES else "use a longer file"
            raise InputError(Problem(self.plan.key, rule, None, remedy, self.source))

    def _samples(self, columns: Sequence[tuple[str | int, str]]) -> int:
        """The number of rows where no column can be read: of times of pulses alone those that all of them cover."""
        if columns:
            return self._all(*columns[0]).size
        rate = self.plan.timing.sampling_rate
        if not self.plan.encoders or rate is None:
            rule, remedy = "no column gives the number of samples", "declare a time column"
            remedy += ", or sampling_rate, at which the angles are taken" if self.plan.encoders else ""
            raise InputError(Problem(self.plan.key, rule, None, remedy, self.source))
        pulses = [pulse_times(self._with_unit(one), self.unsliced, self.source) for one in self.plan.encoders]
        self.begins = max(float(one[0]) for one in pulses)
        seconds = min(float(one[-1]) for one in pulses) - self.begins
        refuse_endless(seconds, rate, f"{self.plan.encoders[0].key}.timestamps", self.file)
        return max(0, int(seconds * rate) + 1)

    def _blank_at_the_end(self, columns: Sequence[str | int], n: int) -> int:
        """How many of the last of n rows hold nothing in any column: those of a longer run beside this one.

        A few in which the stamps alone go on count too.
        """
        sound = (self._all(column, "") if self._size(column) is not None else np.zeros(0) for column in columns)
        filled = [_filled(values[:n]) for values in sound]
        last = max(filled)
        own = max(filled[1:], default=last) if self.plan.timing.column is not None else last
        last = own if last - own <= MOST_MISSING * last else last
        return n - last if last else 0

    def _find_doubled(self) -> list[int]:
        """Rows with the values of an earlier one where stamps do not go on: a recorder has stored that again.

        It is the row of such a stamp or the one before it. None where that does not mend all of them.
        """
        column = self.plan.timing.column
        if column is None:
            return []
        stamps = self._all(column, f"{self.plan.key}.channels.time.column")[self.first : self.stop]
        late = np.flatnonzero(np.diff(stamps) <= 0) + 1 + self.first
        if not 0 < late.size <= MOST_DOUBLED * stamps.size or written_significantly(stamps) is not None:
            return []
        columns = [one for one in self.clocks.on_its_clock() if self._size(one) is not None]
        if not columns or any(self._size(one) < self.stop for one in columns):
            return []
        rows = np.stack([self._all(one, "")[: self.stop] for one in columns], 1)

        def is_again(k: int) -> bool:
            """Whether a row holds the values of one before it."""
            return bool(np.any(np.all(rows[max(self.first, k - DOUBLED_WITHIN) : k] == rows[k], 1)))

        again = [next((row for row in (k, k - 1) if is_again(row)), None) for k in late.tolist()]
        kept = np.delete(stamps, [k - self.first for k in again if k is not None])
        return [] if None in again or np.any(np.diff(kept) <= 0) else sorted({*again})

    def _find_filled(self) -> slice | None:
        """Every k-th row, where slower channels have blank cells in all others; None where none has, or they differ."""
        found = set()
        for column in self.clocks.on_its_clock():
            with suppress(InputError):  # which its channel will say
                found.add(filled_in(self._all(column, "")[self.first : self.stop]))
        found -= {None}
        return slice(*found.pop()) if len(found) == 1 else None

    def _find_foreign(self) -> list[int]:
        """Rows with a stamp in which other columns hold something and those of the record nothing: signals by turns."""
        columns = [one for one in self.clocks.on_its_clock() if self._size(one) is not None]
        if self.plan.timing.column is None or not columns or any(self._size(one) < self.stop for one in columns):
            return []
        own, rows = {self.table.index(one, "") for one in columns}, set(range(self.first, self.stop))
        foreign = rows.intersection(*(self._empty_cells(place) for place in own))
        if not foreign:
            return []
        own.add(self.table.index(self.plan.timing.column, ""))
        others = (set(self._empty_cells(place)) for place in range(len(self.table.names)) if place not in own)
        spoken = set().union(*(rows - empty for empty in others if empty))
        return sorted(foreign) if foreign == spoken else []

    def _empty_cells(self, place: int) -> list[int]:
        with suppress(InputError):  # a column of texts
            self.table.values(place)
        return self.table.empty_cells(place)

    def _said_of_rows(self, base: TimeBase) -> TimeBase:
        """The time base, with notes of the rows that hold nothing and of those that come twice."""
        found = []
        if self.blank:
            message = f"the last {self.blank} rows hold nothing in the columns of the record, which ends before them"
            found.append(Finding("blank_rows", message, severity="note"))
        if self.filled:
            message = f"the record holds every {self.filled.step}th row, in which its slower channels have values"
            found.append(Finding("filled_rows", message, severity="note"))
        if self.foreign:
            message = (
                f"{len(self.foreign)} rows hold nothing in the columns of the record, as where signals speak by turns; "
                "they are left out, and samples are taken at their stamps"
            )
            found.append(Finding("foreign_rows", message, severity="note"))
        if self.doubled:
            message = (
                f"{len(self.doubled)} row(s) hold the values of an earlier one where stamps do not go on, the first "
            )
            message += f"row {self.doubled[0]} of the file; they are left out"
            found.append(Finding("doubled_rows", message, severity="note"))
        return replace(base, findings=(*base.findings, *found)) if found else base

    def _seconds(self) -> NDArray[np.float64]:
        """The times of the record's rows as they stand in the file, which may be no times at all."""
        column = self.plan.timing.column
        if column is None:
            return self._steady().time
        key = f"{self.plan.key}.channels.time"
        return self._all(column, key)[self.first : self.stop] * self._in_seconds(self.plan.timing, key)

    def _size(self, column: str | int) -> int | None:
        """The length of a column; None where it cannot be read, which its channel will say."""
        try:
            return self._all(column, "").size
        except InputError:
            return None

    def _all(self, column: str | int, key: str) -> NDArray[np.float64]:
        return self.table.values(self.table.index(column, key))

    def sliced(self, column: str | int, key: str) -> NDArray[np.float64]:
        """(n,) finite values in the rows of the record."""
        values = self._all(column, key)
        if values.size < self.stop:
            rule = f"column '{column}' has {values.size} samples, the record {self.stop}"
            last, few = values.size, self.stop - values.size <= MOST_MISSING * self.stop
            remedy = "give the channel its own time or sampling_rate"
            remedy = f"end the slice at {last}, or {remedy}" if few and last > self.first else remedy
            raise InputError(Problem(key, rule, remedy=remedy, source=self.file))
        self._refuse_longer(column, key, _filled(values))
        values = values[self.first : self.stop]
        if self.filled:
            values = values[self.filled]
        foreign = np.array(self.foreign, int) - self.first
        if not self.filled and (not foreign.size or np.any(np.isnan(np.delete(values, foreign)))):
            self._refuse_cells(column, key, self.first, self.stop)
        known = values.copy()
        known[foreign] = 0.0
        refuse_not_finite(known, self._named(key, column), self.file, self.first)
        return np.delete(values, np.r_[foreign, np.array(self.doubled, int) - self.first])

    def _refuse_longer(self, column: str | int, key: str, size: int) -> None:
        """A column that goes on for long where the record ends by itself has another rate than that."""
        if self.plan.rows or self.plan.window or size - self.stop - self.blank <= MOST_MISSING * self.stop:
            return
        rule = f"column '{column}' has {size} samples, the record {self.stop}"
        remedy = f"give the channel its own time or sampling_rate, or slice: [0, {self.stop}] where rows are shared"
        raise InputError(Problem(key, rule, remedy=remedy, source=self.file))

    def _refuse_cells(self, column: str | int, key: str, first: int, stop: int) -> None:
        """Cells that are no numbers are faults in the rows that are used, and nowhere else."""
        problems = self.table.bad_cells(self.table.index(column, key), first, stop)
        if problems:
            raise InputError(problems)

    def _named(self, key: str, column: str | int) -> str:
        return f"{key}, {self.table.path.name} column '{column}'"

    def _base(self) -> TimeBase | None:
        if self.plan.timing.column is not None:
            return self._stamped(self.plan.timing, f"{self.plan.key}.channels.time", self.sliced, self.first)
        base = self._steady()
        if base is None or not self.filled:
            return base
        return replace(base, time=base.time[self.filled], sampling_rate=base.sampling_rate / self.filled.step)

    def _steady(self) -> TimeBase | None:
        """The time base of the declared rate, else of the file's; None where the missing rate is said already."""
        rate = self.plan.timing.sampling_rate
        clock = self.clocks.shared(rate)
        if rate is None and clock is None:
            if not any(problem.key.startswith(self.plan.key) for problem in self.problems):
                rule = "neither time nor sampling_rate is given"
                remedy = "write sampling_rate: {value: 50, unit: kHz}"
                raise InputError(Problem(f"{self.plan.key}.channels", rule, None, remedy, self.source))
            return None
        start = clock[0] if clock else self.begins
        base = steady_time(rate or clock[1], self.first, self.stop - self.first, start)
        found = self.clocks.lost_numbers(self.first, self.stop)
        if clock is None:
            return replace(base, findings=(*self.clocks.other_rate(rate, self.first, self.stop), *found))
        is_other = rate is not None and abs(rate / clock[1] - 1) > _SAME_RATE
        return replace(base, findings=(conflict_with_file(rate, clock[1]), *found) if is_other else found)

    def _with_rows_beside(self, base: TimeBase | None) -> tuple[TimeBase | None, tuple[float, float] | None]:
        """The time base with the sound rows beside the record that the filter of `resample` reaches, and its own ends.

        Those rows are read as if they were the record's: an even clock and numbers in every column, else none is taken.
        """
        if (
            base is None
            or self.filled
            or self.plan.resample is None
            or not base.uniform
            or self.plan.resample >= base.sampling_rate
        ):
            return base, None
        first, stop = self.first, self.stop
        before, behind = self._sound_beside(rows_beside(base, self.plan.resample))
        if not before + behind:
            return base, None
        self.first, self.stop = first - before, stop + behind
        with suppress(InputError):  # of stamps that are none there
            wider = self._base()
            if wider.uniform and abs(wider.sampling_rate / base.sampling_rate - 1) <= _SAME_RATE:
                return replace(wider, findings=base.findings), (float(base.time[0]), float(base.time[-1]))
        self.first, self.stop = first, stop
        return base, None

    def _sound_beside(self, most: int) -> tuple[int, int]:
        """How many rows before and behind the record hold numbers in all of its columns, at most so many each.

        None where there are no such columns: stamps of pulses alone end with the record.
        """
        columns = [*self.clocks.on_its_clock()]
        before = behind = most if columns else 0
        for column in columns:
            with suppress(InputError):  # which its channel will say
                values = np.isfinite(self._all(column, ""))
                before = min(before, _leading(values[: self.first][::-1]))
                behind = min(behind, _leading(values[self.stop :]))
        return before, behind

    def _at_its_rate(self, base: TimeBase, within: tuple[float, float] | None) -> TimeBase:
        """The time base at the rate that `resample` asks for."""
        if self.plan.resample is None:
            return base
        key = f"{self.plan.key}.resample"
        base = slower(base, self.plan.resample, key, self.source, within)
        if base.time.size < LEAST_SAMPLES:
            rule = f"leaves {base.time.size} samples; a record needs at least {LEAST_SAMPLES}"
            raise InputError(Problem(key, rule, self.plan.resample, "give a higher rate", self.source))
        return base

    def _stamped(self, timing: TimePlan, key: str, read: ReadColumn, first: int) -> TimeBase:
        stamps = read(timing.column, key)
        refuse_row_numbers(self.table, timing, key, stamps, self.source)
        one = self._in_seconds(timing, key)
        refuse_other_unit(self.table, timing, key, stamps, one, self.source)
        refuse_other_clock(self.table, timing, key, stamps * one, read, self.source)
        return stamped_time(stamps * one, self._named(key, timing.column), self.file, first)

    def _in_seconds(self, timing: TimePlan, key: str) -> float:
        """One unit of the time stamps in s."""
        header = self.table.unit(self.table.index(timing.column, key))
        unit = timing.unit or header
        if unit is None:
            remedy = "give unit: s, or that of its numbers"
            raise InputError(Problem(f"{key}.unit", "is missing", None, remedy, self.source))
        own = _seconds_of(header)
        if timing.unit is None and own is not None:
            return own
        found = to_si(1.0, unit, "s", f"{key}.unit", self.source)
        if own is not None and abs(own / found - 1) > SAME_UNIT:
            rule = f"the header of column '{timing.column}' says '{header}'"
            remedy = "correct the one that is wrong, or give sampling_rate instead of the time column"
            raise InputError(Problem(f"{key}.unit", rule, unit, remedy, self.source))
        return found

    def _channel(self, plan: ChannelPlan, base: TimeBase | None) -> RawChannel:
        header = self.table.unit(self.table.index(plan.column, f"{plan.key}.column"))
        unit = plan.unit or header
        if unit is None:
            remedy = "give the unit of the column"
            raise InputError(Problem(f"{plan.key}.unit", "is missing", None, remedy, self.source))
        if plan.unit is None and (own := scaled_unit(unit)):
            remedy = f"write unit: {own}, and gain: what the column holds for one {own}"
            raise InputError(Problem(f"{plan.key}.unit", f"the header says '{unit}'", None, remedy, self.source))
        clock = self._clock_beside(plan, base)
        if plan.timing is None and clock is None:
            if self.filled and filled_in(self._all(plan.column, "")[self.first : self.stop]) is None:
                return self._faster(plan, unit, header)
            return RawChannel(plan, self.sliced(plan.column, f"{plan.key}.column"), unit, header)
        values = self.unsliced(plan.column, f"{plan.key}.column")
        own = self._own_time(plan, values.size) if clock is None else steady_time(clock[1], 0, values.size, clock[0])
        return RawChannel(plan, values, unit, header, own)

    def _faster(self, plan: ChannelPlan, unit: str, header: str | None) -> RawChannel:
        """A channel that has values in all rows, beside slower ones."""
        whole = copy(self)
        whole.filled = None
        return RawChannel(plan, whole.sliced(plan.column, f"{plan.key}.column"), unit, header, whole._base())

    def _clock_beside(self, plan: ChannelPlan, base: TimeBase | None) -> tuple[float, float] | None:
        """The file's own clock of a channel where the record follows another one."""
        if base is None:
            return None
        rate = self.plan.timing.sampling_rate
        if self.plan.timing.column is not None:
            rate = base.sampling_rate * (self.filled.step if self.filled else 1)
        return self.clocks.of_channel(plan, rate, self._first_stamp())

    def unsliced(self, column: str | int, key: str) -> NDArray[np.float64]:
        """All finite values of a column, without the empty rows behind a slower one."""
        values = self._all(column, key)
        values = values[: _filled(values) or None]
        if every := filled_in(values):
            return values[slice(*every)]
        self._refuse_cells(column, key, 0, values.size)
        refuse_not_finite(values, self._named(key, column), self.file)
        return values

    def _first_stamp(self) -> float:
        """When the first row of the file was taken, s: a channel with a rate alone begins there too."""
        timing = self.plan.timing
        if timing.column is None:
            return 0.0
        key = f"{self.plan.key}.channels.time"
        stamps = self._all(timing.column, key)
        known = stamps[np.isfinite(stamps)]
        return float(known[0]) * self._in_seconds(timing, key) if known.size else 0.0

    def _own_time(self, plan: ChannelPlan, n: int) -> TimeBase:
        key = f"{plan.key}.time"
        rate = plan.timing.sampling_rate
        if rate is not None:
            base = steady_time(rate, 0, n, self._first_stamp())
            own = self.table.clock(self.table.index(plan.column, key))
            is_other = own is not None and abs(rate / own[1] - 1) > _SAME_RATE
            return replace(base, findings=(conflict_with_file(rate, own[1], plan.name),)) if is_other else base
        if plan.timing.column is None:
            raise InputError(Problem(key, "gives no time base", None, "name a column or a rate", self.source))
        base = self._stamped(plan.timing, key, self.unsliced, 0)
        if base.time.size != n:
            rule = f"{base.time.size} time stamps for {n} samples"
            raise InputError(Problem(key, rule, None, "name the stamps of this very channel", self.file))
        return replace(base, time=base.time + self.clocks.apart(plan.timing.column, key))


def _seconds_of(header: str | None) -> float | None:
    """One count of stamps in s as their header says, `ms` or `10 ms`; None where it says nothing of the kind."""
    if header is None:
        return None
    if is_time(header):
        return to_si(1.0, header, "s")
    step = multiple_of_a_unit(header)
    return step[0] * step[1].factor if step and step[1].dimension == parse_unit("s").dimension else None


def _filled(values: NDArray[np.float64]) -> int:
    """How many of (n,) values there are up to the last that is a number."""
    places = np.flatnonzero(np.isfinite(values))
    return int(places[-1]) + 1 if places.size else 0


def filled_in(values: NDArray[np.float64]) -> tuple[int, int, int] | None:
    """First, end and step of the rows that hold numbers, where (n,) values do in every second or later row alone."""
    rows = np.flatnonzero(np.isfinite(values))
    if rows.size < LEAST_SAMPLES:
        return None
    steps = np.diff(rows)
    is_regular = steps[0] > 1 and bool(np.all(steps == steps[0]))
    return (int(rows[0]), int(rows[-1]) + 1, int(steps[0])) if is_regular else None


def _leading(true: NDArray[np.bool_]) -> int:
    """How many of (n,) are true before the first that is not."""
    return int(true.size if true.all() else np.argmin(true))
