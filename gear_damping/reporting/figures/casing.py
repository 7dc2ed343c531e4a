"""What a casing says: order spectrum, one turn of either shaft, kurtosis by revolution, beside a reference."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.arrays import any_finite, series
from gear_damping.reporting.figures.axis_names import axis
from gear_damping.reporting.figures.spectra import spectra_over_orders
from gear_damping.reporting.style import BLUE, INK, PALE, RED, legend_above, mark_empty, new_figure, styled

RECORD = {"color": BLUE, "linewidth": 0.8, "zorder": 3}
REFERENCE = {"color": PALE, "linewidth": 0.8, "zorder": 2}


@dataclass(frozen=True, eq=False)
class Turn:
    """One turn of a shaft, for `casing_turns_figure`.

    Args:
        turn: (n,) turns of the shaft, 0 to 1.
        residual: (n,) average over the turns without the mesh.
        window: Begin and end in turns of what stands out; None: nothing does.
        reference_turn: (m,) as `turn`, of the reference; None: there is none.
        reference: (m,) its residual.
    """

    turn: ArrayLike
    residual: ArrayLike
    window: tuple[float, float] | None = None
    reference_turn: ArrayLike | None = None
    reference: ArrayLike | None = None


def casing_orders_figure(
    orders: ArrayLike,
    amplitude: ArrayLike,
    reference: ArrayLike | None = None,
    *,
    unit: str,
    gear_order: float,
    mesh_order: float,
) -> Figure:
    """The order spectrum of a casing with shaft and mesh orders marked.

    Args:
        orders: Cycles per turn of the pinion, shape (order,).
        amplitude: In `unit`, shape (order,).
        reference: That of the reference at the same orders; None: there is none.
        unit: Of the acceleration.
        gear_order: Turns of the gear per turn of the pinion.
        mesh_order: Teeth of the pinion.

    Raises:
        ValueError: the arrays have different shapes.
    """
    spectra = ({} if reference is None else {"reference": reference}) | {"record": amplitude}
    marks = {"pinion_order": 1.0, "gear_order": gear_order, "mesh_order": mesh_order}
    return spectra_over_orders(orders, spectra, axis("acceleration", unit), marks)


def casing_turns_figure(turns: Mapping[str, Turn], *, unit: str) -> Figure:
    """Synchronous averages of both shafts over one turn, without the mesh; what stands out is shaded.

    Args:
        turns: By shaft.
        unit: Of the acceleration.

    Raises:
        ValueError: the arrays of a turn have different shapes.
    """
    with styled():
        figure = new_figure(2.3 * len(turns) + 0.6)
        panels = np.atleast_1d(figure.subplots(len(turns), 1))
        for axes, (shaft, one) in zip(panels, turns.items(), strict=True):
            _turn(axes, one)
            axes.set(xlabel=f"turns of the {shaft}", ylabel=axis("residual", unit), xlim=(0, 1))
        legend_above(panels[0])
        return figure


def _turn(axes: Axes, one: Turn) -> None:
    turn, residual = series(turn=one.turn, residual=one.residual)
    if not any_finite(residual):
        mark_empty(axes)
        return
    if one.reference is not None:
        axes.plot(*series(turn=one.reference_turn, reference=one.reference), label="reference", **REFERENCE)
    axes.plot(turn, residual, label="record", **RECORD)
    if one.window is not None:
        begin, end = one.window
        for shift in (0, -1):  # a window may go on at the start of the turn
            label = None if shift else "stands out"
            axes.axvspan(begin + shift, end + shift, color=RED, alpha=0.15, linewidth=0, label=label)


def casing_kurtosis_figure(values: ArrayLike, limit: float, reference: ArrayLike | None = None) -> Figure:
    """Kurtosis of each turn of the pinion, with that of noise and its 99 % point.

    Args:
        values: Shape (turn,).
        limit: The 99 % point for noise.
        reference: Of the reference's turns, shape (turn,).
    """
    with styled():
        figure = new_figure(2.9)
        axes = figure.subplots()
        if reference is not None:
            (reference,) = series(reference=reference)
            look = {"color": PALE, "marker": "s", "markersize": 3, "linewidth": 0.7}
            axes.plot(1 + np.arange(len(reference)), reference, label="reference", **look)
        (values,) = series(values=values)
        look = {"color": BLUE, "marker": "o", "markersize": 3.5, "linewidth": 0.8}
        axes.plot(1 + np.arange(len(values)), values, label="record", **look)
        axes.axhline(limit, color=INK, linestyle="--", linewidth=0.9, label="99 % of turns of noise")
        axes.axhline(3, color=INK, linestyle=":", linewidth=0.9, label="noise")
        axes.set(xlabel="turn of the pinion", ylabel="kurtosis")
        if not any_finite(values):
            mark_empty(axes)
        legend_above(axes)
        return figure
