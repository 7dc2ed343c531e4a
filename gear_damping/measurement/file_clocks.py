"""When a file says that its samples were taken: clocks of its channels, and what contradicts the declared rate."""

from contextlib import suppress

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.declaration import ChannelPlan, RecordPlan
from gear_damping.measurement.formats.blocks import listed, overlapping
from gear_damping.measurement.formats.moments import DAY
from gear_damping.measurement.formats.table import Table
from gear_damping.measurement.record import Finding
from gear_damping.measurement.time_column import (
    COUNTER,
    is_time,
    numbers_left_out,
    stamped_rate,
    unit_by_name,
)
from gear_damping.measurement.timebase import RATE_TOLERANCE

_AS_STATED = 0.1  # of a rate that is set, by which a recorder may be off: no unit and no divider is as near
_DOUBTFUL = 1.0  # Hz: LabVIEW writes it where no rate was set, and others a step in ms that says no unit


class FileClocks:
    """The clocks that a file gives the channels of one record."""

    def __init__(self, plan: RecordPlan, table: Table) -> None:
        self.plan, self.table = plan, table

    def on_its_clock(self) -> list[str | int]:
        """The columns of channels and encoders that share the record's time."""
        shared = [plan.column for plan in self.plan.channels if plan.timing is None]
        return shared + [plan.column for plan in self.plan.encoders if not plan.timestamps]

    def shared(self, rate: float | None = None) -> tuple[float, float] | None:
        """Start in s and rate in Hz that the file gives for the first column that shares the record's time.

        Beside a rate that the record has from elsewhere, of the first column whose clock runs at that; where none does,
        of the first, if the file gives one for all of them.
        """
        clocks = []
        for column in self.on_its_clock():
            with suppress(InputError):  # which its channel will say
                clocks.append(self.table.clock(self.table.index(column, "")))
        if rate is None:
            return clocks[0] if clocks else None
        alike = (clock for clock in clocks if clock and abs(clock[1] / rate - 1) <= RATE_TOLERANCE)
        return next(alike, clocks[0] if clocks and None not in clocks else None)

    def of_channel(self, plan: ChannelPlan, rate: float | None, first_stamp: float) -> tuple[float, float] | None:
        """The file's own clock of a channel where the record follows another one, on the record's time.

        Args:
            plan: The channel.
            rate: Hz, that the record has from its stamps or as declared; the file's where None.
            first_stamp: s, of the first row of the file.
        """
        clock = self.table.clock(self.table.index(plan.column, ""))
        if plan.timing is not None or clock is None or (rate is not None and clock[1] <= _DOUBTFUL < rate):
            return None
        stamped = self.plan.timing.column is not None
        record = self.shared(rate)
        if clock == record:
            return None
        if record is not None:
            return clock[0] + (first_stamp - record[0] if stamped else 0.0), clock[1]
        is_alike = rate is None or abs(clock[1] / rate - 1) <= RATE_TOLERANCE
        return None if is_alike else (clock[0] + first_stamp, clock[1])

    def apart(self, column: str | int, key: str) -> float:
        """By how many s the dates or clocks of a column begin behind those of the record; 0 of plain stamps."""
        own = self.table.begins(self.table.index(column, key))
        of_record = self.plan.timing.column
        begun = None if of_record is None else self.table.begins(self.table.index(of_record, key))
        if own is None or begun is None:
            return 0.0
        of_one_day = (own < DAY) != (begun < DAY)  # a date beside a clock without one
        return own % DAY - begun % DAY if of_one_day else own - begun

    def other_rate(self, rate: float, first: int, stop: int) -> tuple[Finding, ...]:
        """A note where columns of stamps that no channel uses run at other rates than the declared one in Hz."""
        used = [plan.timing.column for plan in self.plan.channels if plan.timing]
        used += [plan.column for plan in self.plan.encoders if plan.timestamps]
        columns = {self.table.index(column, "") for column in used if column is not None}
        found = []
        for index in sorted({*range(len(self.table.names))} - columns):
            unit = self._unit_of_stamps(index)
            if unit is None:
                continue
            with suppress(InputError):  # a column that cannot be read has no rate
                own = stamped_rate(unit, self.table.values(index)[first:stop])
                if own and abs(rate / own - 1) <= RATE_TOLERANCE:
                    return ()
                found += [(index, own)] if own else []
        if found:
            index, own = found[0]
            return (_rate_conflict(rate, f"the stamps of column '{self.table.names[index]}' run at", own),)
        name, stated = self.stated(first, stop) or ("", rate)
        if abs(rate / stated - 1) <= RATE_TOLERANCE:
            return ()
        return (_rate_conflict(rate, f"'{name}' beside the table says", stated),)

    def _unit_of_stamps(self, index: int) -> str | None:
        """The unit of a column of stamps, as its header or its name says; None of any other column."""
        unit = self.table.unit(index)
        if unit is not None:
            return unit if is_time(unit) else None
        return unit_by_name(self.table.names[index], self.table.names)

    def beside_stamps(self, rate: float, first: int, stop: int) -> tuple[Finding, ...]:
        """A note where the file states another rate than that of its stamps in the declared unit, in Hz."""
        own = self.shared(rate)
        name, stated = self.stated(first, stop) or ("", rate)
        said = f"'{name}' beside the table"
        if own is not None and own[1] > _DOUBTFUL and abs(rate / own[1] - 1) > _AS_STATED:
            said, stated = "the file itself, of the channels,", own[1]
        if abs(rate / stated - 1) <= _AS_STATED:
            return ()
        message = (
            f"{said} says {stated:.6g} Hz and the time stamps {rate:.6g} Hz, which was used; "
            "correct the unit of time where it is wrong, or give sampling_rate in its place where the stamps are"
        )
        return (Finding("rate_conflict", message, channel="time", severity="note"),)

    def stated(self, first: int, stop: int) -> tuple[str, float] | None:
        """The words that state a rate beside the table, of the block that the rows lie in, and the rate in Hz."""
        if not self.table.blocks:
            return self.table.stated_rate
        block = next(iter(overlapping(self.table.blocks, first, stop)), None)
        if block is None or block.rate is None:
            return None
        return (f"{block.said} above row {block.first}" if block.first else block.said), block.rate

    def refuse_mixed(self, first: int, stop: int, key: str, source: str) -> None:
        """Refuse rows without stamps that blocks of other rates share.

        Raises:
            InputError: they do, with the slice of each block.
        """
        blocks = overlapping(self.table.blocks, first, stop)
        if len({one.rate for one in blocks}) < 2:  # several blocks of one rate are one
            return
        rule = f"rows {first} to {stop - 1} lie in {len(blocks)} blocks, of which the file states other rates"
        remedy = f"make each of them a record of its rate, with slice: {listed(blocks)}"
        raise InputError(Problem(key, rule, None, remedy, source))

    def lost_numbers(self, first: int, stop: int) -> tuple[Finding, ...]:
        """A finding where a column that counts the samples, and that no channel uses, leaves numbers out."""
        used = set()
        for column in self.on_its_clock():
            with suppress(InputError):  # which its channel will say
                used.add(self.table.index(column, ""))
        for index, name in enumerate(self.table.names):
            if index in used or not COUNTER.match(name):
                continue
            with suppress(InputError):  # a column that cannot be read counts nothing
                if lost := numbers_left_out(self.table.values(index)[first:stop]):
                    row, count = lost
                    message = (
                        f"column '{name}' leaves {count} number(s) out, the first behind row {first + row}: "
                        "samples were lost there, and the rows are taken as even; cut the record there with slice"
                    )
                    return (Finding("lost_numbers", message, channel="time", sample=row),)
        return ()


def conflict_with_file(rate: float, own: float, channel: str = "time") -> Finding:
    """What is said where a declared rate contradicts that of the file, both in Hz."""
    message = (
        f"the file itself says {own:.6g} Hz and sampling_rate {rate:.6g} Hz, which was used; "
        "where the file is right, leave sampling_rate out"
    )
    return Finding("rate_conflict", message, channel=channel, severity="note" if own <= _DOUBTFUL else "data_problem")


def two_clocks(rate: float, own: float, channel: str) -> Finding:
    """What is said where a channel of as many rows as the record lasts longer, by its own rate, both in Hz."""
    message = (
        f"its own clock runs at {own:.4g} Hz, and that of the record beside it at {rate:.4g} Hz over as many rows: "
        f"they last {rate / own:.4g} times as long, and those beyond the record are not used; where the rows belong "
        "together, leave out the clock of the channel, or correct its unit"
    )
    return Finding("two_clocks", message, channel=channel, severity="note")


def _rate_conflict(rate: float, said: str, own: float) -> Finding:
    message = (
        f"{said} {own:.6g} Hz and sampling_rate says {rate:.6g} Hz, which was used; "
        "correct the one that is wrong, or give the column as time"
    )
    return Finding("rate_conflict", message, channel="time", severity="note")
