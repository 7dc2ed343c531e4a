"""Which column of a file holds the time stamps, and in what unit."""

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.column_kinds import ANGLE, MOTION, counts_rows
from gear_damping.measurement.named_units import time_at_end
from gear_damping.measurement.recordings import recordings
from gear_damping.units import is_of_kind, to_si

NAMED = re.compile(
    r"^(t|ts|tt|x_value|ms|msec|us|usec|µs|ns|sec|tid|tijd|czas)$|time|zeit|temps|tempo(?!r)|tiempo|stamp|second|millis|"
    r"micros|elapsed|clock|abscissa",
    re.I,
)
_SUFFIX = re.compile(r"[_ .\-/](s|sec|ms|us|µs|ns|min|h)$", re.I)
_TICKS_NAMED = re.compile(r"^((sys|hal)_?)?tick(s?)$", re.I)  # of a clock where they are even, else of an encoder
_ROUNDED_BY = 2  # numbers that steps of a `tick` differ by where its stamps are rounded
ENDINGS = ("s", "ms", "us", "ns")
_CLOCKS = (("millis", "ms"), ("micros", "us"), ("nanos", "ns"))  # of controllers, and words that begin like them
_SLOW = 200  # whole numbers a step: as milliseconds less than 5 Hz, and few vibrate as slowly
# Ranges that a time counted from 1970 lies in, by its unit: from 2000 on, and they do not meet.
_EPOCHS = ((9.4e8, 1e10, "s"), (9.4e11, 1e13, "ms"), (9.4e14, 1e16, "us"), (9.4e17, 1e19, "ns"))
_SLOWEST = 100.0  # s between two samples of a vibration: a free clock of microseconds goes on by more, taken for s
# Ranges that days lie in from 2000 to 2099, as spreadsheets count them from 1900, MATLAB from the year 0, and
# astronomers from 4713 BC.
_DAYS = ((36526.0, 73050.0), (730486.0, 767010.0), (2451544.5, 2488069.5))
_DAYLONG, _NO_SECONDS = 1e-4, 1e-6  # steps below which these may be days (9 s), and can be no seconds (a MHz)
# Ranges that ticks of 100 ns lie in since 2000, as Windows counts them from 1601 and .NET from the year 1.
_TICKS = ((1.25e17, 1.6e17), (6.3e17, 6.7e17))
TICKS = "ticks of 100 ns, as Windows counts them"
_MILLIONTHS, _OF_A_DAY = (3.6526e10, 7.305e10), 0.0864  # range of millionths of days since 1900; s in one
_YEARS = (1990.0, 2100.0)  # range of years with a decimal part: as seconds half an hour after a start
_WAY = 1e-2  # of the first stamp: what a part of a day goes on by is less, and no seconds are so short beside it
_CLOCK_DIGITS = (1e7, 2.4e8)  # range of whole numbers HHMMSSmmm, from one in the morning on
_LONG_DIGITS = (17, 20)  # digits of a date and a clock to the ms or the us; 14 count seconds within a minute
_MONTHS, _LONGEST_MONTH, _FULL = 12, 31, (24, 60, 60)  # in a year; days in one; hours, minutes, seconds that are full
_SECONDS, _PARTS = re.compile(r"seconds?(\b|_)", re.I), re.compile(r"milli|micro|nano|msec|usec|nsec", re.I)
FEWEST_STAMPS = 8  # stamps, as many as a record needs
_ADVANCING = 0.9  # share of the steps of a named column that go forward
_SHORT = re.compile(r"^t[a-z]?\d*(_\w+)?$", re.I)  # t1, tb_n: a time only where its steps are even
_FIRST = re.compile(r"\[0\]\s*$")  # the first column of a matrix, which says nothing of its own
_LOOSELY = 0.5  # of the median step; how far the steps of a first column without a name may differ
_NO_TIME = re.compile(  # what may rise evenly and is no time
    r"speed|rpm|omega|drehzahl|freq|volt|curr|weg|^f$|\border|ordnung|^revs?$|umdreh", re.I
)
_NEARLY = 0.1  # of the median step; how far most steps of a column that no name calls time may differ
_EVEN = 0.05  # of the median step; how far the steps of an unnamed column may differ
COUNTER = re.compile(
    r"^\s*#?\s*(samples?|counter|count|index|idx|rows?|nr|no|seq(uence)?|packet|frame)\s*(no|nr|number)?\.?\s*$", re.I
)
MOST_CUT = 2  # packets of stamps that the ends of a record may cut; samples to one
_COUNTS = 0.95  # share of the rows from one to the next number, in a column that counts them


@dataclass(frozen=True)
class Stamps:
    """A column of time stamps.

    Args:
        index: Its 0-based index.
        unit: Of the stamps.
        guessed: Why that unit was taken; "" where the file says it.
        says: What it was recognised by.
    """

    index: int
    unit: str
    guessed: str
    says: str

    @property
    def in_seconds(self) -> float:
        """One of its units in s."""
        return to_si(1.0, self.unit, "s")


class _Column(Protocol):
    reference: str | int
    unit: str | None

    @property
    def inside(self) -> NDArray[np.float64]: ...


def find_stamps(columns: Sequence[_Column], untimed: bool = False) -> Stamps | None:
    """The column that advances and bears the unit or the name of time, else a first one that advances evenly.

    Else the one without a name that goes like a clock.

    Args:
        columns: Those of the file.
        untimed: Whether nothing else says the time, so that a first one of any name that rises evenly may be it.
    """
    for by in (_by_unit, _by_name, _behind_row_numbers(columns), _by_steps, _by_ramp, _by_epoch):
        seen = ((index, by(index, one)) for index, one in enumerate(columns) if one.inside.size >= FEWEST_STAMPS)
        found = (Stamps(index, *_unit(columns[index]), says) for index, says in seen if says)
        if first := next(found, None):
            return _running_through(columns, first, found)
    telling = [k for k, one in enumerate(columns) if one.inside.size >= FEWEST_STAMPS and not counts_rows(one.inside)]
    if not untimed or not telling:
        return None
    if _rises(columns[telling[0]]):
        return Stamps(telling[0], *_unit(columns[telling[0]]), f"is the first column and {_says(columns[telling[0]])}")
    steady = [k for k in telling if _goes_like_a_clock(columns[k])]
    if len(steady) != 1:
        return None
    return Stamps(steady[0], *_unit(columns[steady[0]]), "goes on by the same whole number in nearly all rows")


def _running_through(columns: Sequence[_Column], first: Stamps, others: Iterable[Stamps]) -> Stamps:
    """The first of some clocks; where it starts again and others run on through as many rows, the first of those."""
    begun = columns[first.index].inside
    if len(recordings(begun)) < 2:
        return first
    return next((one for one in others if runs_through(columns[one.index].inside, begun)), first)


def runs_through(stamps: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Whether stamps never go back through as many rows as those of another clock have, which starts again in them."""
    return stamps.size >= other.size and bool(np.all(np.diff(stamps) > 0)) and len(recordings(other)) > 1


def named_clock(column: _Column) -> Stamps | None:
    """The stamps of a column that bears the unit or the name of time and advances, wherever it stands; else None."""
    says = (_by_unit(0, column) or _by_name(0, column)) if column.inside.size >= FEWEST_STAMPS else ""
    return Stamps(0, *_unit(column), says) if says else None


def counts_from_1970(values: NDArray[np.float64]) -> bool:
    """Whether (n,) values never fall and lie where a finer clock than that of seconds stands since 2000."""
    inside = any(low < values[0] < high for low, high, _ in _EPOCHS[1:])
    return bool(inside and np.all(np.diff(values) >= 0) and values[-1] > values[0])


def finer_than_said(first: float, one: float) -> str | None:
    """The unit of stamps that count from 1970, where with the one that is said they would begin beyond the year 2286.

    Args:
        first: The first stamp, in the unit that is said.
        one: That unit in s.
    """
    if first * one < _EPOCHS[0][1]:
        return None
    return next((other for low, high, other in _EPOCHS if low < first < high), None)


def no_seconds(values: NDArray[np.float64], one: float) -> tuple[str, str] | None:
    """What (n,) stamps in a unit of `one` s are where they can be no such, and the remedy; None where they may be.

    Days, parts of one and years, whose steps would be shorter than a microsecond as seconds; ticks of 100 ns; and
    digits of a date or a clock that are written as one number.
    """
    if values.size < FEWEST_STAMPS:
        return None
    instead = "give sampling_rate instead of the time column"
    if any(low < values[0] < high for low, high in _TICKS):
        return TICKS, "divide the column by 10 and write unit: us, or give sampling_rate instead of it"
    if are_digits(values):
        return "dates YYYYMMDDHHMMSSmmm", f"write them as 2024-03-01 12:34:56.789, or {instead}"
    step = float(np.median(np.diff(values)))
    if _are_millionths(values):
        rate = f"; their steps make {1 / (step * _OF_A_DAY):.4g} Hz"
        return "days since 1900, times 10^6", f"divide the column by 10^6 and write unit: day, or {instead}{rate}"
    if one > 1:
        return None
    if one == 1 and _are_clock_digits(values):
        return "clocks HHMMSSmmm", f"write them as 12:34:56.789, or {instead}"
    if _are_days(values, _NO_SECONDS):
        return "days since 1900, the year 0 or 4713 BC", f"write unit: day, or {instead}"
    if 0 < step < _NO_SECONDS and 0 < np.ptp(values) < _WAY * abs(values[0]):
        if 0 < values[0] < 1:
            return "parts of a day", f"write unit: day, or {instead}"
        if _YEARS[0] < values[0] < _YEARS[1]:
            return "years", f"take the year off, multiply by 31557600 and write unit: s, or {instead}"
    return None


def are_digits(values: NDArray[np.float64]) -> bool:
    """Whether (n,) whole numbers hold the digits of dates and clocks to the millisecond, YYYYMMDDHHMMSSmmm."""
    return all(_is_date_and_clock(f"{value:.0f}") for value in values[[0, values.size // 2, -1]])


def _is_date_and_clock(digits: str) -> bool:
    """Whether 17 digits or more begin with those of a date since 1990 and of a clock."""
    if len(digits) not in _LONG_DIGITS or not _YEARS[0] < int(digits[:4]) < _YEARS[1]:
        return False
    month, day, *clock = (int(digits[k : k + 2]) for k in range(4, 14, 2))
    return 1 <= month <= _MONTHS and 1 <= day <= _LONGEST_MONTH and all(map(int.__lt__, clock, _FULL))


def _are_clock_digits(values: NDArray[np.float64]) -> bool:
    """Whether (n,) whole numbers that go on hold the digits of clocks to the millisecond, HHMMSSmmm."""
    if not (
        _CLOCK_DIGITS[0] <= values.min() and values.max() < _CLOCK_DIGITS[1] and np.all(values == np.round(values))
    ):
        return False
    clocks = values // 1000
    return bool(np.all(clocks % 100 < _FULL[2]) and np.all(clocks // 100 % 100 < _FULL[1]))


def _are_millionths(values: NDArray[np.float64]) -> bool:
    """Whether (n,) values with a decimal part lie where millionths of days do, as WinCC writes them in `Time_ms`."""
    low, high = _MILLIONTHS
    goes_on = float(np.median(np.diff(values))) > 0
    return bool(goes_on and low < values.min() and values.max() < high and np.any(values != np.round(values)))


def may_be_days(first: float) -> bool:
    """Whether a first stamp lies where days since 2000 do, however they are counted."""
    return any(low < first < high for low, high in _DAYS)


def _are_days(values: NDArray[np.float64], least: float) -> bool:
    """Whether (n,) values lie where days from 1900 or the year 0 do, and go on by less than a part of one."""
    step = float(np.median(np.diff(values)))
    return may_be_days(values[0]) and 0 < step < least


def seconds_by_name(name: str) -> bool:
    """Whether the name of a column says that its stamps are in seconds, and no smaller part of them."""
    return bool(_SECONDS.search(name)) and not _PARTS.search(name)


def unit_by_name(reference: str | int, others: Sequence[str] = ()) -> str | None:
    """The unit that the name of a column of stamps says, at its end as `t_ms`, or as `millis`; None of any other.

    Args:
        reference: Its name.
        others: Those of the other columns.
    """
    name = str(reference).lower()
    return time_at_end(reference, others) or next((part for word, part in _CLOCKS if word in name), None)


def stamped_rate(unit: str, values: NDArray[np.float64]) -> float | None:
    """The mean rate in Hz of (n,) values in a unit of time that advance; None of any others.

    Of samples that share stamps, those between the first change and the last count: packets at the ends may be cut.
    """
    if values.size < FEWEST_STAMPS or not np.all(np.isfinite(values)) or np.any(np.diff(values) < 0):
        return None
    changes = np.flatnonzero(np.diff(values)) + 1
    if MOST_CUT <= len(changes) < values.size / MOST_CUT:
        first, last = changes[0], changes[-1]
        return float(last - first) / (float(values[last] - values[first]) * to_si(1.0, unit, "s"))
    lasts = float(values[-1] - values[0]) * to_si(1.0, unit, "s")
    return (values.size - 1) / lasts if lasts > 0 else None


def _by_unit(index: int, column: _Column) -> str:
    return "advances, in a unit of time" if is_time(column.unit) and _advances(column) else ""


def _by_name(index: int, column: _Column) -> str:
    named = NAMED.search(_bare(column.reference)) or time_at_end(column.reference)
    free = column.unit is None or _time_unit(column.unit) is not None
    return "advances and is named like a time" if named and free and _advances(column) else ""


def _behind_row_numbers(columns: Sequence[_Column]) -> Callable[[int, _Column], str]:
    """What sees a second column that goes on about evenly, where neither it nor the first, of row numbers, is named.

    Whole numbers may be the counts of a shaft.
    """
    bare = [one for one in columns[:2] if one.unit is None and not _named(one) and one.inside.size >= FEWEST_STAMPS]
    follows = len(bare) == 2 and counts_rows(bare[0].inside) and _is_nearly_even(bare[1])
    follows = follows and bool(np.any(bare[1].inside != np.round(bare[1].inside)))
    return lambda index, column: f"{_says(column)} behind the numbers of the rows" if follows and index == 1 else ""


def _by_steps(index: int, column: _Column) -> str:
    name = _named(column)
    if column.unit is not None or (name and not _FIRST.search(name)) or (index and not name):
        return ""
    if index:
        return f"is the first column of {name[: -len('[0]')]} and advances evenly" if _is_even(column) else ""
    return f"is the first column and {_says(column)}" if _is_nearly_even(column) else ""


def _says(column: _Column) -> str:
    """How a column advances."""
    return "advances evenly" if _is_even(column) else "rises in nearly even steps"


def _by_ramp(index: int, column: _Column) -> str:
    named = column.unit is None and _SHORT.search(_bare(column.reference))
    if named and _is_even(column):
        return "advances evenly, and its name begins with t"
    return "advances evenly, and is named like a clock's ticks" if _ticks(column) else ""


def _ticks(column: _Column) -> bool:
    """Whether it is named like ticks and advances as those of a clock: by more than row numbers, and evenly.

    Several `ticks` are an encoder's where their steps differ at all.
    """
    named, steps = _TICKS_NAMED.search(_bare(column.reference)), np.diff(column.inside)
    if column.unit is not None or not named:
        return False
    return bool(steps.min() > 1 and np.ptp(steps) <= (0 if named[3] else _ROUNDED_BY))


def _by_epoch(index: int, column: _Column) -> str:
    """A column that advances from 2000 on, as counted from 1970; a few stamps that go back are said of its time."""
    name, values = _bare(column.reference), column.inside
    if column.unit is not None or any(words.search(name) for words in (ANGLE, MOTION, _NO_TIME)):
        return ""
    unit = _unit_from_1970(float(values.min()), float(np.median(np.diff(values))))
    is_kept = unit is not None and unit == _unit_from_1970(float(values.max()), 0.0)
    return f"advances and lies where {unit} since 1970 do" if is_kept and _advances(column) else ""


def _rises(column: _Column) -> bool:
    """Whether it rises from row to row in nearly even steps, as the stamps of a camera; counts may be of a shaft."""
    name, values = _bare(column.reference), column.inside
    if column.unit is not None or any(words.search(name) for words in (ANGLE, MOTION, _NO_TIME)):
        return False
    steps = np.diff(values)
    median = float(np.median(steps))
    nearly = median > 0 and np.mean(np.abs(steps / median - 1) < _NEARLY) > _ADVANCING
    return bool(nearly and steps.min() > 0 and not np.all(values == np.round(values)))


def _goes_like_a_clock(column: _Column) -> bool:
    """Whether a column without a name or unit goes on by one whole number, as no count of a shaft that moves does."""
    values = column.inside
    if column.unit is not None or _named(column):
        return False
    steps = np.diff(values)
    median = float(np.median(steps))
    whole = bool(np.all(values == np.round(values)))
    return bool(whole and median > 0 and steps.min() >= 0 and np.mean(steps == median) > _ADVANCING)


def _is_even(column: _Column) -> bool:
    steps = np.diff(column.inside)
    median = float(np.median(steps))
    return median > 0 and bool(np.all(np.abs(steps / median - 1) < _EVEN))


def _is_nearly_even(column: _Column) -> bool:
    """Whether it never goes back, and nearly all steps are one, as those of stamps that jitter or are rounded.

    Whole numbers that rise at every row (milliseconds of a loop that takes 2 to 4) may differ by one of themselves.
    """
    steps = np.diff(column.inside)
    median = float(np.median(steps))
    is_whole = steps.min() >= 1 and bool(np.all(column.inside == np.round(column.inside)))
    within = max(_LOOSELY * median, 1.0) if is_whole else _LOOSELY * median
    near = np.abs(steps - median) <= within if is_whole else np.abs(steps - median) < within
    return median > 0 and bool(steps.min() >= 0 and np.mean(near) > _ADVANCING)


def _advances(column: _Column) -> bool:
    """Whether it goes on; stamps of data that came in bursts repeat, and never go back."""
    steps = np.diff(column.inside)
    return bool(np.mean(steps > 0) > _ADVANCING or (steps.min() >= 0 and np.count_nonzero(steps) >= FEWEST_STAMPS))


def _named(column: _Column) -> str:
    """The name of a column; empty where it has but a number."""
    return column.reference.strip() if isinstance(column.reference, str) else ""


def _bare(reference: str | int) -> str:
    """A name without the unit in its brackets and without the path before it; `Zeit/s` has its unit behind a slash."""
    name = re.sub(r"[(\[].*$", "", str(reference)).strip()
    return name if _SUFFIX.search(name) and name.count("/") == 1 else name.split("/")[-1].split(".")[-1]


def numbers_left_out(values: NDArray[np.float64]) -> tuple[int, int] | None:
    """The row before the first gap, and how many numbers are left out, where (n,) values count samples; else None.

    A register that is full begins again with 0.
    """
    steps = np.diff(values)
    if not steps.size or not np.all(np.isfinite(values)) or np.any(values != np.round(values)) or values.min() < 0:
        return None
    steps = np.where(steps < 0, steps % 2 ** np.ceil(np.log2(values.max() + 1)), steps)
    if np.mean(steps == 1) < _COUNTS or steps.min() < 1 or steps.max() == 1:
        return None
    return int(np.argmax(steps > 1)), int(np.sum(steps - 1))


def _time_unit(unit: str | None) -> str | None:
    """A unit of time, in small letters where the file has it in large ones, as `Time (S)`; None of any other."""
    return next((one for one in (unit, unit and unit.lower()) if is_time(one)), None)


def is_time(unit: str | None) -> bool:
    """Whether a unit is one of time."""
    return is_of_kind(unit, "s")


def _unit_from_1970(stamp: float, step: float) -> str | None:
    """The unit in which a stamp since 2000 counts from 1970, where a usual step is one of a vibration; else None."""
    found = (unit for low, high, unit in _EPOCHS if low < stamp < high and to_si(step, unit, "s") < _SLOWEST)
    return next(found, None)


def _unit(column: _Column) -> tuple[str, str]:
    """The unit of the stamps, and why where the file does not say it."""
    if unit := _time_unit(column.unit):
        return unit, ""
    if unit := unit_by_name(column.reference):
        return unit, "from its name"
    first, step = float(column.inside[0]), float(np.median(np.diff(column.inside)))
    if unit := _unit_from_1970(first, step):
        return unit, "counted from 1970"
    if _are_days(column.inside, _DAYLONG):
        return "day", "counted from 1900 or the year 0"
    if any(low < first < high for low, high in _TICKS):
        return "us", f"{TICKS}: divide the column by 10"
    if np.all(column.inside == np.round(column.inside)):
        unit, other = ("us", "ms") if step >= _SLOW else ("ms", "us")
        why = f"whole numbers in steps of {step:.4g}; write {other} or s where they are those"
        return unit, f"{why}, and give sampling_rate where they count samples"
    return "s", "the usual one"
