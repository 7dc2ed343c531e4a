"""The report of task=identify: damping from measured records, by a fit, by estimators of records or by a network."""

import re
from collections.abc import Mapping
from typing import Any

from gear_damping.reporting.numbers import NOTHING, estimate, number, pretty_unit, quantity, with_interval
from gear_damping.reporting.page.picture import Picture
from gear_damping.reporting.page.render import words
from gear_damping.reporting.page.table import Table
from gear_damping.reporting.run_report.report_schema import DOUBTFUL, FINE, Left, RunReport, Section

PART = re.compile(r" \((first|last) part\)$")  # of a record that was cut to be fitted and held out
ROLES = {"fit": "fitted", "holdout": "held out"}
SCALARS = ("damping_ratio_percent", "natural_frequency_hz", "log_decrement")


def report_of(left: Left) -> RunReport:
    """What an identification has come to."""
    content = left.read("damping.json")
    if content is not None:
        return _of_estimators(left, content)
    content = left.read("identification.json")
    return _of_network(left, content) if content["method"] == "network" else _of_fit(left, content)


def _title(content: Mapping[str, Any]) -> str:
    names = list(dict.fromkeys(PART.sub("", name) for name in content["records"]))
    return f"Damping of {len(names)} records" if len(names) != 1 else f"Damping of record {names[0]}"


def _of_fit(left: Left, content: Mapping[str, Any]) -> RunReport:
    known = {key: content[key] for key in SCALARS if content.get(key)}
    entries = known | dict(content["parameters"])
    values = Table(
        "What the fit says, with 95 % intervals.", ("quantity", "value"), [_parameter(*e) for e in entries.items()]
    )
    rows = [
        (name, ROLES.get(one["role"], one["role"]), quantity(one["rmse"], one["unit"]))
        for name, one in content["records"].items()
    ]
    records = Table("Root mean square of what the fit leaves.", ("record", "role", "residual"), rows, [2])
    lead, doubts = [_lead(known)], []
    if not content.get("converged", True):
        doubts.append("The search did not converge: take the figures as a first guess.")
    for said in filter(None, map(content.get, ("undamped", "not_yet_free", "differing", "contradicted", "too_short"))):
        doubts.append(f"{said[0].upper()}{said[1:].rstrip('.')}.")
    lacking = content.get("lack_of_fit")
    if lacking and lacking.get("significant"):
        doubts.append(
            "More than noise is left: the intervals hold for this model, and the model is not the whole truth. "
            "`task=explain` looks for what it misses."
        )
    sections = [Section("Figures", (), [values]), Section("What is left", (), [records], _overlay(left, content))]
    return RunReport("Identification", _title(content), lead + doubts, DOUBTFUL if doubts else FINE, sections)


def _lead(known: Mapping[str, Mapping[str, Any]]) -> str:
    ratio, frequency = known.get("damping_ratio_percent"), known.get("natural_frequency_hz")
    if ratio is None:
        return "No damping ratio can be stated: nothing is critical."
    text = f"Damping ratio {estimate(ratio)} of critical"
    return f"{text}; natural frequency {estimate(frequency)}." if frequency else f"{text}."


def _parameter(name: str, entry: Mapping[str, Any]) -> tuple[str, str]:
    return words(name.removesuffix("_percent").removesuffix("_hz")), estimate(entry)


def _overlay(left: Left, content: Mapping[str, Any]) -> list[Picture]:
    said = [f"{name} {quantity(one['rmse'], one['unit'])}" for name, one in content["records"].items()]
    alt = f"Line charts of measured and simulated records over time, with their residuals: {'; '.join(said)}."
    return left.picture("identification.png", "Measured records, what the fit makes of them, and what is left.", alt)


def _of_estimators(left: Left, content: Mapping[str, Any]) -> RunReport:
    rows, silent, doubts = [], {}, []
    laws = content.get("laws") or {}
    for record, found in content["records"].items():
        for name, one in (found | laws.get(record, {})).items():
            if one["damping_ratio_percent"] is None:
                silent.setdefault((name, one.get("unsuited") or ""), []).append(record)
            else:
                rows.append((record, f"`{name}`", *_told(one, content["channels"][record]["unit"])))
                doubts += [f"`{name}` of {record} is in doubt: {one['doubt']}."] if one.get("doubt") else []
    headings = ("record", "estimator", "damping ratio / %", "95 % interval", "frequency / Hz", "amplitudes")
    table = Table("Damping ratio in % of critical by each estimator.", headings, rows, [2, 3, 4, 5])
    notes = [f"`{name}` says nothing of {', '.join(records)}: {why}." for (name, why), records in silent.items()]
    notes += doubts
    ratios = [float(row[2]) for row in rows]
    lead = (
        f"Damping ratio {number(min(ratios), 3)} … {number(max(ratios), 3)} % of critical, by record and estimator."
        if ratios
        else "No estimator suits these records."
    )
    names = ", ".join(content["records"])
    alt = f"Damping ratio in % of critical over the amplitude, with 95 % bands, a panel a record: {names}. {lead}"
    caption = "Damping against amplitude. Where it rises or falls, damping is not viscous."
    section = Section("Record by record", notes, [table], left.picture("damping.png", caption, alt))
    return RunReport("Identification", _title(content), [lead], FINE if ratios else DOUBTFUL, [section])


def _told(one: Mapping[str, Any], unit: str) -> tuple[str, ...]:
    value, ends = one["damping_ratio_percent"], one.get("interval95") or (None, None)
    sizes = [number(size, 3) for size in one.get("amplitudes") or ()]
    return (
        *((number(value), NOTHING) if None in ends else with_interval(value, ends)),
        number(one.get("frequency_hz")),
        f"{' … '.join(sizes)} {pretty_unit(unit)}" if sizes else NOTHING,
    )


def _of_network(left: Left, content: Mapping[str, Any]) -> RunReport:
    headings = ("record", "damping ratio / %", "95 % interval", "deviation / %", "outside of the training")
    rows = []
    for name, one in content["records"].items():
        low, high = one.get("interval95") or (None, None)
        interval = NOTHING if low is None else f"{number(low)} … {number(high)}"
        std, outside = number(one.get("spread_percent"), 3), ", ".join(one["outside_training"]) or NOTHING
        rows.append((name, number(one["damping_ratio_percent"]), interval, std, outside))
    table = Table("What the network says, in % of critical.", headings, rows, [1, 2, 3])
    apart = [name for name, one in content["records"].items() if one["outside_training"]]
    lead = [f"Damping ratio {estimate(content['damping_ratio_percent'] | {'unit': '%'})} of critical, by a network."]
    if apart:
        lead.append(
            f"Not to be relied on for {', '.join(apart)}: these lie outside of what the network was trained on."
        )
    return RunReport(
        "Identification", _title(content), lead, DOUBTFUL if apart else FINE, [Section("Record by record", (), [table])]
    )
