"""Held-out misfit of each record before and after, beside the floor."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from gear_damping.reporting.style import BLUE, INK, PALE, RED, legend_above, mark_empty, new_figure, styled

MOST_FINE_RANGE = 2000.0  # of an axis with 1, 2, 5 in every decade
MARKER = 0.02  # of the axis: more than half a marker, which is drawn whole at its ends


def misfit_figure(records: Mapping[str, Mapping[str, float | None]], *, floor: float = 1.0) -> Figure:
    """Mean squared residual over the noise variance, a line a record from before to after, beside the floor.

    Args:
        records: Name -> {`before`, `after`}; None or not finite: not known. A record of which `after` is
            missing has its `before` only.
        floor: Misfit that noise alone would leave.
    """
    names = list(records)
    before, after = (np.array([_number(records[n].get(key)) for n in names]) for key in ("before", "after"))
    places = np.arange(len(names))
    with styled():
        figure = new_figure(1.1 + 0.3 * max(len(names), 2))
        axes = figure.subplots()
        axes.set_xlabel("mean squared residual / noise variance")
        if not np.isfinite([*before, *after]).any():
            mark_empty(axes, "no misfit to show")
            return figure
        axes.hlines(places, after, before, color=PALE, linewidth=2, zorder=1)
        axes.plot(before, places, "o", color=RED, label="before (nominal)", markersize=7)
        axes.plot(after, places, "D", color=BLUE, label="after (extended)", markersize=6)
        axes.axvline(floor, color=INK, linestyle="--", linewidth=1.0, label="floor: noise alone")
        axes.set_yticks(places, labels=names)
        known = np.array([floor, *before, *after])
        least, most = np.nanmin(known), np.nanmax(known)
        room = max(1.15, (most / least) ** MARKER)
        limits = (least / room, max(most * room, 2.2 * floor))
        axes.set(xscale="log", xlim=limits, ylim=(len(names) - 0.5, -0.5))
        wide = limits[1] / limits[0] > MOST_FINE_RANGE
        axes.xaxis.set_major_locator(LogLocator() if wide else LogLocator(subs=(1, 2, 5)))
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.xaxis.set_minor_locator(NullLocator())
        axes.grid(visible=False, axis="y")
        legend_above(axes)
        return figure


def _number(value: float | None) -> float:
    return float(value) if value is not None and np.isfinite(value) and value > 0 else float("nan")
