"""Reading what a record's plan asks for out of its file, before units are compared."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.angular_error import LENGTH, along_the_line, is_angle
from gear_damping.measurement.by_turns import refuse_by_turns
from gear_damping.measurement.checks import refuse_not_finite
from gear_damping.measurement.cutting import rows_beside, slower, window_rows
from gear_damping.measurement.declaration import ChannelPlan, EncoderPlan, RecordPlan, TimePlan
from gear_damping.measurement.encoders import ReadColumn, ShaftAngle, other_turn, pulse_times, shaft_angle
from gear_damping.measurement.file_clocks import FileClocks, conflict_with_file, two_clocks
from gear_damping.measurement.formats.moments import DAY
from gear_damping.measurement.formats.table import Table
from gear_damping.measurement.named_units import unit_at_end
from gear_damping.measurement.record import Finding
from gear_damping.measurement.rows import LEAST_SAMPLES, MOST_MISSING, Columns, Rows, filled_in, last_number
from gear_damping.measurement.stamp_units import (
    completed_by,
    may_count_rows,
    refuse_endless,
    refuse_other_clock,
    refuse_other_kind,
    refuse_other_unit,
    refuse_row_numbers,
    refuse_steps,
)
from gear_damping.measurement.time_column import is_time, unit_by_name
from gear_damping.measurement.timebase import TimeBase, stamped_time, steady_time
from gear_damping.measurement.vocabulary import OSCILLATOR_CHANNELS
from gear_damping.measurement.worked_out import worked_out
from gear_damping.schema.values import Problems
from gear_damping.units import multiple_of_a_unit, parse_unit, scaled_unit, to_si

_SAME_RATE = 1e-3  # how far a declared rate may lie from the file's
_CLOCKS_AGREE = 0.9  # of a rate: two clocks of the same rows are nearer to each other, however poor their quartz
SAME_UNIT = 1e-9  # the same of units
_LOOKED_AT = 40  # columns that a motion may be the slope of: of a file with more nobody waits for all


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
        timing = plan.timing.column
        self.columns = Columns(table, timing, self.clocks.on_its_clock(), f"{plan.key}.channels.time.column")
        self.rows = Rows(*(plan.rows or (0, 0)))
        self.begins = 0.0  # s, of a record that nothing but pulses of encoders tells

    def read(self, sha256: str) -> RawRecord | None:
        """The record, or None where it has no time base; `complete` where all of it could be read."""
        before, base, within = len(self.problems), None, None
        with self.problems.collecting():
            self._find_rows()
            self.rows = self.columns.without(self.rows)
            self._refuse_by_turns()
            base = self._base()
            base, within = self._with_rows_beside(base)
            base = base and replace(base, findings=(*base.findings, *self.rows.said()))
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
        base = replace(base, findings=(*base.findings, *self._worked_out(channels, base), *self._other_turns(angles)))
        with self.problems.collecting():
            base = self._at_its_rate(base, within)
        complete = len(self.problems) == before
        return RawRecord(self.plan, self.table, sha256, base, channels, angles, complete)

    def _worked_out(self, channels: Sequence[RawChannel], base: TimeBase) -> Iterator[Finding]:
        """Notes of motions of an oscillator that are slopes of other columns."""
        rates = [one for one in channels if OSCILLATOR_CHANNELS.get(one.plan.name)]
        rates = [one for one in rates if one.own_time is None and "mounting" not in one.plan.sensor]
        if not rates or not base.uniform:
            return
        read: dict[int, NDArray[np.float64]] = {}
        for place in range(len(self.table.names))[:_LOOKED_AT]:
            with suppress(InputError):  # what has gaps is the slope of nothing
                read[place] = self.sliced(place, "")
        if self.plan.timing.column is not None:
            read.pop(self.table.index(self.plan.timing.column, ""), None)
        for rate in rates:
            own = self.table.index(rate.plan.column, "")
            others = [(self.table.names[k] or str(k), values) for k, values in read.items() if k != own]
            yield from worked_out(rate.plan.name, rate.values, base.time, others)

    def _other_turns(self, angles: Mapping[str, ShaftAngle]) -> Iterator[Finding]:
        """What headers of encoders say of a turn, where the declaration says another thing."""
        for plan in self.plan.encoders:
            header = self.table.unit(self.table.index(plan.column, plan.key)) if plan.name in angles else None
            if found := other_turn(plan, header):
                yield found

    def _with_unit(self, plan: EncoderPlan) -> EncoderPlan:
        """An encoder with the unit of its column: as declared, else that of the file, else s of times and V."""
        place = self.table.index(plan.column, f"{plan.key}.column")
        header = self.table.unit(place)
        unit = plan.unit or header or ("s" if plan.timestamps else "V")
        named = unit_by_name(self.table.names[place], self.table.names) if plan.timestamps and header is None else None
        if named and is_time(unit) and abs(to_si(1.0, named, "s") / to_si(1.0, unit, "s") - 1) > SAME_UNIT:
            rule = f"the times are in {unit}, and their column is named '{self.table.names[place]}'"
            raise InputError(Problem(f"{plan.key}.unit", rule, plan.unit, f"write unit: {named}", self.source))
        return replace(plan, unit=unit)

    def _find_rows(self) -> None:
        """The number of rows is that of the time stamps, else of the first column that can be read."""
        time = f"{self.plan.key}.channels.time"
        shared = [plan for plan in self.plan.channels if plan.timing is None]
        counted = [plan for plan in self.plan.encoders if not plan.timestamps]
        columns = [(self.plan.timing.column, time)] if self.plan.timing.column is not None else []
        columns += [(plan.column, f"{plan.key}.column") for plan in (*shared, *counted)]
        sizes = (self.columns.size(column) for column, _ in columns)
        n = next((size for size in sizes if size is not None), None) or self._samples(columns)
        first, stop = self.rows.first, self.rows.stop
        if stop > n:
            self.rows = replace(self.rows, stop=n)
            rule, remedy = f"{self.table.path.name} has {n} rows", f"end the slice at {n} or before"
            raise InputError(Problem(f"{self.plan.key}.slice", rule, list(self.plan.rows), remedy, self.source))
        blank = 0 if stop or not columns else self.columns.blank_at_the_end([column for column, _ in columns], n)
        self.rows = Rows(first, stop or n - blank, blank)
        if self.plan.window:
            key = f"{self.plan.key}.window"
            within = window_rows(self._seconds(), self.plan.window, key, self.source, self._window_remedy())
            self.rows = Rows(first + within[0], first + within[1])  # blank rows lie behind it
        if self.rows.count < LEAST_SAMPLES:
            rule = f"{self.rows.count} samples; a record needs at least {LEAST_SAMPLES}"
            remedy = "use a longer slice, window or file"
            if n < LEAST_SAMPLES and columns:
                rule += f", and {columns[0][1]} = {columns[0][0]!r} holds {n}"
                remedy = f"name another column: {self.table.path.name} holds {self.table.listing(True)}"
                remedy = remedy if max(self.table.lengths) >= LEAST_SAMPLES else "use a longer file"
            raise InputError(Problem(self.plan.key, rule, None, remedy, self.source))

    def _window_remedy(self) -> str:
        """What helps where a window lies beyond the record; dates and clocks count from the first of them."""
        column, key = self.plan.timing.column, f"{self.plan.key}.channels.time"
        begins = None if column is None else self.table.begins(self.table.index(column, key))
        if begins is None:
            return "stay within it"
        ends = [f"{end - begins % DAY:.6g}" for end in self.plan.window]
        said = "; of the same day these are" if begins % DAY <= self.plan.window[0] else ""
        remedy = "stay within it, in s from the first sample, from which dates and clocks count"
        return f"{remedy}{said} {ends[0]} to {ends[1]} s" if said else remedy

    def _samples(self, columns: Sequence[tuple[str | int, str]]) -> int:
        """The number of rows where no column can be read: of times of pulses alone those that all of them cover."""
        if columns:
            return self.columns.all(*columns[0]).size
        rate = self.plan.timing.sampling_rate
        declared = (f"{self.plan.key}.channels", f"{self.plan.key}.encoders")
        if not self.plan.encoders and any(one.key.startswith(declared) for one in self.problems):
            raise InputError([])  # what was declared for it could not be read, which is said
        if not self.plan.encoders or rate is None:
            rule, remedy = "no column gives the number of samples", "declare a time column"
            remedy += ", or sampling_rate, at which the angles are taken" if self.plan.encoders else ""
            raise InputError(Problem(self.plan.key, rule, None, remedy, self.source))
        pulses = [pulse_times(self._with_unit(one), self.unsliced, self.source) for one in self.plan.encoders]
        self.begins = max(float(one[0]) for one in pulses)
        seconds = min(float(one[-1]) for one in pulses) - self.begins
        refuse_endless(seconds, rate, f"{self.plan.encoders[0].key}.timestamps", self.file)
        return max(0, int(seconds * rate) + 1)

    def _seconds(self) -> NDArray[np.float64]:
        """The times of the record's rows as they stand in the file, which may be no times at all."""
        column = self.plan.timing.column
        if column is None:
            return self._steady().time
        key = f"{self.plan.key}.channels.time"
        return self.rows.of(self.columns.all(column, key)) * self._in_seconds(self.plan.timing, key)

    def sliced(self, column: str | int, key: str) -> NDArray[np.float64]:
        """(n,) finite values in the rows of the record."""
        values, rows = self.columns.all(column, key), self.rows
        if values.size < rows.stop:
            rule = f"column '{column}' has {values.size} samples, the record {rows.stop}"
            last, few = values.size, rows.stop - values.size <= MOST_MISSING * rows.stop
            remedy = "give the channel its own time or sampling_rate"
            remedy = f"end the slice at {last}, or {remedy}" if few and last > rows.first else remedy
            raise InputError(Problem(key, rule, remedy=remedy, source=self.file))
        self._refuse_longer(column, key, last_number(values))
        values, foreign = rows.of(values), rows.places(rows.foreign)
        if not rows.filled and (not foreign.size or np.any(np.isnan(np.delete(values, foreign)))):
            self._refuse_cells(column, key, rows.first, rows.stop)
        known = values.copy()
        known[foreign] = 0.0
        refuse_not_finite(known, self._named(key, column), self.file, rows.first)
        return np.delete(values, np.r_[foreign, rows.places(rows.doubled)])

    def _refuse_longer(self, column: str | int, key: str, size: int) -> None:
        """A column that goes on for long where the record ends by itself has another rate than that."""
        stop = self.rows.stop
        if self.plan.rows or self.plan.window or size - stop - self.rows.blank <= MOST_MISSING * stop:
            return
        rule = f"column '{column}' has {size} samples, the record {stop}"
        remedy = f"give the channel its own time or sampling_rate, or slice: [0, {stop}] where rows are shared"
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
            base = self._stamped(self.plan.timing, f"{self.plan.key}.channels.time", self.sliced, self.rows.first)
            other = self.clocks.beside_stamps(base.sampling_rate * self.rows.step, self.rows.first, self.rows.stop)
            return replace(base, findings=(*base.findings, *other))
        base = self._steady()
        filled = self.rows.filled
        if base is None or not filled:
            return base
        return replace(base, time=base.time[filled], sampling_rate=base.sampling_rate / filled.step)

    def _steady(self) -> TimeBase | None:
        """The time base of the declared rate, else of the file's; None where the missing rate is said already."""
        rate = self.plan.timing.sampling_rate
        clock = self.clocks.shared(rate)
        self.clocks.refuse_mixed(self.rows.first, self.rows.stop, f"{self.plan.key}.channels", self.source)
        if rate is None and clock is None:
            if not any(problem.key.startswith(self.plan.key) for problem in self.problems):
                rule = "neither time nor sampling_rate is given"
                said, stated = self._stated_rate()
                remedy = f"write sampling_rate: {stated:.6g} Hz, as '{said}' in the file says" if stated else ""
                unread = self.table.unread_rate
                remedy = remedy or "write sampling_rate: {value: 50, unit: kHz}"
                remedy += f", for what '{unread}' in the file means, which is not read" if unread else ""
                raise InputError(Problem(f"{self.plan.key}.channels", rule, None, remedy, self.source))
            return None
        start, rows = clock[0] if clock else self.begins, self.rows
        base = steady_time(rate or clock[1], rows.first, rows.count, start)
        found = self.clocks.lost_numbers(rows.first, rows.stop)
        if clock is None:
            return replace(base, findings=(*self.clocks.other_rate(rate, rows.first, rows.stop), *found))
        is_other = rate is not None and abs(rate / clock[1] - 1) > _SAME_RATE
        return replace(base, findings=(conflict_with_file(rate, clock[1]), *found) if is_other else found)

    def _stated_rate(self) -> tuple[str, float]:
        """The words that state one rate beside the values of a file, and the rate in Hz; 0 where none does."""
        if own := self.clocks.stated(self.rows.first, self.rows.stop):
            return own
        rates = {rate: said for said, rate in self.table.stated_rates.values()}
        return next(((said, rate) for rate, said in rates.items()), ("", 0.0)) if len(rates) == 1 else ("", 0.0)

    def _refuse_by_turns(self) -> None:
        """Refuse rows of several sensors by turns; rows that are told apart already are of one."""
        rows, time = self.rows, self.plan.timing.column
        columns = [one.column for one in self.plan.channels if one.timing is None]
        if not columns or rows.filled or rows.foreign or rows.doubled:
            return
        read = [self.columns.all(one) for one in columns if (self.columns.size(one) or 0) >= rows.stop]
        stamps = None if time is None else rows.of(self.columns.all(time, f"{self.plan.key}.channels.time"))
        columns += [] if time is None else [time]
        used = {self.table.index(one, "") for one in columns if self.columns.size(one) is not None}
        place = slice(rows.first, rows.stop)
        refuse_by_turns(self.table, stamps, [rows.of(one) for one in read], used, place, self.source)

    def _with_rows_beside(self, base: TimeBase | None) -> tuple[TimeBase | None, tuple[float, float] | None]:
        """The time base with the sound rows beside the record that the filter of `resample` reaches, and its own ends.

        Those rows are read as if they were the record's: an even clock and numbers in every column, else none is taken.
        """
        if (
            base is None
            or self.rows.filled
            or self.plan.resample is None
            or not base.uniform
            or self.plan.resample >= base.sampling_rate
        ):
            return base, None
        rows = self.rows
        before, behind = self.columns.sound_beside(rows, rows_beside(base, self.plan.resample))
        if not before + behind:
            return base, None
        self.rows = replace(rows, first=rows.first - before, stop=rows.stop + behind)
        with suppress(InputError):  # of stamps that are none there
            wider = self._base()
            if wider.uniform and abs(wider.sampling_rate / base.sampling_rate - 1) <= _SAME_RATE:
                return replace(wider, findings=base.findings), (float(base.time[0]), float(base.time[-1]))
        self.rows = rows
        return base, None

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
        refuse_other_kind(self.table, timing, key, self.source)
        stamps = read(timing.column, key)
        refuse_row_numbers(self.table, timing, key, stamps, read, self.source)
        one = self._in_seconds(timing, key)
        refuse_other_unit(self.table, timing, key, stamps, one, self.source)
        refuse_other_clock(self.table, timing, key, stamps * one, read, self.source)
        refuse_steps(timing, key, stamps * one, self.source)
        try:
            base = stamped_time(stamps * one, self._named(key, timing.column), self.file, first)
        except InputError as error:
            raise completed_by(error, self.table, timing, key, stamps * one, read) from None
        unit = timing.unit or self.table.unit(self.table.index(timing.column, key))
        note = may_count_rows(stamps, str(timing.column), unit)
        return replace(base, findings=(*base.findings, note)) if note else base

    def _in_seconds(self, timing: TimePlan, key: str) -> float:
        """One unit of the time stamps in s."""
        place = self.table.index(timing.column, key)
        header = self.table.unit(place)
        unit = timing.unit or header
        if unit is None:
            named = unit_by_name(self.table.names[place], self.table.names)
            remedy = f"give unit: {named}, as its name says" if named else "give unit: s, or that of its numbers"
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
        place = self.table.index(plan.column, f"{plan.key}.column")
        header = self.table.unit(place)
        unit = plan.unit or header
        if unit is None:
            named = unit_at_end(self.table.names[place])
            remedy = "give the unit of the column" + (f", as unit: {named}" if named else "")
            raise InputError(Problem(f"{plan.key}.unit", "is missing", None, remedy, self.source))
        if plan.unit is None and (own := scaled_unit(unit)):
            remedy = f"write unit: {own}, and gain: what the column holds for one {own}"
            raise InputError(Problem(f"{plan.key}.unit", f"the header says '{unit}'", None, remedy, self.source))
        if plan.geometry is not None:
            plan, unit = self._along_the_line(plan, unit), LENGTH
        clock = self._clock_beside(plan, base)
        if plan.timing is None and clock is None:
            if self.rows.filled and filled_in(self.rows.whole.of(self.columns.all(plan.column))) is None:
                return self._faster(plan, unit, header)
            return RawChannel(plan, self.sliced(plan.column, f"{plan.key}.column"), unit, header)
        values = self.unsliced(plan.column, f"{plan.key}.column")
        if clock is not None:
            return RawChannel(plan, values, unit, header, steady_time(clock[1], 0, values.size, clock[0]))
        own, rate = self._own_time(plan, values.size), base and base.sampling_rate * self.rows.step
        rows = {self.columns.size(column) for column in self.columns.shared}
        if rate and own.time.size in rows and own.sampling_rate < _CLOCKS_AGREE * rate:
            own = replace(own, findings=(*own.findings, two_clocks(rate, own.sampling_rate, plan.name)))
        return RawChannel(plan, values, unit, header, own)

    def _along_the_line(self, plan: ChannelPlan, unit: str) -> ChannelPlan:
        """An angle of a shaft in the unit of its header, as a length."""
        if not is_angle(unit):
            rule = f"has a meaning only for a transmission error in a unit of an angle, and the header says '{unit}'"
            remedy = "leave it out, or state the unit, as arcsec"
            raise InputError(Problem(f"{plan.key}.shaft", rule, plan.sensor["shaft"], remedy, self.source))
        return along_the_line(replace(plan, unit=unit), plan.geometry)

    def _faster(self, plan: ChannelPlan, unit: str, header: str | None) -> RawChannel:
        """A channel that has values in all rows, beside slower ones."""
        whole = copy(self)
        whole.rows = self.rows.whole
        return RawChannel(plan, whole.sliced(plan.column, f"{plan.key}.column"), unit, header, whole._base())

    def _clock_beside(self, plan: ChannelPlan, base: TimeBase | None) -> tuple[float, float] | None:
        """The file's own clock of a channel where the record follows another one."""
        if base is None:
            return None
        rate = self.plan.timing.sampling_rate
        if self.plan.timing.column is not None:
            rate = base.sampling_rate * self.rows.step
        return self.clocks.of_channel(plan, rate, self._first_stamp())

    def unsliced(self, column: str | int, key: str) -> NDArray[np.float64]:
        """All finite values of a column, without the empty rows behind a slower one."""
        values = self.columns.all(column, key)
        values = values[: last_number(values) or None]
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
        stamps = self.columns.all(timing.column, key)
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
