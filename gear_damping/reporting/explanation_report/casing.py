"""The part of the report that shows what was heard through a casing."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_damping.explanation.casing.cycles import SHAFTS
from gear_damping.explanation.casing.study import Study
from gear_damping.reporting import figures
from gear_damping.reporting.explanation_report.report_input import ReportInput
from gear_damping.reporting.numbers import number, pretty_unit, quantity
from gear_damping.reporting.page.picture import Picture, figure_uri
from gear_damping.reporting.page.render import words

Row = tuple[str, ...]


@dataclass(frozen=True)
class RecordShown:
    """What the page says of one record."""

    name: str
    findings: list[Row]
    lines: list[Row]
    figures: list[Picture]


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


def _figures(one: Study, reference: Study | None, findings: list[Mapping[str, Any]]) -> list[Picture]:
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
    unit = pretty_unit(one.heard.unit)
    drawn = [
        (_orders(one, reference), said_orders, _alt_of_orders(one, unit)),
        (figures.casing_turns_figure(turns, unit=unit), said_turns, _alt_of_turns(turns, unit)),
        (kurtosis, said_kurtosis, _alt_of_kurtosis(one)),
    ]
    return [Picture(figure_uri(figure), said + beside, alt) for figure, said, alt in drawn]


def _alt_of_orders(one: Study, unit: str) -> str:
    peak = int(np.nanargmax(one.amplitude))
    return (
        f"Line chart of the amplitude in {unit} over the order of the pinion; the largest line has "
        f"{number(float(one.amplitude[peak]), 3)} {unit} at order {number(float(one.orders[peak]), 4)}."
    )


def _alt_of_turns(turns: Mapping[str, figures.Turn], unit: str) -> str:
    largest = [f"of the {s} {number(float(np.nanmax(np.abs(turn.residual))), 3)} {unit}" for s, turn in turns.items()]
    shown = ", ".join(largest)
    return f"Line charts of the residual over one turn of each shaft; the largest deviation {shown}."


def _alt_of_kurtosis(one: Study) -> str:
    above = int(np.sum(np.asarray(one.kurtosis) > one.kurtosis_limit))
    return (
        f"Kurtosis of each of {len(one.kurtosis)} turns of the pinion; {above} lie above the limit of "
        f"{number(one.kurtosis_limit, 3)}."
    )


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
