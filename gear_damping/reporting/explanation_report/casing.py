"""The part of the report that shows what was heard through a casing."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_damping.explanation.casing.cycles import SHAFTS
from gear_damping.explanation.casing.study import Study
from gear_damping.reporting import figures
from gear_damping.reporting.explanation_report.data_uri import figure_uri
from gear_damping.reporting.explanation_report.evidence import Shown
from gear_damping.reporting.explanation_report.report_input import ReportInput
from gear_damping.reporting.explanation_report.vocabulary import words
from gear_damping.reporting.numbers import number, pretty_unit, quantity

Row = tuple[str, ...]


@dataclass(frozen=True)
class RecordShown:
    """What the page says of one record."""

    name: str
    findings: list[Row]
    lines: list[Row]
    figures: list[Shown]


@dataclass(frozen=True)
class CasingShown:
    """What the page says of a casing."""

    families: list[Row]
    records: list[RecordShown]
    changed: list[Row]


def shown(report: ReportInput) -> CasingShown | None:
    """Families, findings and figures; None where no casing was heard."""
    content, heard = report.explanation.get("casing"), report.casing
    if not content or heard is None:
        return None
    reference = heard.references[0] if heard.references else None
    records = [
        RecordShown(
            one.heard.name,
            [_finding(entry) for entry in content["findings"] if entry["record"] == one.heard.name],
            [_line(entry) for entry in content["records"][one.heard.name]["lines"]],
            _figures(one, reference, content["findings"]),
        )
        for one in heard.records
    ]
    families = [
        (f["name"], "yes" if f["flagged"] else "no", number(f["p"], 2), number(f["limit"], 2), ", ".join(f["records"]))
        for f in content["families"]
    ]
    return CasingShown(families, records, [_change(entry) for entry in content["what_changed"] or ()])


def _finding(entry: Mapping[str, Any]) -> Row:
    figures = (number(entry[key], 3) for key in ("order", "value", "p", "limit"))
    return (entry["family"], words(entry["statistic"]), *figures, entry["sentence"])


def _line(entry: Mapping[str, Any]) -> Row:
    sizes = (quantity(entry[key], entry["unit"]) for key in ("amplitude", "floor"))
    return (entry["what"], number(entry["order"]), *sizes)


def _change(entry: Mapping[str, Any]) -> Row:
    levels = (quantity(entry[key], entry["unit"]) for key in ("reference", "now"))
    return (
        entry["record"], entry["what"], *levels, number(entry["factor"], 3), number(entry["p"], 2), entry["sentence"],
    )  # fmt: skip


def _figures(one: Study, reference: Study | None, findings: list[Mapping[str, Any]]) -> list[Shown]:
    beside = "" if reference is None else f" Grey: the reference, {reference.heard.name}."
    flagged = {
        entry["shaft"]: entry
        for entry in findings
        if entry["record"] == one.heard.name and entry["flagged"] and entry["statistic"] == "one_tooth_stands_out"
    }
    kurtosis = figures.casing_kurtosis_figure(
        one.kurtosis, one.kurtosis_limit, None if reference is None else reference.kurtosis
    )
    turns = {shaft: _turn(one, reference, shaft, flagged.get(shaft)) for shaft in SHAFTS}
    said_turns = (
        "The average over the turns of each shaft, without the mesh and with the ringing of the path "
        "shortened: sound teeth differ without order, one bad tooth makes a burst."
    )
    said_kurtosis = "Kurtosis of each turn of the pinion without the mesh: bursts raise it above 3, that of noise."
    said_orders = "The casing over orders: sidebands at a shaft's order beside the mesh harmonics turn with that shaft."
    return [
        _shown(_orders(one, reference), said_orders + beside),
        _shown(figures.casing_turns_figure(turns, unit=pretty_unit(one.heard.unit)), said_turns + beside),
        _shown(kurtosis, said_kurtosis + beside),
    ]


def _orders(one: Study, reference: Study | None) -> Figure:
    amplitude = None
    if reference is not None:
        amplitude = np.interp(one.orders, reference.orders, reference.amplitude, right=np.nan)
    marks = {"gear_order": one.heard.orders["gear"], "mesh_order": one.heard.orders["mesh"]}
    unit = pretty_unit(one.heard.unit)
    return figures.casing_orders_figure(one.orders, one.amplitude, amplitude, unit=unit, **marks)


def _turn(one: Study, reference: Study | None, shaft: str, entry: Mapping[str, Any] | None) -> figures.Turn:
    own, teeth = one.averages[shaft], one.heard.teeth[shaft == "gear"]
    window = None
    if entry is not None:
        window = (entry["tooth"] / teeth, (entry["tooth"] + entry["window_mesh_periods"]) / teeth)
    if reference is None:
        return figures.Turn(own.turn, own.residual, window)
    other = reference.averages[shaft]
    return figures.Turn(own.turn, own.residual, window, other.turn, other.residual)


def _shown(figure: Figure, caption: str) -> Shown:
    return Shown(figure_uri(figure), caption)
