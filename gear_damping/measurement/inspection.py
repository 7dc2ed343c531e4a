"""What a bare file of data holds: its time, and what each column looks like."""

import re
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.by_turns import seen_by_turns
from gear_damping.measurement.column import Column, column_of, longest_finite, of_one_group, seen_as, whole_of
from gear_damping.measurement.column_kinds import (
    CONSTANT,
    ELSEWHERE,
    EMPTY,
    ROW_NUMBER,
    TIME,
    UNREADABLE,
    counts_rows,
)
from gear_damping.measurement.formats.blocks import listed, overlapping
from gear_damping.measurement.formats.table import ArrayTable, Table
from gear_damping.measurement.irregular_stamps import HALF
from gear_damping.measurement.recordings import recordings
from gear_damping.measurement.rows import LEAST_SAMPLES, filled_in, last_number
from gear_damping.measurement.spectral_floor import spectrum_of
from gear_damping.measurement.time_column import (
    ENDINGS,
    Stamps,
    find_stamps,
    runs_through,
    stamped_rate,
    unit_by_name,
)
from gear_damping.measurement.timebase import TimeBase, stamped_time, steady_time

_SPARSE = 0.5  # of the longest stretch of values of any column: one with a shorter one is filled here and there
_FREQUENCIES = ("Hz", "kHz")  # units of the axis of a spectrum; rad/s are as well those of a shaft that runs up
_ORDERS = re.compile(r"\s*(orders?|ordnung|ordre)\s*([(\[].*)?$", re.I)  # the name of the same axis by turns of a shaft
_AXIS = 0.1  # of a step, within which the lines of a spectrum stand apart, as they were rounded
_LYING = 20  # columns for each row of a table that lies on its side: no recorder has so many channels of so few samples
MOST_BETWEEN = 20  # blank cells between two values of a slower channel; what has more is no motion beside the others
MOST_LISTED = 6  # recordings of a file that a line lists
_OTHER_PACE = 0.01  # of the mean step, by which the steps of two clocks may differ: jitter, and they are one
_RATE = re.compile(r"samp\w*[ _]?(freq|rate)|^(fs|f_s|sr|s_?rate)$|abtastrate", re.I)  # of a single number
SHORTEST = 1e-15  # s between two samples: below it lie damaged stamps, and no sensor


_NOTHING = Column("", np.empty(0), (0, 0), None)


@dataclass(frozen=True, eq=False)
class Inspection:
    """What a file holds.

    Args:
        table: The file.
        columns: Every column, in the order of the file.
        length: The rows of a record: the length that most columns have.
        time: The column of the time stamps, if there is one, with their unit.
        base: The time of the rows `rows`; None where no rate is known.
        rows: (first, stop) of the longest stretch in which every column of that length is finite.
        faults: What is wrong with the stamps, for people.
        rate_of: What the file calls a single number that may be the rate; "" where none was needed.
        taken: Which of several recordings one after another the rows are, for people; "" where there is one.
        unread_rate: What the file says of the rate where that is not read and no rate is known; "" of any other file.
    """

    table: Table
    columns: tuple[Column, ...]
    length: int
    time: Stamps | None
    base: TimeBase | None
    rows: tuple[int, int]
    faults: tuple[str, ...] = ()
    rate_of: str = ""
    taken: str = ""
    unread_rate: str = ""

    @property
    def rate(self) -> float | None:
        """Samples a second, or None."""
        return None if self.base is None else self.base.sampling_rate

    @property
    def measured(self) -> list[Column]:
        """The columns of the record that say something: neither stamps, nor constant, nor of another length."""
        dull = (TIME, CONSTANT, EMPTY, UNREADABLE, ROW_NUMBER, ELSEWHERE)
        return [c for c in self.columns if c.values.size == self.length and c.kind not in dull]


def inspect_table(table: Table, clock: str | int | None = None) -> Inspection:
    """Look at every column of a file.

    Args:
        table: The file.
        clock: The column of time stamps; the first that looks like one where absent.

    Raises:
        InputError: none of them holds numbers, they lie in rows, or they are a spectrum.
    """
    _refuse_lying(table)
    columns = [column_of(table, index) for index in range(len(table.names))]
    columns = of_one_group(columns) if table.has_groups else columns
    if not any(column.values.size for column in columns):
        rule = f"no column holds numbers; the first: {columns[0].says}"
        raise InputError(Problem("file", rule, str(table.path), "export the channels as numbers"))
    may_be_rate = _may_be_rate(columns)
    untimed = may_be_rate is None and not any(table.clock(k) for k in range(len(columns)))
    stamps = find_stamps([c if clock in (None, c.reference) else _NOTHING for c in columns], untimed)
    stamps = None if stamps and _numbers_rows(table, columns[stamps.index], stamps) else stamps
    stamps = stamps and _at_the_stated_rate(table, columns[stamps.index], stamps)
    if stamps is None:
        _refuse_spectrum(table, columns)
    columns, some = _where_filled(columns) if stamps else (columns, "")
    length = _length(columns, stamps)
    rows, taken = _of_one_recording(columns, stamps, length, _rows([c for c in columns if c.values.size == length]))
    rows, taken = _of_one_block(table, rows) if stamps is None and table.blocks else (rows, taken)
    base, faults = _base(table, columns, stamps, length, rows)
    faults += seen_by_turns(table, [column.values for column in columns], stamps.index if stamps else None)
    named, rate = (
        (may_be_rate or _stated_rate(table, columns, length, rows)) if base is None and stamps is None else ("", None)
    )
    unread = (named or table.unread_rate) if base is None and not rate else ""
    base = steady_time(rate, rows[0], rows[1] - rows[0]) if rate else base
    found = [seen_as(c, stamps, columns, base, length, table.clock(k)) for k, c in enumerate(columns)]
    rate_of = named if rate else ""
    seen = Inspection(table, tuple(found), length, stamps, base, rows, faults, rate_of, taken or some, unread)
    return replace(seen, columns=tuple(_by_own_clock(seen, column) for column in found))


def _numbers_rows(table: Table, column: Column, stamps: Stamps) -> bool:
    """Whether stamps of no unit that the file says go on by one, beside a rate that it states and they contradict."""
    if table.stated_rate is None or not stamps.guessed or unit_by_name(column.reference):
        return False
    return counts_rows(column.inside) and abs(table.stated_rate[1] * stamps.in_seconds - 1) > _OTHER_PACE


def _at_the_stated_rate(table: Table, column: Column, stamps: Stamps) -> Stamps:
    """Stamps whose unit is a guess in the one with which they run at the rate that the file states, if there is one."""
    if table.stated_rate is None or not stamps.guessed or unit_by_name(column.reference):
        return stamps
    said, rate = table.stated_rate
    rates = {unit: stamped_rate(unit, column.inside) for unit in ENDINGS}
    unit = next((unit for unit, own in rates.items() if own and abs(own / rate - 1) <= _OTHER_PACE), stamps.unit)
    if unit == stamps.unit:
        return stamps
    return replace(stamps, unit=unit, guessed=f"with it they run at {rate:.6g} Hz, as '{said}' says")


def _by_own_clock(found: Inspection, column: Column) -> Column:
    """The column with its rate and its spectrum, where it has a clock of its own."""
    clock = clock_of(found, column) if column.spectrum is not None else None
    rate = None if clock is None else stamped_rate(clock.stamps.unit, clock.inside)
    return replace(column, rate=rate, spectrum=spectrum_of(whole_of(column), rate)) if rate else column


def _refuse_lying(table: Table) -> None:
    """Refuse a table with a row for each channel, whose columns are its samples."""
    rows, columns = max(table.lengths, default=0), len(table.names)
    if isinstance(table, ArrayTable) or not 0 < rows <= columns / _LYING:
        return
    rule = f"{columns} columns and {rows} row{'s' * (rows > 1)} of numbers, perhaps a row for each channel"
    remedy = (
        "write a column for each channel, a line for each sample: turn the table with 'transpose' of a spreadsheet, or "
        f"in Python with pandas.read_csv('{table.path.name}', header=None, sep=None, engine='python')"
        ".T.to_csv('turned.csv', header=False, index=False)"
    )
    raise InputError(Problem("file", rule, str(table.path), remedy))


def _refuse_spectrum(table: Table, columns: Sequence[Column]) -> None:
    """Refuse what goes over frequency: a column in Hz, or of orders, that rises in even steps, where nothing is time.

    Raises:
        InputError: there is one.
    """
    for column in columns:
        steps = np.diff(column.inside)
        if (
            (column.unit in _FREQUENCIES or (_ORDERS.match(str(column.reference)) and not counts_rows(column.inside)))
            and steps.size >= LEAST_SAMPLES
            and steps.min() > 0
            and np.ptp(steps) < _AXIS * steps[0]
        ):
            rule = (
                f"goes over frequency (column '{column.reference}'), and damping is identified from records over time"
            )
            remedy = "export the time records that this spectrum was made from"
            raise InputError(Problem("file", rule, str(table.path), remedy))


def _where_filled(columns: list[Column]) -> tuple[list[Column], str]:
    """The columns in the rows that slower ones have values in, and what is said of that; all rows where none has."""
    found = {filled_in(column.values) for column in columns} - {None}
    if len(found) != 1:
        return columns, ""
    (every,) = found
    if every[2] > MOST_BETWEEN:
        return columns, ""
    kept = [column.values[slice(*every)] for column in columns]
    some = [
        replace(one, values=values, finite=longest_finite(values)) for one, values in zip(columns, kept, strict=True)
    ]
    return some, f"one row in {every[2]}, those in which slower columns have values"


def of_columns(found: Inspection, used: Collection[Column]) -> Inspection:
    """The same with the rows in which these columns and the stamps are finite, whatever the others hold."""
    times = [found.columns[found.time.index]] if found.time else []
    kept = [c for c in (*times, *used) if c.values.size == found.length]
    rows = _rows(kept) if used else found.rows
    if rows == found.rows or rows[1] - rows[0] < found.rows[1] - found.rows[0]:
        return found
    if found.time is None and found.table.blocks:
        rows = _of_one_block(found.table, rows)[0]
    if found.rate_of:
        return replace(found, rows=rows, base=steady_time(found.rate, rows[0], rows[1] - rows[0]))
    rows, taken = _of_one_recording(found.columns, found.time, found.length, rows)
    base, faults = _base(found.table, found.columns, found.time, found.length, rows)
    return replace(found, rows=rows, base=base, faults=faults, taken=taken)


def clock_of(found: Inspection, column: Column) -> Column | None:
    """The clock beside a column that is not the one of the record: the nearest to its left; None where it is that.

    Arrays have no order that says anything.
    """
    if found.time is None or isinstance(found.table, ArrayTable):
        return None
    main, place = found.columns[found.time.index], found.columns.index(column)
    nearest = next((one for one in reversed(found.columns[:place]) if one is main or one.stamps), main)
    if nearest is main:
        return None
    if last_number(main.values) != last_number(nearest.values) == last_number(column.values):
        return nearest  # of two runs side by side it ends with this one
    if runs_through(main.inside, nearest.inside):
        return None  # it starts again with each part of one run
    n = min(main.inside.size, nearest.inside.size)
    own = nearest.stamps.in_seconds * np.diff(nearest.inside[:n])
    apart = np.abs(own - found.time.in_seconds * np.diff(main.inside[:n]))
    return nearest if apart.mean() > _OTHER_PACE * np.abs(own).mean() else None


def _stated_rate(
    table: Table, columns: Sequence[Column], length: int, rows: tuple[int, int]
) -> tuple[str, float | None]:
    """What the file calls the rate, and the rate in Hz: that of all of it, of a block, or of the columns' groups."""
    if table.blocks:
        return next((one.said, one.rate) for one in overlapping(table.blocks, *rows))
    own = (str(c.reference) for c in columns if c.kind != ELSEWHERE and c.values.size == length)
    groups = dict.fromkeys(name.rpartition("/")[0] for name in own)
    found = [(group, *table.stated_rates.get(group, ("", None))) for group in groups]
    if table.stated_rate or len({rate for *_, rate in found}) != 1 or not found[0][1]:
        return table.stated_rate or ("", None)
    group, name, rate = found[0]
    return f"{name} of {group}", rate


def _may_be_rate(columns: Sequence[Column]) -> tuple[str, float] | None:
    """The name and the value in Hz of one positive number under the name of a rate."""
    for column in columns:
        name = str(column.reference).split(".")[-1].split("/")[-1].strip()
        if column.values.size == 1 and column.values[0] > 0 and _RATE.search(name):
            return str(column.reference), float(column.values[0])
    return None


def _length(columns: Sequence[Column], stamps: Stamps | None) -> int:
    """The length that most columns have, the stamps' where several are as frequent, else the longest."""
    sizes = Counter(c.values.size for c in columns)
    own = columns[stamps.index].values.size if stamps else 0
    return max(sizes, key=lambda size: (size >= LEAST_SAMPLES, sizes[size], size == own, size))


def _rows(columns: Sequence[Column]) -> tuple[int, int]:
    """The longest stretch in which every column is finite that is so over much of its length, as one of the others is.

    A column that is filled here and there (a rate that was worked out in some rows only) does not count.
    """
    stretches = [c.finite[1] - c.finite[0] for c in columns]
    least = max(1.0, _SPARSE * max(stretches, default=0))
    held = [np.isfinite(c.values) for c, stretch in zip(columns, stretches, strict=True) if stretch >= least]
    return longest_finite(np.where(np.logical_and.reduce(held), 0.0, np.nan)) if held else (0, 0)


def _of_one_recording(
    columns: Sequence[Column], stamps: Stamps | None, length: int, rows: tuple[int, int]
) -> tuple[tuple[int, int], str]:
    """The rows of the longest recording of a file that holds several, and where the others are; else the rows."""
    if stamps is None or columns[stamps.index].values.size != length or rows[1] - rows[0] < LEAST_SAMPLES:
        return rows, ""
    stamped = columns[stamps.index].values[slice(*rows)]
    # In s the parts of a second are told, which begin again with each; in counts registers that were full.
    found = min((recordings(one) for one in (stamped, stamped * stamps.in_seconds)), key=len)
    parts = [(first + rows[0], end + rows[0]) for first, end in found]
    if len(parts) == 1:
        return rows, ""
    listed = ", ".join(str(list(part)) for part in parts[:MOST_LISTED]) + (" …" if len(parts) > MOST_LISTED else "")
    said = f"the longest of {len(parts)} recordings one after another, each with its own clock: rows {listed}"
    return max(parts, key=lambda part: part[1] - part[0]), said


def _of_one_block(table: Table, rows: tuple[int, int]) -> tuple[tuple[int, int], str]:
    """Of some rows those of the longest block of a rate of its own, and where the others are."""
    parts = [(max(one.first, rows[0]), min(one.stop, rows[1])) for one in overlapping(table.blocks, *rows)]
    longest = max(parts, key=lambda part: part[1] - part[0], default=rows)
    return longest, f"the longest of {len(table.blocks)} blocks, of other rates: rows {listed(table.blocks)}"


def _base(
    table: Table, columns: Sequence[Column], stamps: Stamps | None, length: int, rows: tuple[int, int]
) -> tuple[TimeBase | None, tuple[str, ...]]:
    """The time of the rows, and what is wrong with the stamps; then the rate is that of their median step."""
    if stamps is None or columns[stamps.index].values.size != length:
        clock = next((table.clock(k) for k, c in enumerate(columns) if c.values.size == length), None)
        return (steady_time(clock[1], rows[0], rows[1] - rows[0], clock[0]) if clock else None), ()
    seconds = columns[stamps.index].values[rows[0] : rows[1]] * stamps.in_seconds
    if seconds.size < 2:
        return None, ("no two rows follow each other in which all columns have values",)
    try:
        return stamped_time(seconds, f"column '{columns[stamps.index].reference}'", str(table.path), rows[0]), ()
    except InputError as error:
        steps = np.diff(seconds)
        faults = tuple(problem.rule for problem in error.problems)
        step = 1 / rate if (rate := stamped_rate("s", seconds)) else _usual_step(steps)
        return (steady_time(1 / step, 0, seconds.size) if step > SHORTEST else None), faults


def _usual_step(steps: NDArray[np.float64]) -> float:
    """The mean of the steps about the median one: a clock that leaps once has the pace of all others."""
    median = float(np.median(steps))
    usual = steps[np.abs(steps - median) <= HALF * abs(median)]
    return abs(float(usual.mean() if median and usual.size else steps.mean()))
