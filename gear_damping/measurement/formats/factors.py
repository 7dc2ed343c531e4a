"""Factors beside the unit in the name of a column: steps that it counts in, `x / 10^-6 m`, or `x*1000 [mm]`."""

import re

from gear_damping.units import is_of_kind, multiple_of_a_unit, scaled_unit

_RAISED = "⁺⁻⁰¹²³⁴⁵⁶⁷⁸⁹"
_E = r"(?:1[eE][+\-]?|[eE][+\-])\d+"  # `E1` is a name
_POWER = rf"10(?:\^[+\-]?\d+|[{_RAISED}]+)|{_E}"
_NUMBER = rf"\d[\d.,eE^+\-{_RAISED}]*"
_UNIT = r"(?:[^\W\d_]|[°%])[\w/^°²³*·\-]*"
_IN_BRACKETS = r"[(\[](?P<unit>[^()\[\]]+)[)\]]"
# Of a stroke or a letter powers of ten alone: `CH x2 [V]` is a channel.
_FACTOR = rf"[*×·]\s*{_NUMBER}|(?:/\s*|\sx\s?)10+"
_SCALED = tuple(
    re.compile(pattern)
    for pattern in (
        rf"[(\[](?P<unit>[^()\[\]]+)[)\]]\s*(?P<factor>[*x×·/]\s*{_NUMBER})\s*$",  # `x [mm]*1000`
        rf"{_IN_BRACKETS}\s*[(\[]\s*(?P<factor>[*×·/]\s*{_NUMBER}|x\s?10+)\s*[)\]]\s*$",  # `x [mm] (x10)`
        rf"(?P<factor>{_FACTOR})\s*{_IN_BRACKETS}\s*$",  # `x*1000 [mm]`
        rf"(?P<factor>{_FACTOR})(?:\s*/\s*|\s+in\s+)(?P<unit>{_UNIT})\s*$",  # `x*10^6 / m`
        r"(?P<factor>_x10+)_(?P<unit>[^\W\d_]+)\s*$",  # `x_x100_mm`
        rf"^(?P<factor>{_NUMBER})\s*[*×·]\s*[^\W\d].*{_IN_BRACKETS}\s*$",  # `1000*x [m]`
        rf"^(?P<factor>{_POWER})\s+[^\W\d].*{_IN_BRACKETS}\s*$",  # `10^3 x (m)`
        rf"[(\[]\s*(?P<unit>{_UNIT})\s+(?P<factor>{_POWER})\s*[)\]]\s*$",  # `x [m E-3]`
    )
)
_STEPS = tuple(
    re.compile(pattern)
    for pattern in (
        rf"\s(?:in|/)\s+(?P<number>\d[\d.,/]*)\s*(?P<unit>{_UNIT})\s*$",  # `x in 0.1mm`
        rf"(?:\sin\s+|/\s*)(?P<number>{_POWER})\s*[*·x]?\s*(?P<unit>{_UNIT})\s*$",  # `x / 10^-6 m`
        rf"[(\[]\s*(?P<number>{_E})\s*(?P<unit>{_UNIT})\s*[)\]]\s*$",  # `x [E-3 m]`
        rf"[(\[]\s*[x×*·]\s*(?P<number>\d*\.?\d+)\s*(?P<unit>{_UNIT})\s*[)\]]\s*$",  # `a (x 0.001 g)`
    )
)


def factor_in(name: str) -> str | None:
    """The unit with its factor that a name says, as `multiple_of_a_unit` or `scaled_unit` reads it; None without one.

    What stands before the unit, `10^-6 m`, is a step that the column counts in. Of what stands elsewhere, `mm*1000`,
    nobody knows which way it goes.
    """
    name = name.replace("−", "-").replace("**", "^")
    for pattern in _SCALED:
        found = pattern.search(name)
        unit = found["unit"].strip() if found else ""
        if found and is_of_kind(unit, unit):
            said = f"{unit}*{_plain(found['factor'].lstrip('_*x×· '))}".replace("*/", "/")
            return said if scaled_unit(said) else None
    for pattern in _STEPS:
        found = pattern.search(name)
        said = f"{_plain(found['number'])} {found['unit']}" if found else ""
        if said and multiple_of_a_unit(said):
            return said
    return None


def _plain(number: str) -> str:
    """A number with its exponent in small letters, and a 1 before it."""
    number = number.lower()
    return f"1{number}" if number.startswith("e") else number
