"""What each candidate explains."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from gear_damping.reporting.style import BLUE, INK, ORANGE, PALE, SKY, mark_empty, new_figure, styled

MOST_BARS = 14  # that can be read on one page
STATUSES = {
    "established": (BLUE, "", "established"),
    "confusable": (SKY, "///", "confusable with an established one"),
    "suggested": (ORANGE, "...", "suggested"),
    "rejected": (PALE, "", "not validated"),
    "not_tried": (PALE, "xxx", "no time to try it"),
}
NEEDED = {"color": INK, "linewidth": 1.0, "linestyle": "--"}

Row = tuple[str, float, str]  # name, share in %, status


def candidates_figure(candidates: Sequence[Mapping[str, Any]], *, needed_share: float | None = None) -> Figure:
    """Bars of the candidates with the share of the excess that each explains, the largest on top.

    Args:
        candidates: Each with `name`, `share` (1 = the whole excess; below 0 it makes what is left out worse;
            None or NaN: not fitted) and `status`, one of established, confusable, suggested,
            rejected, not_tried.
        needed_share: Share that a cause must take to be accepted, marked by a line.

    Raises:
        ValueError: a status is unknown.
    """
    rows = sorted(map(_row, candidates), key=lambda row: -np.nan_to_num(row[1], nan=-np.inf))
    shown, left_out = rows[:MOST_BARS], rows[MOST_BARS:]
    with styled():
        figure = new_figure(1.2 + 0.31 * max(len(shown), 3))
        axes = figure.subplots()
        rest = f"      ({len(left_out)} smaller ones not shown)" if left_out else ""
        axes.set_xlabel(f"share of the excess explained on left-out records / %{rest}")
        if not shown:
            mark_empty(axes, "no candidates were tried")
            return figure
        _bars(axes, shown)
        if needed_share is not None:
            axes.axvline(100 * needed_share, **NEEDED)
        handles = _legend({status for _, _, status in shown}, needed_share)
        figure.legend(handles=handles, loc="outside upper left", ncols=3)
        return figure


def _row(candidate: Mapping[str, Any]) -> Row:
    share, status = candidate.get("share"), candidate.get("status", "rejected")
    if status not in STATUSES:
        raise ValueError(f"status of {candidate['name']!r} is {status!r}: choose one of {', '.join(STATUSES)}")
    known = share is not None and np.isfinite(share)
    return str(candidate["name"]), 100 * float(share) if known else float("nan"), status


def _bars(axes: Axes, rows: Sequence[Row]) -> None:
    for place, (_, share, status) in enumerate(rows):
        colour, hatch, _ = STATUSES[status]
        axes.barh(place, np.nan_to_num(share), color=colour, hatch=hatch, edgecolor="white", height=0.72)
        words = "not fitted" if np.isnan(share) else f"{share:.3g} %"
        end = (max(float(np.nan_to_num(share)), 0.0), place)
        axes.annotate(words, end, (4, 0), textcoords="offset points", va="center", fontsize=9)
    finite = [share for _, share, _ in rows if np.isfinite(share)] or [0.0]
    axes.set_xlim(min(1.15 * min(finite), 0.0), 1.15 * max(*finite, 10.0))
    axes.set_yticks(range(len(rows)), labels=[name.replace("_", " ") for name, _, _ in rows])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")
    axes.axvline(0, color=INK, linewidth=0.8)


def _legend(statuses: set[str], needed_share: float | None) -> list[Patch | Line2D]:
    handles: list[Patch | Line2D] = [
        Patch(facecolor=colour, hatch=hatch, edgecolor="white", label=words)
        for status, (colour, hatch, words) in STATUSES.items()
        if status in statuses
    ]
    return handles if needed_share is None else [*handles, Line2D([], [], label="needed to be accepted", **NEEDED)]
