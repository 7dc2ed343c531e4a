"""One estimate of a cause from every record, beside that of all together."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_damping.reporting.style import BLUE, INK, RED, legend_above, mark_empty, new_figure, styled

MOST_ROWS = 24  # that can be read on one page
MARKER, WIDE = 6, 2.0  # points, of a marker and of a line
TOGETHER = "all records together, with 95 % interval"


def forest_figure(
    rows: Sequence[Mapping[str, Any]], joint: Mapping[str, Any], *, quantity: str, together: str = TOGETHER
) -> Figure:
    """Estimates with 95 % intervals, a row a record, and the interval of the joint fit as a band.

    Args:
        rows: Each with `record`, `value` and `interval95`.
        joint: `value` and `interval95` of all records together.
        quantity: What is estimated, with its unit.
        together: What the joint value and its band are.
    """
    shown = [row for row in rows if np.isfinite([row["value"], *row["interval95"]]).all()][:MOST_ROWS]
    with styled():
        figure = new_figure(1.2 + 0.3 * max(len(shown), 2))
        axes = figure.subplots()
        left_out = len(rows) - len(shown)
        axes.set_xlabel(quantity + (f"      ({left_out} more records not shown)" if left_out else ""))
        if not shown:
            mark_empty(axes, "no record tells it by itself")
            return figure
        low, high = joint["interval95"]
        if np.isfinite([low, high]).all():
            axes.axvspan(low, high, color=BLUE, alpha=0.15, linewidth=0)
        axes.axvline(joint["value"], color=BLUE, label=together)
        for place, row in enumerate(shown):
            ends = row["interval95"]
            apart = ends[1] < low or ends[0] > high
            look = {"color": RED if apart else INK, "marker": "s" if apart else "o"}
            label = "apart from it" if apart else "one record, with 95 % interval"
            axes.hlines(place, *ends, color=look["color"], linewidth=WIDE)
            axes.plot(row["value"], place, linestyle="none", markersize=MARKER, label=label, **look)
        axes.set_yticks(range(len(shown)), labels=[str(row["record"]) for row in shown])
        axes.set_ylim(len(shown) - 0.5, -0.5)
        axes.grid(visible=False, axis="y")
        handles, labels = axes.get_legend_handles_labels()
        legend_above(axes, list(dict(zip(labels, handles, strict=True)).values()), columns=3)
        return figure
