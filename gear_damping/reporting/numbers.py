"""Numbers as an engineer reads them: digits that mean something, units with prefixes."""

import re
from collections.abc import Mapping, Sequence
from math import floor, isfinite, log10
from typing import Any

NOTHING = "–"
_PREFIXED = {"m": ((1e-3, 1e6, "µm"), (1.0, 1e3, "mm")), "s": ((1e-3, 1e6, "µs"), (1.0, 1e3, "ms"))}
_PRINTED = {
    "1": "", "um": "µm", "us": "µs", "deg": "°", "N*m": "N·m", "N*s/m": "N·s/m", "kg*m^2": "kg·m²", "m/s^2": "m/s²",
    "1/s^2": "1/s²",
}  # fmt: skip

_EXPONENT = re.compile(r"e\+?(-?)0*")  # 1e+12 and 1e-07 are printed 1e12 and 1e-7

_PLAIN = (1e-3, 1e5)  # numbers outside are printed with an exponent

Interval = Sequence[float | None] | None


def pretty_unit(unit: str | None) -> str:
    """A unit as it is printed; nothing for a pure number."""
    if not unit:
        return ""
    return _PRINTED.get(unit, unit.replace("*", "·").replace("^2", "²").replace("^3", "³"))


def number(value: float | None, digits: int = 4) -> str:
    """A number with so many digits that count; a dash where there is none."""
    if value is None or not isfinite(value):
        return NOTHING
    text = f"{value:.{digits}g}"
    is_plain = "e" in text and _PLAIN[0] <= abs(value) < _PLAIN[1]  # 9.6e+02 is read as 960
    return f"{float(text):.0f}" if is_plain else _EXPONENT.sub(r"e\1", text)


def quantity(value: float | None, unit: str | None, interval: Interval = None, digits: int = 3) -> str:
    """A value with its unit and, in brackets, its 95 % interval: `20.1 µm (19.8 … 20.4)`.

    Args:
        value: In `unit`; None or not finite: a dash.
        unit: For example `m`, `N*s/m`; lengths and times get a prefix that suits the value.
        interval: Ends of the interval in `unit`, or None; two digits of its width are shown.
        digits: Digits that count where there is no interval.
    """
    if value is None or not isfinite(value):
        return NOTHING
    numbers = [value, *(end for end in interval or () if end is not None and isfinite(end))]
    factor, shown = _prefix(max(map(abs, numbers)), unit or "")
    numbers = [factor * one for one in numbers]
    texts = _alike(numbers) if len(numbers) == 3 else [number(numbers[0], digits)]
    text = f"{texts[0]} {shown}".strip().replace(" °", "°")
    return f"{text} ({texts[1]} … {texts[2]})" if len(texts) == 3 else text


def with_interval(value: float, interval: Sequence[float]) -> tuple[str, str]:
    """A value and `low … high` with the same decimals: four digits of the value, and two of the interval's width."""
    numbers = [value, *interval]
    texts = _alike(numbers) if all(map(isfinite, numbers)) else [number(one) for one in numbers]
    if "e" not in "".join(texts) and NOTHING not in texts:
        decimals = max(len(text.partition(".")[2]) for text in (*texts, number(value)))
        texts = [f"{one:.{decimals}f}" for one in numbers]
    return texts[0], f"{texts[1]} … {texts[2]}"


def _alike(numbers: Sequence[float]) -> list[str]:
    """Value and ends of its interval with the same decimals, so many as show two digits of the width."""
    width, largest = abs(numbers[2] - numbers[1]), max(map(abs, numbers))
    if not width or not _PLAIN[0] <= largest < _PLAIN[1]:
        digits = 3 if not width else max(3, floor(log10(largest)) - floor(log10(width)) + 2)
        return [number(value, digits) for value in numbers]
    decimals = max(0, 1 - floor(log10(width)))
    return [f"{value:.{decimals}f}" for value in numbers]


def estimate(entry: Mapping[str, Any] | None, digits: int = 3) -> str:
    """`quantity` of {value, unit, interval95}; not told by the records, or at the end of its range, it says so."""
    if entry is None:
        return NOTHING
    if entry.get("told") is False:  # its interval is all that it may be, and has no digits that count
        return f"{quantity(entry.get('value'), entry.get('unit'), None, digits)}: not told by these records"
    text = quantity(entry.get("value"), entry.get("unit"), entry.get("interval95"), digits)
    return f"{text}, at the end of its range" if entry.get("at_bound") else text


def percent(share: float | None, digits: int = 3) -> str:
    """A share as a percentage."""
    return NOTHING if share is None or not isfinite(share) else f"{number(100 * share, digits)} %"


def _prefix(value: float, unit: str) -> tuple[float, str]:
    for limit, factor, prefixed in _PREFIXED.get(unit, ()):
        if 0 < value < limit:
            return factor, prefixed
    return 1.0, pretty_unit(unit)
