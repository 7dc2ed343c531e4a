"""The rate that is stated beside a table, above its rows or as an attribute: `Sample Interval,4e-05,s`, `fs: 2 kHz`."""

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_damping.units import is_of_kind, to_si

_END = r"(?:\b|(?=_(?:ns|us|ms|s|hz|khz|mhz)\b))"  # of a name, before its unit too: `dt_us`
_STEP = re.compile(
    r"\b(delta[ _]?[tx]|d[tx]|t ?interval|[tx][ _]?incr(ement)?|x-axis delta|"
    r"(samp(le|ling)|time|horizontal|record|abtast)[ _-]?(interval\w*|period\w*|increment\w*|step\w*))" + _END, re.I,
)  # fmt: skip
_RATE = re.compile(
    r"\b(samp(le|ling)[ _-]?(rate|freq(uency)?)|samples (per|a) second|abtast(rate|frequenz)|fs|"
    r"(update|output|scan|acquisition|logging|frame)[ _-]?(rate|freq(uency)?))" + _END,
    re.I,
)
_ALONE = re.compile(r"(?:^|(?<=[./]))rate(?:_k?hz)?\s*$", re.I)  # of a single number beside arrays: all of its name
_STEP_ALONE = re.compile(
    r"(?:^|(?<=[./]))(Ts|x_values\.increment)\s*$"
)  # of MATLAB, and of its files made by Simcenter
_IN_NAME = re.compile(r"_(ns|us|ms|s|hz|khz|mhz)[\s:=]*$", re.I)  # `sample_interval_us`
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?", re.I)
_OF_A_NAME = re.compile(r"[^\W\d]")  # before a number that is a part of it, as in `CH1` and `Signal_0`
_DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)")  # within a cell: one that parts cells is in none
_FRAMES = ["Frame", "Sub Frame"]  # the names of the first columns in tables of Vicon
_LONGEST_NAME = 40  # characters, assumed: what is longer is a sentence


def stated_rate(rows: Iterable[Sequence[str]], beside_arrays: bool = False) -> tuple[str, float] | None:
    """The words that state a rate and the rate in Hz; None where none does, or two of them disagree.

    Args:
        rows: The cells of the lines above a table of texts, comments among them, or attributes: a name and its value.
        beside_arrays: Whether they are numbers beside arrays, of which one that is called `rate` is that of these.
    """
    rows = [*rows]
    if (frames := _of_frames(rows)) is not None:
        return frames
    rows += [pair for above, below in pairwise(rows) for pair in _over_their_values(above, below)]
    found = [one for row in rows if (one := _of_row(row, beside_arrays)) is not None]
    rates = {f"{rate:.5g}" for _, rate in found}
    return found[0] if len(rates) == 1 else None


def _of_frames(rows: Sequence[Sequence[str]]) -> tuple[str, float] | None:
    """The rate in Hz that stands alone below the title of a table of frames (Vicon: `Trajectories`, `100`)."""
    said = [[cell.strip() for cell in row if cell.strip()] for row in rows]
    if len(said) < 3 or [len(row) for row in said[:2]] != [1, 1] or not _NUMBER.fullmatch(said[1][0]):
        return None
    is_named = any(row[: len(_FRAMES)] == _FRAMES for row in said[2:])
    rate = float(said[1][0])
    return (said[0][0], rate) if is_named and 0 < rate < inf else None


def _over_their_values(above: Sequence[str], below: Sequence[str]) -> list[tuple[str, str]]:
    """Names and values where one row holds several of the former and the next one of the latter, one below each."""
    names, values = ([one for cell in row if (one := cell.strip(" \t,;"))] for row in (above, below))
    are_values = len(names) == len(values) > 1 and all(map(_NUMBER.fullmatch, values))
    return list(zip(names, values, strict=True)) if are_values and not any(map(_NUMBER.fullmatch, names)) else []


def _of_row(row: Sequence[str], beside_arrays: bool) -> tuple[str, float] | None:
    cells = (_DECIMAL_COMMA.sub(".", cell.strip().strip('"')) for cell in row if cell.strip())
    text = " ".join(cells).lstrip("#%/;*! ")
    number = next((one for one in _NUMBER.finditer(text) if not _OF_A_NAME.match(text[: one.start()][-1:])), None)
    if number is None:
        return None
    name, behind = text[: number.start()], text[number.end() :].split()
    is_step = _STEP.search(name) or (_STEP_ALONE.search(name) if beside_arrays else None)
    words = is_step or _RATE.search(name) or (_ALONE.search(name) if beside_arrays else None)
    if len(name) > _LONGEST_NAME or words is None:
        return None
    value = float(number[0])
    if any(_NUMBER.fullmatch(other) and float(other) != value for other in behind):
        return None  # of each channel its own
    in_name = (one.lower().replace("hz", "Hz").replace("mHz", "MHz") for one in _IN_NAME.findall(name))
    said = (*re.findall(r"[(\[]([^)\]]+)[)\]]", name), *behind[:1], *in_name)
    unit = next((one for one in said if one), "")
    is_step = is_step and not is_of_kind(unit, "Hz")  # steps at 8 kHz
    size = value * _factor(unit, "s" if is_step else "Hz")
    rate = rate_of(size) if is_step else size
    return (words[0].strip(), rate) if rate is not None and 0 < rate < inf else None


def rate_of(step: Any) -> float | None:
    """The rate of a step that a file states; None of what is no number, or none that a rate is had from."""
    is_number = isinstance(step, (int, float, np.number)) and not isinstance(step, bool)
    if not is_number or not 0 < step < inf:
        return None
    rate = 1 / float(step)
    return rate if rate < inf else None


def beside_their_units(attributes: Mapping[str, Any]) -> list[list[str]]:
    """Attributes of one value, each as its name, its value and the unit that another one gives it (`dt`, `dt_unit`)."""

    def unit_of(name: str) -> str:
        own = next((attributes[u] for u in (f"{name}_unit", f"{name}_units") if u in attributes), None)
        if own is None and _STEP.search(name):
            own = next((attributes[u] for u in ("time_unit", "time_units") if u in attributes), None)
        return own.decode("utf-8", "replace") if isinstance(own, bytes) else str(own or "")

    return [[name, str(value), unit_of(name)] for name, value in attributes.items() if np.size(value) == 1]


def rate_beside(arrays: Mapping[str, NDArray]) -> tuple[str, float] | None:
    """The rate that single numbers beside arrays state (`Fs`, `dt`, `rate`), as `stated_rate` has it."""
    single = {name: one.item() for name, one in arrays.items() if one.size == 1 and one.dtype.kind in "fiu"}
    return stated_rate(beside_their_units(single), beside_arrays=True)


def _factor(unit: str, plain: str) -> float:
    """The size of a unit, of the plain one where it is none of its kind: something else stands there."""
    return to_si(1.0, unit, plain) if is_of_kind(unit, plain) else 1.0
