"""The figures of a report with their captions."""

from collections.abc import Iterator, Mapping
from typing import Any

from gear_damping.reporting import figures
from gear_damping.reporting.explanation_report import alt_texts
from gear_damping.reporting.explanation_report.report_input import ReportInput
from gear_damping.reporting.numbers import pretty_unit
from gear_damping.reporting.page.picture import Picture, figure_uri


def overlays(report: ReportInput) -> list[Picture]:
    """Measured, nominal and extended of each record."""
    shown = []
    for one in report.overlays:
        figure = figures.overlay_figure(one, report.unit, report.quantity)
        caption = (
            f"{one.record}: the stretch where the nominal simulation is worst, the residuals there, and all of them."
        )
        alt = alt_texts.overlay(one, report.unit, report.quantity)
        shown.append(Picture(figure_uri(figure), caption, alt))
    return shown


def misfit(report: ReportInput) -> Picture | None:
    """Before and after of each record."""
    found = report.explanation.get("misfit") or {}
    if not found.get("records"):
        return None
    records, floor = found["records"], found.get("floor", 1.0)
    caption = "Held-out records from before to after; at the dashed line only noise is left."
    uri = figure_uri(figures.misfit_figure(records, floor=floor))
    return Picture(uri, caption, alt_texts.misfit(records, floor))


def spectrum(report: ReportInput) -> Picture | None:
    """Where the residual lies in orders or frequencies."""
    found = report.spectrum
    if found is None:
        return None
    caption = f"{found.record or 'Spectrum'}: what the simulation leaves, before and after."
    if found.mesh_order is not None:
        caption += " A line at a shaft's order turns with that shaft, one at a mesh harmonic repeats with every tooth."
    uri = figure_uri(figures.residual_spectrum_figure(found, report.unit))
    return Picture(uri, caption, alt_texts.spectrum(found, report.unit))


def candidates(report: ReportInput) -> Picture | None:
    """What was tried."""
    tried = report.explanation.get("candidates")
    if not tried:
        return None
    misfit = report.explanation.get("misfit") or {}
    rows = [{**row, "share": excess_share(row.get("share"), misfit)} for row in tried]
    figure = figures.candidates_figure(rows, needed_share=report.needed_share)
    caption = (
        "What each effect explains of the excess after its full fit, every condition left out in turn. Only those that "
        "had the largest predicted gain on the fitted records were fitted in full."
    )
    return Picture(figure_uri(figure), caption, alt_texts.candidates(rows, report.needed_share))


def visible(report: ReportInput) -> Picture | None:
    """What stands out of the random part of what the nominal simulation leaves."""
    found = report.explanation.get("visible") or {}
    if not found.get("by_name"):
        return None
    figure = figures.visible_figure(found["by_name"], found["limit"])
    caption = (
        "How visible each effect is in what the nominal simulation leaves of the fitted records, beside its random "
        "part. Of effects that are not there, one bar passes the dashed line in one of a hundred measurements."
    )
    return Picture(figure_uri(figure), caption, alt_texts.visible(found["by_name"], found["limit"]))


def forest(cause: Mapping[str, Any]) -> Picture | None:
    """The size of a cause from every record by itself."""
    rows, parameter = cause.get("per_record"), (cause.get("homogeneous") or {}).get("parameter") or ""
    name = parameter.partition(".")[2]
    joint = (cause.get("parameters") or {}).get(name)
    if not rows or not joint:
        return None
    unit, named = joint.get("unit") or "1", name.replace("_", " ")
    caption = (
        f"The {named} from every record by itself. Where it is one thing that all records show, "
        "their intervals hold the same value."
    )
    said = {}
    if any("@" in other for other in cause["parameters"]) and name == "spread":  # of levels that records have
        joint = {"value": 0.0, "interval95": [-joint["value"], joint["value"]]}
        named = f"{cause['name'].replace('_', ' ')}, off the mean"
        caption = "By how much the coefficient of every record is off the mean one, with 95 % intervals."
        said = {"together": "the mean, with one standard deviation between records"}
    words = named + (f" / {pretty_unit(unit)}" if unit != "1" else "")
    figure = figures.forest_figure(rows, joint, quantity=words, **said)
    return Picture(figure_uri(figure), caption, alt_texts.forest(rows, joint, words))


def excess_share(share: float | None, misfit: dict) -> float | None:
    """The share of the excess over the noise that a share of the whole squared residual is."""
    before, floor = misfit.get("before"), misfit.get("floor", 1.0)
    if share is None or before is None or not before > floor:
        return None
    return share * before / (before - floor)


def residual_forces(report: ReportInput) -> Iterator[Picture]:
    """The force that the simulation misses, as far as it was estimated."""
    if report.force_map is not None:
        caption = (
            "The force that the nominal simulation misses, by pinion tooth and mesh phase: a column is one tooth's, "
            "a row is common to all teeth."
        )
        alt = "Colour map of the missing force: pinion teeth from left to right, the mesh phase from bottom to top."
        yield Picture(figure_uri(figures.residual_force_map_figure(report.force_map)), caption, alt)
    if report.force_surface is not None:
        caption = (
            "The force that the nominal simulation misses, over displacement and velocity: what depends on "
            "displacement is a missing stiffness, what depends on velocity missing damping."
        )
        alt = (
            "Colour map of the missing force, displacement from left to right and velocity from bottom to top; above "
            "it a line chart of its mean over displacement, beside it one over velocity."
        )
        yield Picture(figure_uri(figures.residual_force_surface_figure(report.force_surface)), caption, alt)
