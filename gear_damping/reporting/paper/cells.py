"""Cells of the tables: a score with its spread over seeds, in the unit of the paper or in % of critical."""

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


def in_percent(spread: Mapping[str, Any] | None) -> str:
    """In % of critical: `0.112 ± 0.003`."""
    if spread is None:
        return NOTHING
    return f"{spread['mean']:.3f}{_deviation(spread['std'], 3, spread)}"


def as_fraction(spread: Mapping[str, Any] | None) -> str:
    """As a fraction of critical, the way the paper prints: `(8.1 ± 0.3)·10⁻⁴`."""
    if spread is None:
        return NOTHING
    mean, std = spread["mean"] / PERCENT, spread["std"] / PERCENT
    if mean == 0:
        return "0"
    if mean >= SMALL:
        return f"{mean:.3f}{_deviation(std, 3, spread)}"
    power = floor(log10(mean))
    return f"({mean / 10**power:.2f}{_deviation(std / 10**power, 2, spread)})·10{superscript(power)}"


def printed(name: str, network: str) -> str:
    """An error as the paper has it; a dash for what it does not have."""
    value = RMSE[name].of(network) if name in RMSE else None
    if value is None:
        return NOTHING
    if value >= 1e-3:
        return f"{value:g}"
    power = floor(log10(value))
    return f"{value / 10**power:.4g}·10{superscript(power)}"


def plain_number(spread: Mapping[str, Any] | None, decimals: int = 2) -> str:
    """A mean with its deviation."""
    return NOTHING if spread is None else f"{spread['mean']:.{decimals}f}{_deviation(spread['std'], decimals, spread)}"


def percent_of(spread: Mapping[str, Any] | None) -> str:
    """A share in %."""
    return NOTHING if spread is None else f"{PERCENT * spread['mean']:.3g} %"


def _deviation(std: float, decimals: int, spread: Mapping[str, Any]) -> str:
    """What stands behind a mean; nothing of one seed."""
    return f" ± {std:.{decimals}f}" if len(spread["values"]) > 1 else ""


def superscript(power: int) -> str:
    """A power of ten as it is printed."""
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
