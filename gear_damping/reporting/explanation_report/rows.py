"""The rows of the report's tables, as text."""

from collections.abc import Mapping
from math import isfinite
from typing import Any

from gear_damping.reporting.explanation_report.report_input import ReportInput
from gear_damping.reporting.explanation_report.vocabulary import description, meaning, words
from gear_damping.reporting.numbers import NOTHING, estimate, number, percent, quantity

ROLES = {"fit": "fitted", "holdout": "held out"}
Row = tuple[str, ...]


def records(report: ReportInput) -> list[Row]:
    """Record, role, misfit before, after and floor."""
    misfit = report.explanation.get("misfit") or {}
    floor = misfit.get("floor", 1.0)
    rows = [_record_row(name, entry, floor) for name, entry in (misfit.get("records") or {}).items()]
    if has_total(report):
        rows.append(_record_row("all held-out records", {"role": "holdout", **misfit}, floor))
    return rows


def has_total(report: ReportInput) -> bool:
    """Whether the last of `records` is that of all held-out records together."""
    misfit = report.explanation.get("misfit") or {}
    return bool(misfit.get("records")) and misfit.get("before") is not None


def _record_row(name: str, entry: Mapping[str, Any], floor: float) -> Row:
    misfits = (number(entry.get(key), 3) for key in ("before", "after"))
    role = str(entry.get("role", "holdout"))
    return (name, ROLES.get(role, role), *misfits, number(entry.get("floor", floor), 3))


def residuals(report: ReportInput) -> list[Row]:
    """Role, RMSE before and after."""
    rows = []
    for role, entry in (report.explanation.get("residual") or {}).items():
        if entry:
            values = (quantity(entry.get(key), entry.get("unit")) for key in ("before", "after"))
            rows.append((f"{ROLES.get(role, role)} records", *values))
    return rows


def cause_parameters(cause: Mapping[str, Any]) -> list[Row]:
    """Parameter, value with interval, meaning."""
    given = cause.get("parameters") or {}
    return [(words(name), estimate(entry), meaning(cause["name"], name)) for name, entry in given.items()]


def parameters(report: ReportInput) -> list[Row]:
    """Parameter, before, after."""
    rows = [(words(n), estimate(e.get("before")), estimate(e.get("after"))) for n, e in report.parameters.items()]
    damping = (report.explanation.get("gain") or {}).get("damping_ratio_percent") or {}
    if damping:
        entries = ({**damping[key], "unit": "%"} if damping.get(key) else None for key in ("before", "after"))
        rows.insert(0, ("damping ratio, % of critical", *map(estimate, entries)))
    return rows


def not_observable(report: ReportInput) -> list[Row]:
    """Effect, smallest size that would have shown, what it is."""
    rows = []
    for entry in report.explanation.get("not_observable") or ():
        smallest = entry.get("smallest")
        visible = smallest is not None and isfinite(smallest)
        size = quantity(smallest, entry.get("unit"), digits=2) if visible else "not at any size"
        rows.append((words(entry["name"]), size, description(entry["name"], report.descriptions)))
    return rows


def noise(report: ReportInput) -> list[Row]:
    """Channel, level, how it was found."""
    rows = []
    for channel, entry in (report.explanation.get("noise") or {}).items():
        if isinstance(entry, Mapping):
            level = quantity(entry.get("level"), entry.get("unit"))
            rows.append((words(channel), level, str(entry.get("method", ""))))
        else:
            rows.append((words(channel), NOTHING, str(entry)))
    return rows


def unexplained(report: ReportInput) -> list[Row]:
    """What is known of the rest: feature, finding."""
    rest = report.explanation.get("unexplained")
    if not rest:
        return []
    if not isinstance(rest, Mapping):
        return [("the rest", str(rest))]
    return [(words(key), _said(value, share=key in ("share", "families"))) for key, value in rest.items() if value]


def _said(value: Any, *, share: bool) -> str:
    if isinstance(value, Mapping):
        return "; ".join(f"{words(str(key))}: {_said(part, share=share)}" for key, part in value.items())
    if isinstance(value, (list, tuple)):
        return ", ".join(_said(part, share=share) for part in value)
    if isinstance(value, float):
        return percent(value) if share else number(value)
    return str(value)
