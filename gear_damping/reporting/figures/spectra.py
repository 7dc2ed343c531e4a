"""Amplitudes over orders or frequencies, with shaft and mesh orders marked."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.arrays import Array, any_finite, series
from gear_damping.reporting.figures.marks import mark_orders
from gear_damping.reporting.style import BLUE, CYCLE, PALE, RED, legend_above, new_figure, say_empty, styled

ORDER_LABEL = "order of the pinion shaft"
FREQUENCY_LABEL = "frequency / Hz"
DECADES = 6  # shown below the highest amplitude
SHOWN_MESH_HARMONICS = 6.4
LOOKS = {
    "measured": {"color": PALE, "linewidth": 0.8, "zorder": 2},
    "before": {"color": RED, "linewidth": 1.0, "zorder": 3},
    "after": {"color": BLUE, "linewidth": 1.0, "zorder": 4},
}


def order_spectrum_figure(
    orders: ArrayLike,
    before: ArrayLike,
    after: ArrayLike | None = None,
    *,
    unit: str,
    quantity: str = "amplitude",
    pinion_order: float = 1.0,
    gear_order: float | None = None,
    mesh_order: float | None = None,
) -> Figure:
    """An order spectrum before and after something was done, with shaft and mesh orders marked.

    Args:
        orders: Cycles per turn of the pinion, ascending, shape (order,).
        before: Amplitudes in `unit`, shape (order,).
        after: The same afterwards; None: there is only one.
        unit: Unit of the amplitudes.
        quantity: What the amplitudes are of.
        pinion_order: Order of the pinion shaft.
        gear_order: Order of the gear shaft.
        mesh_order: Order of the mesh (teeth of the pinion), marked with its harmonics.

    Raises:
        ValueError: the arrays have different shapes.
    """
    spectra = {"before": before} if after is None else {"before": before, "after": after}
    with styled():
        figure = new_figure(4.0)
        axes = figure.subplots()
        axes.set(xlabel=ORDER_LABEL, ylabel=f"{quantity} / {unit}")
        top = draw_spectra(axes, orders, spectra)
        if top:
            mark_orders(axes, top, pinion_order=pinion_order, gear_order=gear_order, mesh_order=mesh_order)
        legend_above(axes, columns=5)
        return figure


def draw_spectra(
    axes: Axes, orders: ArrayLike, spectra: Mapping[str, ArrayLike], highest: float | None = None
) -> float:
    """Lines on a logarithmic axis, up to `highest`; returns the highest order shown, 0 where there is nothing.

    Args:
        axes: Where to draw.
        orders: Orders or frequencies, ascending, shape (order,).
        spectra: Label -> amplitudes, shape (order,); `measured`, `before` and `after` have their own looks.
        highest: End of the axis; None: the last order.
    """
    orders, *amplitudes = series(orders=orders, **spectra)
    positive = [np.where(a > 0, a, np.nan) for a in amplitudes]
    if not any_finite(*positive, [np.nan]) or len(orders) < 2:
        say_empty(axes, "no spectrum to show")
        return 0.0
    for number, (label, values) in enumerate(zip(spectra, positive, strict=True)):
        look = LOOKS.get(label, {"color": CYCLE[number % len(CYCLE)], "linewidth": 0.9})
        axes.plot(orders, values, label=label, **look)
    top = float(orders[-1]) if highest is None else min(highest, float(orders[-1]))
    axes.set(yscale="log", xlim=(0, top), ylim=_limits(orders, positive, top))
    return top


def _limits(orders: Array, amplitudes: list[Array], top: float) -> tuple[float, float]:
    shown = np.concatenate([a[(orders > 0) & (orders <= top)] for a in amplitudes])
    shown = shown[np.isfinite(shown)]
    shown = shown if len(shown) else np.ones(1)
    return max(0.5 * float(shown.min()), float(shown.max()) * 10.0**-DECADES), 2.5 * float(shown.max())
