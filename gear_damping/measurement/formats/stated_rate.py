"""The rate that is stated beside a table, above its rows or as an attribute: `Sample Interval,4e-05,s`, `fs: 2 kHz`."""

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.formats.rate_units import Size, number_said, samples_a_time, size_said

_END = r"(?:\b|(?=_(?:ns|us|ms|s|hz|khz|mhz)\b))"  # of a name, before its unit too: `dt_us`
_STEP = re.compile(
    r"\b(delta[ _]?[tx]|d[tx]|t ?interval|[tx][ _]?inc(r(ement)?)?|x-axis delta|"
    r"(samp(le|ling)|time|horizontal|record|abtast)[ _-]?(interval\w*|period\w*|increment\w*|step\w*)|"
    r"(abt|t)astzeit|zeitschritt|p[eé]riode d.?[eé]chantillonnage|per[ií]odo de muestreo|"
    r"(periodo|tempo) di campionamento)" + _END,
    re.I,
)  # fmt: skip
_RATE = re.compile(
    r"\b(samp(le|ling)[ _-]?(rate|freq(uency)?)|samples (per|a) second|samples/s(ec)?|sps|fs|srate|odr|"
    r"(abtast|mess|sampling)(rate|frequenz)|fr[eé]quence d.?[eé]chantillonnage|frecuencia de muestreo|"
    r"frequenza di campionamento|"
    r"(update|output|scan|acquisition|logging|frame)[ _-]?(rate|freq(uency)?))" + _END,
    re.I,
)
_ALONE = re.compile(r"(?:^|(?<=[./]))rate(?:_k?hz)?\s*$", re.I)  # of a single number beside arrays: all of its name
_STEP_ALONE = re.compile(
    r"(?:^|(?<=[./]))(Ts|x_values\.increment)\s*$"
)  # of MATLAB, and of its files made by Simcenter
_BARE = re.compile(r"^\s*rate(?=\W*$|\s*[(\[]|\s+in\s)", re.I)  # of the lines above a table: any rate
_SAMPLING = re.compile(r"^\s*(sampling|abtastung|acquisition|sampled (?:at|with)|abgetastet mit)\W*$", re.I)
_UNCLEAR = re.compile(  # above a table: of samples, or of what is driven; of a sample, or of a division of a screen
    r"^\s*(freq(?:uen(?:cy|z))?|fr[eé]quence|frecuencia|frequenza|time ?base|zeitbasis)\W*$", re.I
)
_CLOCK = re.compile(r"^\s*clock\b", re.I)  # Hantek: `#CLOCK:500us`
_SAMPLED = re.compile(r"\bsampl(e|ing)[ _-]?time" + _END, re.I)  # the step, or how long was sampled:
_LONGEST_STEP = 0.1  # s, assumed: records are longer
_LONGEST_UNSAID = 1.0  # assumed: as many and more are no s where nothing says so, but ms or us
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?", re.I)
_WITH_SIGNS = re.compile(  # of decimals, or between thousands; behind a letter or a bracket a comma parts cells
    r"[-+]?(\d+([.,]\d+)*[.,]?|(?<![^\s:=;+\-])[.,]\d+)(e[-+]?\d+)?", re.I
)
_OF_A_NAME = re.compile(r"[^\W\d]")  # before a number that is a part of it, as in `CH1` and `Signal_0`
_SETTING = re.compile(r"\s*[A-Za-z][\w ]*=\s*[-+.\d]")  # a cell of its own: `CH1V,t0 = -0.3,tInc = 5e-04`
_VALUE = ".value"  # the member of a structure beside `unit`
_FRAMES = ["Frame", "Sub Frame"]  # the names of the first columns in tables of Vicon
_LONGEST_NAME = 40  # characters, assumed: what is longer is a sentence
_LONGEST_LINE = 60  # characters of a line that are told


def stated_rate(
    rows: Iterable[Sequence[str]], beside_arrays: bool = False, decimal: str = "."
) -> tuple[str, float] | None:
    """The words that state a rate and the rate in Hz; None where none does, two disagree, or its unit is not read.

    Args:
        rows: The cells of the lines above a table of texts, comments among them, or attributes: a name and its value.
        beside_arrays: Whether they are numbers beside arrays, of which one that is called `rate` is that of these.
        decimal: The decimal sign of the file.
    """
    rows = [*rows]
    if (frames := _of_frames(rows)) is not None:
        return frames
    found = [(words, rate) for words, rate, _ in _stated(rows, beside_arrays, decimal) if rate is not None]
    rates = {f"{rate:.5g}" for _, rate in found}
    return found[0] if len(rates) == 1 else None


def unread_rate(rows: Iterable[Sequence[str]], decimal: str = ".") -> str:
    """The first line that states a rate whose number or unit is not read, as `stated_rate` has its arguments; or ""."""
    return next((line for _, rate, line in _stated([*rows], False, decimal) if rate is None), "")


def _stated(rows: Sequence[Sequence[str]], beside_arrays: bool, decimal: str) -> list[tuple[str, float | None, str]]:
    """Of every line that states a rate its words, the rate in Hz, None where it is not read, and the line."""
    apart = [[cell] for row in rows if len(row) > 1 for cell in row if _SETTING.match(cell)]
    rows = [*rows, *apart, *(pair for above, below in pairwise(rows) for pair in _over_their_values(above, below))]
    return [one for row in rows if (one := _of_row(row, beside_arrays, decimal)) is not None]


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


def _of_row(row: Sequence[str], beside_arrays: bool, decimal: str) -> tuple[str, float | None, str] | None:
    """The words of a line that state a rate, the rate in Hz, None where it is not read, and the line; or None."""
    line = " ".join(cell.strip().strip('"') for cell in row if cell.strip()).lstrip("#%/;*! ")
    number = next((one for one in _WITH_SIGNS.finditer(line) if not _OF_A_NAME.match(line[: one.start()][-1:])), None)
    if number is None:
        return None
    name, behind = line[: number.start()], line[number.end() :]
    if not name.strip() and (samples := samples_a_time(behind)):
        return _measured(behind.strip(), number[0], samples, decimal, line)
    words, is_step = _words(name, beside_arrays)
    if words is None or len(name) > _LONGEST_NAME:
        return None
    others = [number_said(one) for one in behind.split() if _WITH_SIGNS.fullmatch(one)]
    if any(other != number_said(number[0]) for other in others):
        return None  # of each channel its own
    behind = " ".join(one for one in behind.split() if not _WITH_SIGNS.fullmatch(one))
    ends = "_" + words[0].rpartition("_")[2] if "_" in words[0] else ""  # `rate_khz` is a name of two words
    size = size_said(name, ends + name[words.end() :], behind, is_step)
    if words.re is _CLOCK and not (size and size.kind == "s" and size.factor < 1):
        return None  # a time of day, or the clock of a processor
    if words.re is _SAMPLED and not (size and size.kind == "s" and _is_step(number[0], size)):
        return None
    if words.re is _BARE and size is None:
        return None  # a rate of something else
    if words.re in (_SAMPLING, _UNCLEAR) and not (size and size.is_said):
        return None
    if words.re is _SAMPLING and size.kind == "s":
        return None  # how long was sampled
    if words.re is _UNCLEAR or _may_be_smaller(number[0], size):
        size = None
    if words.re is _BARE and not behind.strip() and not name[words.end() :].strip(" \t:="):
        size = None  # any rate: a unit alone tells that it is one of samples
    return _measured(words[0].strip(" \t:="), number[0], size, decimal, line)


def _may_be_smaller(number: str, size: Size | None) -> bool:
    """Whether a step is so long, and bears no unit, that it may as well be in ms."""
    is_unsaid = size is not None and size.kind == "s" and not size.is_said
    return is_unsaid and (number_said(number) or 0.0) >= _LONGEST_UNSAID


def _is_step(number: str, size: Size) -> bool:
    return 0 < size.factor * (number_said(number) or 0) <= _LONGEST_STEP


def _words(name: str, beside_arrays: bool) -> tuple[re.Match[str] | None, bool]:
    """The words of a name that state a rate, or the time from one sample to the next, and whether it is the latter."""
    steps, rates = (_STEP, _CLOCK, _SAMPLED, _STEP_ALONE), (_RATE, _ALONE)
    if not beside_arrays:
        steps, rates = steps[:3], (_RATE, _BARE, _SAMPLING, _UNCLEAR)
    step = next((found for one in steps if (found := one.search(name))), None)
    return step or next((found for one in rates if (found := one.search(name))), None), step is not None


def _measured(
    words: str, number: str, size: Size | None, decimal: str, line: str
) -> tuple[str, float | None, str] | None:
    """The words, the rate in Hz of a number in a unit, and the line; None of what is no rate."""
    value = number_said(number, decimal)
    if size is None or value is None:
        return words, None, line[:_LONGEST_LINE]
    value *= size.factor
    rate = rate_of(value) if size.kind == "s" else value
    return (words, rate, line) if rate is not None and 0 < rate < inf else None


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
        named = (f"{name}_unit", f"{name}_units", *([f"{name[: -len(_VALUE)]}.unit"] * name.endswith(_VALUE)))
        own = next((attributes[u] for u in named if u in attributes), None)
        if own is None and _STEP.search(name):
            own = next((attributes[u] for u in ("time_unit", "time_units") if u in attributes), None)
        return own.decode("utf-8", "replace") if isinstance(own, bytes) else str(own or "")

    return [[name, str(value), unit_of(name)] for name, value in attributes.items() if np.size(value) == 1]


def rate_beside(arrays: Mapping[str, NDArray], texts: Mapping[str, str] | None = None) -> tuple[str, float] | None:
    """The rate that single numbers beside arrays state (`Fs`, `dt`, `rate`), as `stated_rate` has it.

    Args:
        arrays: The arrays of the file by their names, its single numbers among them.
        texts: Its single texts: units of these numbers (`dt_unit`), or a rate with its unit (`fs`, `1 kHz`).
    """
    single = {name: one.item() for name, one in arrays.items() if one.size == 1 and one.dtype.kind in "fiu"}
    return stated_rate(beside_their_units({**single, **(texts or {})}), beside_arrays=True)
