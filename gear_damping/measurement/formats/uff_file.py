"""UFF files, sets 58 and 58b: column 0 is the abscissa, and the sets follow in the order of the file."""

from pathlib import Path
from typing import Any

import numpy as np

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.formats.stated_rate import rate_of
from gear_damping.measurement.formats.table import ArrayTable, Held, Table, extra_library, unreadable
from gear_damping.units import is_of_kind, to_si

SUFFIXES = (".uff", ".unv", ".uff58")

_TIME = 17  # the specific data type of an abscissa in seconds
_FREQUENCY = 18  # code of an abscissa in Hz (UFF 58, record 8)
_SHOWN = 3  # names of functions that a message lists
_TAIL = 1024  # bytes in which the mark of the last set's end stands
_WRITTEN = 5e-6  # the increment stands in the file with six digits


def read(path: Path, max_bytes: int) -> Table:
    """The functions of a UFF file as columns; those of an even abscissa in time bring their rate.

    Raises:
        InputError: no set 58 or 58b that can be read, or pyuff is missing.
    """
    pyuff = extra_library("pyuff", path)
    remedy = "export the channels as UFF 58 or 58b"
    _refuse_cut_off(path, remedy)
    with unreadable(path, "not a readable UFF file", remedy):
        file = pyuff.UFF(str(path))
        found = [k for k, kind in enumerate(file.get_set_types()) if kind == 58]
        sets = [file.read_sets(k) for k in found]
    if not sets:
        raise InputError(Problem("file", "holds no set 58 or 58b that can be read", str(path), remedy))
    for k, one in enumerate(sets):
        if np.size(one["data"]) != one["num_pts"]:
            rule = f"set {k} holds {np.size(one['data'])} of the {one['num_pts']} values that it announces"
            raise InputError(Problem("file", rule, str(path), remedy))
    spectra = [_name(one) for one in sets if one.get("abscissa_spec_data_type") == _FREQUENCY]
    if len(spectra) == len(sets):
        rule = f"holds functions of frequency alone ({', '.join(spectra[:_SHOWN])}), and damping is identified in time"
        raise InputError(Problem("file", rule, str(path), "export the time records that they were made from"))
    real = [one for one in sets if np.isrealobj(one["data"]) and np.size(one["data"])]
    left_out = [f"{_name(one)} (complex or empty)" for one in sets if not any(one is kept for kept in real)]
    if not real:
        return ArrayTable(path, [], left_out)
    held = [_abscissa(real[0])]
    held += [_held(_name(one), one["data"], _unit(one["ordinate_axis_units_lab"]), _clock(one)) for one in real]
    return ArrayTable(path, held, left_out)


def _refuse_cut_off(path: Path, remedy: str) -> None:
    """The library leaves out a last set whose end is missing."""
    with path.open("rb") as file:
        file.seek(max(0, path.stat().st_size - _TAIL))
        if b"    -1" not in file.read():
            rule = "holds no set 58 or 58b that can be read to its end"
            raise InputError(Problem("file", rule, str(path), remedy))


def _held(name: str, values: Any, unit: str | None, clock: tuple[float, float] | None) -> Held:
    return Held(name, (len(values),), lambda: values, unit, clock)


def _abscissa(one: dict[str, Any]) -> Held:
    """The abscissa of the first set, at its rounded rate where it is even in time."""
    kind, clock = one["abscissa_spec_data_type"], _clock(one)
    unit = _unit(one["abscissa_axis_units_lab"]) or {_TIME: "s", _FREQUENCY: "Hz"}.get(kind)
    values = np.asarray(one["x"])
    if clock is not None:
        values = (clock[0] + np.arange(len(one["data"])) / clock[1]) / to_si(1.0, _seconds(unit), "s")
    return _held("abscissa", values, unit, clock)


def _clock(one: dict[str, Any]) -> tuple[float, float] | None:
    """Start in s and rate in Hz of an even abscissa in time."""
    rate = rate_of(one["abscissa_inc"])
    unit = _seconds(_unit(one["abscissa_axis_units_lab"]))
    in_time = one["abscissa_spec_data_type"] == _TIME and is_of_kind(unit, "s")
    if not in_time or not one["abscissa_spacing"] or rate is None:
        return None
    second = to_si(1.0, unit, "s")
    return float(one["abscissa_min"]) * second, rounded_rate(rate / second)


def _seconds(unit: str | None) -> str:
    """The unit of an abscissa in time, which is s where nothing else is said."""
    return "s" if unit in (None, "sec") else unit


def rounded_rate(rate: float) -> float:
    """The rate with the fewest digits that its increment of six digits allows, as 10240 for 10239.995."""
    shorter = (float(f"{rate:.{digits}g}") for digits in range(1, 8))
    return next((short for short in shorter if abs(short / rate - 1) <= _WRITTEN), rate)


def _unit(label: str) -> str | None:
    label = label.strip()
    return None if label in ("", "NONE") else label


def _name(one: dict[str, Any]) -> str:
    """The first line of the set's description, or "" where there is none."""
    name = one["id1"].strip()
    return "" if name == "NONE" else name
