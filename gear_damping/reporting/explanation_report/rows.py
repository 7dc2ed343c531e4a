"""The rows of the report's tables, as text."""

from collections.abc import Mapping
from math import isfinite
from typing import Any

from gear_damping.reporting.explanation_report.report_input import ReportInput
from gear_damping.reporting.explanation_report.vocabulary import description, form_of, meaning
from gear_damping.reporting.numbers import estimate, number, percent, quantity
from gear_damping.reporting.page.render import words

ROLES = {"fit": "fitted", "holdout": "held out"}
FAMILIES = {
    "s1": "pinion shaft", "s2": "gear shaft", "k_s1": "harmonics of the pinion shaft", "M": "mesh harmonics",
    "M_half": "half the mesh order", "M_sidebands": "sidebands of the mesh", "mean": "constant",
    "rest": "none of these",
}  # fmt: skip
BURST = "It comes in bursts, as impacts do"
STEADY = "It is spread over the record"
Row = tuple[str, ...]


def records(report: ReportInput) -> list[Row]:
    """Record, role, RMSE before, after and of the noise, misfit before and after; the last row is of all held out."""
    explanation = report.explanation
    misfits = (explanation.get("misfit") or {}).get("records") or {}
    noise = (explanation.get("noise") or {}).get("by_record") or {}
    rows = []
    for name, entry in (explanation.get("records") or {}).items():
        if entry.get("rmse"):
            rows.append(_record(name, entry, noise.get(name), misfits.get(name) or {}))
    total = (explanation.get("residual") or {}).get("holdout")
    if rows and total:
        level = (explanation.get("noise") or {}).get("value")
        rows.append(_record("held out together", {"role": "", "rmse": total}, level, explanation.get("misfit") or {}))
    return rows


def _record(name: str, entry: Mapping[str, Any], noise: float | None, misfit: Mapping[str, Any]) -> Row:
    rmse = entry["rmse"]
    residuals = (quantity(value, rmse.get("unit")) for value in (rmse.get("before"), rmse.get("after"), noise))
    role = str(entry.get("role", ""))
    return (name, ROLES.get(role, role), *residuals, *(number(misfit.get(key), 3) for key in ("before", "after")))


def cause_parameters(cause: Mapping[str, Any]) -> list[Row]:
    """Parameter, value with interval, meaning; the form that was found and what was tried and not fitted come first."""
    given, name = cause.get("parameters") or {}, cause["name"]
    fitted = {key: estimate(entry) for key, entry in given.items()}
    return [(words(key), value, meaning(name, key)) for key, value in (form_of(cause) | fitted).items()]


def parameters(report: ReportInput) -> list[Row]:
    """Parameter, before, after."""
    rows = []
    damping = (report.explanation.get("gain") or {}).get("damping_ratio_percent") or {}
    if damping:
        entries = ({**damping[key], "unit": "%"} if damping.get(key) else None for key in ("before", "after"))
        rows.append(("damping ratio, % of critical", *map(estimate, entries)))
    named = report.parameters.items()
    return rows + [(words(n), estimate(e.get("before")), estimate(e.get("after"))) for n, e in named]


def not_observable(report: ReportInput) -> list[Row]:
    """Effect, smallest size that would have shown, what it is."""
    rows = []
    for entry in report.explanation.get("not_observable") or ():
        smallest, name = entry.get("smallest"), entry["name"]
        size = "not at any size"
        if smallest is not None and isfinite(smallest):
            parameter = words(str(entry.get("parameter", "")).partition(".")[2].partition("[")[0])
            size = f"{parameter} {quantity(smallest, entry.get('unit'), digits=2)}".strip()
        rows.append((words(name), size, description(name, report.descriptions)))
    return rows


def unexplained(report: ReportInput) -> list[Row]:
    """What is known of the rest: feature, share or finding, the largest first."""
    unexplained = report.explanation.get("unexplained") or {}
    rows = [(f"explained by {words(name)}", percent(share, 2)) for name, share in _falling(unexplained.get("shares"))]
    rows += [
        (f"at the order of: {FAMILIES.get(n, words(n))}", percent(s, 2)) for n, s in _falling(unexplained.get("orders"))
    ]
    line = unexplained.get("line")
    if line:
        order = f", order {number(line['place'], 3)} of the pinion" if line["unit"] == "order" else ""
        kind = "a force" if line["is_force"] else "a line"
        rows.append((f"explained by {kind} at {number(line['hertz'], 3)} Hz{order}", percent(line["share"], 2)))
    phase = unexplained.get("contact_phase") or ()
    if phase and max(phase) > 0:
        place = (max(range(len(phase)), key=phase.__getitem__) + 0.5) / len(phase)
        rows.append(
            ("strongest at the mesh phase", f"{number(place, 2)} of a period, {number(max(phase), 2)} times the mean")
        )
    if "kurtosis" in unexplained:
        rows.append(("kurtosis (noise: 3)", number(unexplained["kurtosis"], 3)))
    return rows


def _falling(shares: Mapping[str, float] | None) -> list[tuple[str, float]]:
    return sorted((shares or {}).items(), key=lambda item: -item[1])


def unexplained_sentence(report: ReportInput) -> str:
    """Whether the rest comes in bursts."""
    bursts = (report.explanation.get("unexplained") or {}).get("bursts")
    return "" if bursts is None else f"{BURST if bursts else STEADY}."


def findings(report: ReportInput) -> list[Row]:
    """Record, channel, finding."""
    listed = report.explanation.get("findings") or ()
    return [(str(f.get("record", "")), words(str(f.get("channel", ""))), str(f["message"])) for f in listed]
