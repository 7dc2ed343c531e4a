"""Units of time stamps that the stamps themselves, the name of their column or a clock in the same rows contradict."""

import re
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.column_kinds import counts_rows
from gear_damping.measurement.declaration import TimePlan
from gear_damping.measurement.encoders import ReadColumn
from gear_damping.measurement.formats.moments import DAY
from gear_damping.measurement.formats.registry import MAX_BYTES
from gear_damping.measurement.formats.table import Table
from gear_damping.measurement.record import Finding
from gear_damping.measurement.recordings import past_overflow
from gear_damping.measurement.time_column import (
    COUNTER,
    ENDINGS,
    FEWEST_STAMPS,
    NAMED,
    finer_than_said,
    may_be_days,
    no_seconds,
    seconds_by_name,
    unit_by_name,
)
from gear_damping.measurement.timebase import MOST_STRAY
from gear_damping.units import is_of_kind, to_si

_TELLS = 10.0  # of its own largest steps, from which the length of a clock tells something
_FEW, _GROSSLY = 3.0, 2.0  # of these steps, from which it tells whether stamps last so many times as long, or as short
_MOST_LEVELS = 0.25  # of the samples: steps repeat, and stamps of rows in another order do not
_BEHIND_A_NAME = re.compile(r"\s*[(\[{/].*$")  # its unit
_STEPS_NAMED = re.compile(r"(^|[_\W])(dt|delta|diff|step)([_\W]|$)", re.I)
_EVENLY = 0.05  # of a step, by which those of a clock beside row numbers may differ: stamps are rounded
MOST_SAMPLES = MAX_BYTES // 8  # of a record: as many numbers as the largest file that is read holds
_AS_LONG = 0.02  # of it, by which stamps may differ: more than two clocks drift apart, less than any wrong unit


def refuse_other_unit(
    table: Table, timing: TimePlan, key: str, stamps: NDArray[np.float64], one: float, source: str
) -> None:
    """Refuse a unit of stamps, of `one` s, that they or the name of their column contradict.

    Raises:
        InputError: they do.
    """
    if timing.unit is None or not stamps.size:
        return
    if found := no_seconds(stamps, one):
        what, remedy = found
        rule = f"stamps of {stamps[0]:.6g} look like {what}"
        raise InputError(Problem(f"{key}.unit", rule, timing.unit, remedy, source))
    name, first = table.names[table.index(timing.column, key)], float(stamps[0])
    if one == DAY and may_be_days(first):
        return  # whatever the column was named before somebody made days of it
    finer = finer_than_said(first, one)
    rule = f"in {timing.unit} from 1970 on, stamps of {first:.6g} lie beyond the year 2286"
    named = "s" if seconds_by_name(name) and one < 1 else unit_by_name(name, table.names)
    if finer is None and named is not None and abs(to_si(1.0, named, "s") / one - 1) > _AS_LONG:
        finer, rule = named, f"the column is named '{name}'"
    if finer is not None:
        remedy = f"write unit: {finer}, or give sampling_rate instead of the time column"
        raise InputError(Problem(f"{key}.unit", rule, timing.unit, remedy, source))


def refuse_other_kind(table: Table, timing: TimePlan, key: str, source: str) -> None:
    """Refuse stamps whose header says a unit of another kind, an angle or a frequency, and whose name says no time.

    Raises:
        InputError: it does.
    """
    place = table.index(timing.column, key)
    name, header = table.names[place], table.unit(place)
    if header is None or NAMED.search(_BEHIND_A_NAME.sub("", name)) or not is_of_kind(header, header):
        return
    if is_of_kind(header, "s") or is_of_kind(header, "1"):
        return
    rule = f"the header of column '{timing.column}' says '{header}', which is no unit of time"
    remedy = "name the column of the time, or give sampling_rate in its place; what goes over an angle or a frequency "
    raise InputError(Problem(key, rule, timing.column, remedy + "is to be exported over time", source))


def refuse_row_numbers(
    table: Table, timing: TimePlan, key: str, stamps: NDArray[np.float64], read: ReadColumn, source: str
) -> None:
    """Refuse a column that counts the rows, whatever unit it is declared in.

    Raises:
        InputError: it is one; the remedy tells the rate that the file states.
    """
    said, rate = table.stated_rate or ("", None)
    one = to_si(1.0, timing.unit, "s") if timing.unit and is_of_kind(timing.unit, "s") else None
    if rate and one and abs(rate * one - 1) < _AS_LONG:
        return
    if stamps.size < FEWEST_STAMPS or not counts_rows(stamps):
        return
    place = table.index(timing.column, key)
    beside = None if rate or one is None else _clock_behind(table, place, one, read)
    if not (rate or beside or COUNTER.match(table.names[place])):  # beside a step any name will do
        return
    remedy = "give sampling_rate in its place" + (f"; '{said}' beside the table says {rate:.6g} Hz" if rate else "")
    remedy = f"name column {beside} as the time, whose steps are even too, or {remedy}" if beside else remedy
    rule = "counts the rows: its numbers go on by one, and say nothing of the time between them"
    raise InputError(Problem(key, rule, timing.column, remedy, source))


def _clock_behind(table: Table, place: int, one: float, read: ReadColumn) -> str | int | None:
    """The column behind one that counts the rows, where it goes like a clock of another rate than 1 / `one` Hz."""
    behind = place + 1
    if behind >= len(table.names):
        return None
    name, unit = table.names[behind], table.unit(behind)
    if not is_of_kind(unit, "s") and (unit is not None or (name and not NAMED.search(name))):
        return None
    try:
        stamps = read(behind, "")
    except InputError:
        return None
    step = float(np.median(np.diff(stamps)))
    if step <= 0 or np.any(np.abs(np.diff(stamps) / step - 1) > _EVENLY):
        return None
    units = [unit] if unit else ENDINGS
    is_same = any(abs(step * to_si(1.0, other, "s") / one - 1) < _AS_LONG for other in units)
    return None if is_same else (repr(name) if name else behind)


def may_count_rows(stamps: NDArray[np.float64], name: str, unit: str | None) -> Finding | None:
    """A note on stamps that begin with 0 or 1 and go on by exactly one, where a count of the rows is as likely.

    Those in ms that begin with 0 are of 1 kHz, which many recorders have.
    """
    if stamps.size < FEWEST_STAMPS or not counts_rows(stamps) or stamps[0] not in (0, 1):
        return None
    if unit != "s" and stamps[0] == 0:
        return None
    message = (
        f"column '{name}' goes on by exactly 1 {unit} from {stamps[0]:.0f}; where it counts the rows, give "
        "sampling_rate in its place"
    )
    return Finding("row_numbers", message, channel="time", severity="note")


def refuse_other_clock(
    table: Table, timing: TimePlan, key: str, seconds: NDArray[np.float64], read: ReadColumn, source: str
) -> None:
    """Refuse numbers for stamps, (n,) s, that last longer or shorter than dates or clocks in the same rows do.

    Raises:
        InputError: they do.
    """
    place = table.index(timing.column, key)
    if seconds.size < FEWEST_STAMPS or _clock(table, place, key, read) is not None:
        return
    for other, name in enumerate(table.names):
        clock = None if other == place else _clock(table, other, key, read)
        if clock is None:
            continue
        stamped, lasts, coarse = np.ptp(past_overflow(seconds)), np.ptp(clock), float(np.abs(np.diff(clock)).max())
        if _are_as_long(stamped, lasts, coarse):
            continue
        rule = f"these stamps last {stamped:.4g} s, and the clock '{name}' in the same rows {lasts:.4g} s"
        remedy = f"correct the unit, name the column {name}, or give sampling_rate instead"
        raise InputError(Problem(key, rule, timing.column, remedy, source))


def refuse_steps(timing: TimePlan, key: str, seconds: NDArray[np.float64], source: str) -> None:
    """Refuse (n,) s that are the steps from row to row, and no clock.

    Raises:
        InputError: they repeat and go to and fro, or do so under a name such as `dt_ms`.
    """
    if seconds.size < FEWEST_STAMPS or seconds.min() < 0 or not np.mean(seconds) > 0:
        return
    steps = np.diff(seconds)
    to_and_fro = np.mean(steps < 0) > MOST_STRAY and np.mean(steps > 0) > MOST_STRAY
    few = np.unique(seconds).size < _MOST_LEVELS * seconds.size
    if not to_and_fro or not (few or _STEPS_NAMED.search(str(timing.column))):
        return
    mean = float(np.mean(seconds))
    rule = f"its numbers go to and fro about {mean:.4g} s: steps from row to row, and no clock"
    remedy = "give their running sum as a column of stamps, or sampling_rate"
    remedy += f"; on average they make {1 / mean:.4g} Hz"
    raise InputError(Problem(key, rule, timing.column, remedy, source))


def completed_by(
    error: InputError, table: Table, timing: TimePlan, key: str, seconds: NDArray[np.float64], read: ReadColumn
) -> InputError:
    """What refuses whole (n,) s, with the column that holds the parts of each second as the remedy, if there is one."""
    place = table.index(timing.column, key)
    if np.any(seconds != np.round(seconds)):
        return error
    for other, name in enumerate(table.names):
        if other == place:
            continue
        try:
            parts = read(other, key)
        except InputError:
            continue
        unit = _unit_of_parts(parts, seconds)
        if unit:
            named = repr(name) if name else other
            remedy = f"name column {named} in its place, with unit: {unit}: it begins again with every second"
            return InputError([replace(one, remedy=remedy) for one in error.problems])
    return error


def _unit_of_parts(parts: NDArray[np.float64], seconds: NDArray[np.float64]) -> str | None:
    """The unit in which (n,) values count the parts of each of (n,) whole seconds; None where they do not."""
    if parts.size != seconds.size or not parts.size or parts.min() < 0:
        return None
    falls, goes_on = np.diff(parts) < 0, np.diff(seconds) > 0
    unit = next((unit for unit in ENDINGS if parts.max() * to_si(1.0, unit, "s") < 1), None)
    return unit if falls.any() and np.array_equal(falls, goes_on) else None


def _are_as_long(stamped: float, lasts: float, coarse: float) -> bool:
    """Whether stamps that last `stamped` s may be those of a clock of `lasts` s whose largest step is `coarse` s."""
    if lasts < _FEW * coarse or not coarse:
        return True
    if lasts < _TELLS * coarse:
        return (lasts - coarse) / _GROSSLY <= stamped <= (lasts + coarse) * _GROSSLY
    return abs(stamped - lasts) <= max(2 * coarse, _AS_LONG * lasts)


def _clock(table: Table, place: int, key: str, read: ReadColumn) -> NDArray[np.float64] | None:
    """(n,) s of a column of dates or clocks; None of any other."""
    try:
        return None if table.begins(place) is None else read(place, key)
    except InputError:  # texts, or cells that are empty: no clock of all rows
        return None


def refuse_endless(seconds: float, rate: float, key: str, file: str) -> None:
    """Refuse times of pulses that reach over more samples than any file holds: they count in a smaller unit.

    Args:
        seconds: From their first to their last, in the unit that is declared.
        rate: At which angles are taken, in Hz.
        key: Where the times are declared.
        file: The file that they come from.

    Raises:
        InputError: they do.
    """
    if seconds * rate > MOST_SAMPLES:
        rule = f"its times reach over {seconds:.3g} s, {seconds * rate:.2g} samples at {rate:g} Hz"
        remedy = "say what they count in beside it, as unit: us or unit: ns"
        raise InputError(Problem(key, rule, None, remedy, file))
