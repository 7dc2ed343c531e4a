"""Cells of the tables: a score with its standard deviation over seeds, in the unit of the paper or in % of critical."""

from collections.abc import Iterable, Mapping, Sequence
from math import floor, log10
from typing import Any

from gear_damping.reporting.numbers import NOTHING
from gear_damping.reporting.paper.printed import RMSE

Found = Mapping[str, Any]  # the content of paper.json
PERCENT = 100.0  # of critical in 1
SMALL = 0.01  # below it numbers have a power of ten, as the paper prints them


def markdown(head: Sequence[str], rows: Iterable[Sequence[str]], left: int = 1) -> str:
    """A table: the first columns to the left, the others to the right."""
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * left + "---:|" * (len(head) - left)]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows)])


def score(found: Found, effect: str, protocol: str, name: str, which: str = "rmse_percent") -> Mapping[str, Any] | None:
    """Mean, std and values of a score; None where there is none."""
    each = found["learned"].get(effect, {}).get(protocol)
    return None if each is None else each["scores"][name][which]


def in_percent(scored: Mapping[str, Any] | None) -> str:
    """In % of critical: `0.112 ± 0.003`."""
    if scored is None:
        return NOTHING
    return f"{scored['mean']:.3f}{_deviation(scored['std'], 3, scored)}"


def as_fraction(scored: Mapping[str, Any] | None) -> str:
    """As a fraction of critical, the way the paper prints: `(8.1 ± 0.3)·10⁻⁴`."""
    if scored is None:
        return NOTHING
    mean, std = scored["mean"] / PERCENT, scored["std"] / PERCENT
    if mean == 0:
        return "0"
    if mean >= SMALL:
        return f"{mean:.3f}{_deviation(std, 3, scored)}"
    power = floor(log10(mean))
    return f"({mean / 10**power:.2f}{_deviation(std / 10**power, 2, scored)})·10{superscript(power)}"


def printed(name: str, network: str) -> str:
    """An error as the paper has it; a dash for what it does not have."""
    value = RMSE[name].of(network) if name in RMSE else None
    if value is None:
        return NOTHING
    if value >= 1e-3:
        return f"{value:g}"
    power = floor(log10(value))
    return f"{value / 10**power:.4g}·10{superscript(power)}"


def plain_number(scored: Mapping[str, Any] | None, decimals: int = 2) -> str:
    """A mean with its deviation."""
    return NOTHING if scored is None else f"{scored['mean']:.{decimals}f}{_deviation(scored['std'], decimals, scored)}"


def percent_of(scored: Mapping[str, Any] | None) -> str:
    """A share in %."""
    return NOTHING if scored is None else f"{PERCENT * scored['mean']:.3g} %"


def _deviation(std: float, decimals: int, scored: Mapping[str, Any]) -> str:
    """What stands behind a mean; nothing of one seed."""
    return f" ± {std:.{decimals}f}" if len(scored["values"]) > 1 else ""


def superscript(power: int) -> str:
    """A power of ten as it is printed."""
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
