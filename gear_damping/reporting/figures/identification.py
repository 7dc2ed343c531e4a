"""Measured and simulated records of an identified rig, with what the simulation leaves."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gear_damping.reporting.figures.arrays import Array, any_finite, extent, series
from gear_damping.reporting.figures.axis_names import axis
from gear_damping.reporting.style import BLUE, FAINT, INK, RED, legend_above, mark_empty, new_figure, styled

EXCERPT_SAMPLES = 120  # in which single cycles are seen


def identification_figure(
    panels: Sequence[Mapping[str, Any]], unit: str, parameters: Sequence[str], label: str = "response"
) -> Figure:
    """Measured and simulated records, their residuals below, an excerpt of each at the right, parameters in a box.

    Args:
        panels: For each record `name`, `role` (fit or holdout), `time` (s), `measured` and `simulated`, arrays of
            shape (time,) in `unit`.
        unit: Unit of the channel.
        parameters: Lines of text about what was found, for the box.
        label: What the channel is.

    Raises:
        ValueError: the arrays of a record have different shapes.
    """
    with styled():
        box = 0.3 + 0.19 * len(parameters) if parameters else 0.0
        figure = new_figure(box + 2.9 * max(len(panels), 1))
        top, body = figure.subfigures(2, 1, height_ratios=(box, 2.9 * max(len(panels), 1))) if box else (None, figure)
        if top is not None:
            _box(top, parameters)
        heights = (2.2, 1) * max(len(panels), 1)
        grid = body.subplots(len(heights), 2, squeeze=False, width_ratios=(2.6, 1), height_ratios=heights)
        if not panels:
            mark_empty(grid[0][0], "no records to show")
        for number, panel in enumerate(panels):
            _record(grid[2 * number : 2 * number + 2], panel, unit, label)
        body.align_ylabels(grid[:, 0])
        _legend_over_first(grid[0][0], panels)
        return figure


def _legend_over_first(axes: Axes, panels: Sequence[Mapping[str, Any]]) -> None:
    """One legend for all records, over the first one, whose title moves to the right."""
    if panels:
        axes.set_title("")
        axes.set_title(_title(panels[0]), loc="right")
        legend_above(axes)


def _box(figure: Any, parameters: Sequence[str]) -> None:
    """What was found, in a frame of its own."""
    look = {"boxstyle": "round,pad=0.5", "facecolor": "#F7F7F7", "edgecolor": FAINT}
    figure.text(0.02, 0.5, "\n".join(parameters), va="center", ha="left", fontsize=9.5, linespacing=1.4, bbox=look)


def _title(panel: Mapping[str, Any]) -> str:
    role = {"fit": "fitted", "holdout": "held out"}.get(str(panel["role"]), str(panel["role"]))
    return f"{panel['name']} ({role})"


def _record(cells: np.ndarray, panel: Mapping[str, Any], unit: str, label: str) -> None:
    """Overlay above, residual below, at the right an excerpt in which single samples are seen."""
    time, measured, simulated = series(**{name: panel[name] for name in ("time", "measured", "simulated")})
    residual = measured - simulated
    (whole, close), (left, left_close) = cells
    excerpt = _excerpt(time)
    for upper, lower, part in ((whole, left, slice(None)), (close, left_close, excerpt)):
        marker = {"marker": ".", "markersize": 4, "linestyle": "none"} if part is excerpt else {}
        upper.plot(time[part], measured[part], color=INK, linewidth=1.0, label="measured", **marker)
        upper.plot(time[part], simulated[part], color=BLUE, linewidth=0.9, label="simulated")
        lower.plot(time[part], residual[part], color=RED, linewidth=0.8, label="measured - simulated")
        upper.tick_params(labelbottom=False)
        lower.set_xlabel("time / s")
        for axes in (upper, lower):
            limits = extent([time[part]])
            if limits:
                axes.set_xlim(limits)
    whole.set(ylabel=axis(label, unit), title=_title(panel))
    left.set_ylabel(unit)  # its title says what it is
    if any_finite(residual):
        left.set_title(f"residual, RMSE {float(np.sqrt(np.nanmean(residual**2))):.4g} {unit}", fontsize=9, color=RED)
    else:
        mark_empty(whole)


def _excerpt(time: Array) -> slice:
    start = len(time) // 3
    return slice(start, start + max(10, min(EXCERPT_SAMPLES, len(time) // 8)))
