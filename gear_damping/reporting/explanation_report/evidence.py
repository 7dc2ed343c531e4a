"""The figures of a report with their captions."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

from gear_damping.reporting import figures
from gear_damping.reporting.explanation_report.data_uri import figure_uri
from gear_damping.reporting.explanation_report.report_input import ReportInput
from gear_damping.reporting.numbers import pretty_unit


@dataclass(frozen=True)
class Shown:
    """A figure in the page.

    Args:
        uri: The picture.
        caption: What to see in it, in one or two sentences.
    """

    uri: str
    caption: str


def overlays(report: ReportInput) -> list[Shown]:
    """Measured, nominal and extended of each record."""
    shown = []
    for one in report.overlays:
        figure = figures.overlay_figure(one, report.unit, report.quantity)
        caption = (
            f"{one.record}: the stretch where the nominal simulation is worst, the residuals there, and all of them."
        )
        shown.append(_shown(figure, caption))
    return shown


def misfit(report: ReportInput) -> Shown | None:
    """Before and after of each record."""
    found = report.explanation.get("misfit") or {}
    if not found.get("records"):
        return None
    figure = figures.misfit_figure(found["records"], floor=found.get("floor", 1.0))
    return _shown(figure, "Held-out records from before to after; at the dashed line only noise is left.")


def spectrum(report: ReportInput) -> Shown | None:
    """Where the residual lies in orders or frequencies."""
    found = report.spectrum
    if found is None:
        return None
    caption = f"{found.record or 'Spectrum'}: what the simulation leaves, before and after."
    if found.mesh_order is not None:
        caption += " A line at a shaft's order turns with that shaft, one at a mesh harmonic repeats with every tooth."
    return _shown(figures.residual_spectrum_figure(found, report.unit), caption)


def candidates(report: ReportInput) -> Shown | None:
    """What was tried."""
    tried = report.explanation.get("candidates")
    if not tried:
        return None
    misfit = report.explanation.get("misfit") or {}
    rows = [{**row, "share": excess_share(row.get("share"), misfit)} for row in tried]
    figure = figures.candidates_figure(rows, needed_share=report.needed_share)
    caption = (
        "What each effect explains of the excess after its full fit, every condition left out in turn. Only those that "
    )
    return _shown(figure, caption + "promised most on the fitted records were fitted in full.")


def visible(report: ReportInput) -> Shown | None:
    """What stands out of the random part of what the nominal simulation leaves."""
    found = report.explanation.get("visible") or {}
    if not found.get("by_name"):
        return None
    figure = figures.visible_figure(found["by_name"], found["limit"])
    caption = (
        "How visible each effect is in what the nominal simulation leaves of the fitted records, beside its random "
        "part. Of effects that are not there, one bar passes the dashed line in one of a hundred measurements."
    )
    return _shown(figure, caption)


def forest(cause: Mapping[str, Any]) -> Shown | None:
    """The size of a cause from every record by itself."""
    rows, parameter = cause.get("per_record"), (cause.get("homogeneous") or {}).get("parameter") or ""
    name = parameter.partition(".")[2]
    joint = (cause.get("parameters") or {}).get(name)
    if not rows or not joint:
        return None
    unit = joint.get("unit") or "1"
    words = name.replace("_", " ") + (f" / {pretty_unit(unit)}" if unit != "1" else "")
    figure = figures.forest_figure(rows, joint, quantity=words)
    caption = (
        f"The {name.replace('_', ' ')} from every record by itself. Where it is one thing that all records show, "
    )
    return _shown(figure, caption + "their intervals hold the same value.")


def excess_share(share: float | None, misfit: dict) -> float | None:
    """The share of the excess over the noise that a share of the whole squared residual is."""
    before, floor = misfit.get("before"), misfit.get("floor", 1.0)
    if share is None or before is None or not before > floor:
        return None
    return share * before / (before - floor)


def residual_forces(report: ReportInput) -> Iterator[Shown]:
    """The force that the simulation misses, as far as it was estimated."""
    if report.force_map is not None:
        figure = figures.residual_force_map_figure(report.force_map)
        caption = (
            "The force that the nominal simulation misses, by pinion tooth and mesh phase: a column is one tooth's, "
        )
        yield _shown(figure, caption + "a row is common to all teeth.")
    if report.force_surface is not None:
        figure = figures.residual_force_surface_figure(report.force_surface)
        caption = "The force that the nominal simulation misses, over displacement and velocity: what depends on "
        yield _shown(figure, caption + "displacement is a missing stiffness, what depends on velocity missing damping.")


def _shown(figure: Figure, caption: str) -> Shown:
    return Shown(figure_uri(figure), caption)
