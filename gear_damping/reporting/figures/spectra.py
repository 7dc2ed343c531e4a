"""Amplitudes over orders or frequencies, with shaft and mesh orders marked."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.arrays import Array, any_finite, series
from gear_damping.reporting.figures.marks import mark_orders
from gear_damping.reporting.style import BLUE, CYCLE, INK, PALE, RED, mark_empty, new_figure, styled

ORDER_LABEL = "order of the pinion shaft"
FREQUENCY_LABEL = "frequency / Hz"
DECADES = 6  # shown below the highest amplitude
SHOWN_MESH_HARMONICS = 6.4  # six, and a little beyond the last
MOST_LEGEND_COLUMNS = 6  # beside each other on one page
LOW_ORDERS = 4.4  # pinion orders of the panel for the shafts
LOOKS = {
    "reference": {"color": PALE, "linewidth": 0.8, "zorder": 2},
    "record": {"color": BLUE, "linewidth": 0.8, "zorder": 3},
    "measured": {"color": PALE, "linewidth": 0.8, "zorder": 2},
    "before": {"color": RED, "linewidth": 0.9, "zorder": 3},
    "after": {"color": BLUE, "linewidth": 0.9, "zorder": 4},
    "noise floor": {"color": INK, "linewidth": 1.1, "linestyle": "--", "zorder": 5},
}

Spectra = Mapping[str, ArrayLike]


def spectra_over_orders(orders: ArrayLike, spectra: Spectra, name: str, marks: Mapping[str, float | None]) -> Figure:
    """A panel of low orders and one of all orders, both with `marks` (see `mark_orders`)."""
    with styled():
        figure = new_figure(4.2)
        low, whole = figure.subplots(1, 2, sharey=True, width_ratios=(1, 2.4))
        low.set(xlabel=ORDER_LABEL, ylabel=name)
        whole.set_xlabel(ORDER_LABEL)
        mesh = marks.get("mesh_order")
        highest = SHOWN_MESH_HARMONICS * mesh if mesh else None
        top = draw_spectra(whole, orders, spectra, highest)
        if top:
            draw_spectra(low, orders, spectra, LOW_ORDERS * (marks.get("pinion_order") or 1.0), marker=".")
            low.set_ylim(_limits(*_positive(orders, spectra), top))
            mark_orders(whole, top, **marks)
            mark_orders(low, low.get_xlim()[1], **{**marks, "mesh_order": None})
        low.set_title("orders of the shafts")
        _common_legend(figure, low, whole)
        return figure


def draw_spectra(
    axes: Axes, orders: ArrayLike, spectra: Spectra, highest: float | None = None, marker: str | None = None
) -> float:
    """Lines on a logarithmic axis, up to `highest`; returns the highest order shown, 0 where there is nothing.

    Args:
        axes: Where to draw.
        orders: Orders or frequencies, ascending, shape (order,).
        spectra: Label -> amplitudes, shape (order,); those of `LOOKS` have looks of their own.
        highest: End of the axis; None: the last order.
        marker: Marker of the single lines.
    """
    orders, positive = _positive(orders, spectra)
    if len(orders) < 2 or not any_finite(*positive):
        mark_empty(axes, "no spectrum to show")
        return 0.0
    for number, (label, values) in enumerate(zip(spectra, positive, strict=True)):
        look = LOOKS.get(label, {"color": CYCLE[number % len(CYCLE)], "linewidth": 0.9})
        axes.plot(orders, values, label=label, marker=marker, markersize=4, **look)
    top = float(orders[-1]) if highest is None else min(highest, float(orders[-1]))
    axes.set(yscale="log", xlim=(0, top), ylim=_limits(orders, positive, top))
    return top


def _positive(orders: ArrayLike, spectra: Spectra) -> tuple[Array, list[Array]]:
    orders, *amplitudes = series(orders=orders, **spectra)
    return orders, [np.where(a > 0, a, np.nan) for a in amplitudes]


def _limits(orders: Array, amplitudes: list[Array], top: float) -> tuple[float, float]:
    shown = np.concatenate([a[(orders > 0) & (orders <= top)] for a in amplitudes])
    shown = shown[np.isfinite(shown)]
    shown = shown if len(shown) else np.ones(1)
    return max(0.5 * float(shown.min()), float(shown.max()) * 10.0**-DECADES), 2.5 * float(shown.max())


def _common_legend(figure: Figure, *panels: Axes) -> None:
    """One legend over all panels, each label once."""
    found = {}
    for axes in panels:
        handles, labels = axes.get_legend_handles_labels()
        found |= {label: handle for label, handle in zip(labels, handles, strict=True) if label not in found}
    if found:
        columns = len(found) if len(found) <= MOST_LEGEND_COLUMNS else -(-len(found) // 2)
        figure.legend(handles=list(found.values()), loc="outside upper left", ncols=columns, columnspacing=1.3)
