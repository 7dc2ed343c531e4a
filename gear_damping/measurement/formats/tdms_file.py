"""TDMS files of LabVIEW and DIAdem: channels as `group/channel`, with their units and rates."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.moments import moment_since
from gear_damping.measurement.formats.stated_rate import beside_their_units, rate_of, stated_rate
from gear_damping.measurement.formats.table import (
    ArrayTable,
    Held,
    Table,
    extra_library,
    is_real,
    kind_of,
    refuse_size,
    unreadable,
)

SUFFIXES = (".tdms",)

_HALF = 0.5  # of a sample, by which clocks of one task differ at most
_UNIT_PROPERTIES = ("unit_string", "NI_UnitDescription", "unit", "Unit")


def read(path: Path, max_bytes: int) -> Table:
    """The channels of a TDMS file as columns; time stamps are seconds since the first one of their channel.

    Raises:
        InputError: not a TDMS file, too large when unpacked, no real numbers, or npTDMS is missing.
    """
    nptdms = extra_library("nptdms", path)
    held, left_out, said = [], [], _Said()
    _refuse_other(path)
    with unreadable(path, "not a readable TDMS file", "export it again"), _opened(nptdms, path, said) as file:
        channels = [channel for group in file.groups() for channel in group.channels()]
        refuse_size(path, sum(8 * len(channel) for channel in channels), max_bytes)
        first = min((one for one in map(_begun, channels) if one is not None), default=None)
        for channel in channels:
            name = f"{channel.group_name}/{channel.name}"
            dtype = np.dtype(channel.dtype)
            if len(channel) and (is_real(dtype) or dtype.kind == "M"):
                held.append(_held(nptdms, path, name, channel, first))
            else:
                left_out.append(f"{name} ({'empty' if not len(channel) else kind_of(dtype)})")
        owners = [file, *file.groups(), *channels]
        settings = [row for one in owners for row in beside_their_units(one.properties)]
    if not held and said.messages:
        rule = f"not a readable TDMS file ({said.messages[0]})"
        raise InputError(Problem("file", rule, str(path), "export it again"))
    table = ArrayTable(path, held, left_out)
    table.stated_rate = stated_rate(settings)
    table.notes = tuple(f"{path.name}: {message}" for message in dict.fromkeys(said.messages))
    return table


def _refuse_other(path: Path) -> None:
    """The library takes a file that does not begin as TDMS for an empty one."""
    with path.open("rb") as file:
        if file.read(4) != b"TDSm":
            rule = "not a readable TDMS file (it does not begin with TDSm)"
            raise InputError(Problem("file", rule, str(path), "export it again"))


class _Said(logging.Handler):
    """Keeps what the library logs, such as that the last segment was cut off."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.messages: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Take a message."""
        self.messages.append(record.getMessage())


@contextmanager
def _opened(nptdms: Any, path: Path, said: _Said) -> Iterator[Any]:
    """The open file; the library itself leaves a damaged one open, and logs to the console."""
    manager = nptdms.log.log_manager
    level = manager.console_handler.level
    manager.console_handler.setLevel(logging.CRITICAL + 1)
    for log in manager.loggers.values():
        log.addHandler(said)
    try:
        with path.open("rb") as stream, nptdms.TdmsFile.open(stream) as file:
            yield file
    finally:
        manager.console_handler.setLevel(level)
        for log in manager.loggers.values():
            log.removeHandler(said)


def _begun(channel: Any) -> np.datetime64 | None:
    """When a waveform begins, where LabVIEW has written it."""
    found = channel.properties.get("wf_start_time")
    return np.datetime64(found) if isinstance(found, (np.datetime64, datetime)) else None


def _held(nptdms: Any, path: Path, name: str, channel: Any, first: np.datetime64 | None) -> Held:
    """A channel; `first` is when the first of the file begins."""
    group, own = channel.group_name, channel.name
    stamps = np.dtype(channel.dtype).kind == "M"

    def read() -> NDArray:
        with _opened(nptdms, path, _Said()) as file:
            values = file[group][own][:]
        return (values - values[0]) / np.timedelta64(1, "s") if stamps else values

    def begins() -> float:
        with _opened(nptdms, path, _Said()) as file:
            return moment_since(file[group][own][0].astype("datetime64[us]").item())

    begun = _begun(channel)
    late = 0.0 if begun is None else float((begun - first) / np.timedelta64(1, "s"))
    said = (channel.properties.get(name) for name in _UNIT_PROPERTIES)
    unit = "s" if stamps else next((one for one in said if one and isinstance(one, str)), None)
    return Held(name, (len(channel),), read, unit, _clock(channel.properties, late), begins if stamps else None)


def _clock(properties: dict[str, Any], late: float) -> tuple[float, float] | None:
    """Start in s and rate in Hz of a waveform that begins `late` s behind the first.

    The increment of one over time is in s, over frequency in Hz.
    """
    rate, start = rate_of(properties.get("wf_increment")), properties.get("wf_start_offset", 0.0)
    in_time = properties.get("wf_xname", "Time") != "Frequency" and properties.get("wf_xunit_string", "s") == "s"
    late = late if rate and late * rate > _HALF else 0.0  # less is the rounding of its clock
    return (float(start) + late, rate) if rate and in_time and isinstance(start, (int, float)) else None
