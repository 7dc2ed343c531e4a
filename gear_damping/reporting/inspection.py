"""The figure of task=inspect: every channel over time, and beside it its spectrum with the floor of the noise.

Records with the same channel share its panel.

It lies outside of `figures`, whose other members need torch: an inspection is to be quick.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator
from numpy.typing import NDArray

from gear_damping.reporting.style import CYCLE, INK, PALE, colour_of, legend_above, mark_empty, new_figure, styled

MOST_PANELS = 12  # that can be read on one page
_ROW, _MARGINS, _WIDTH = 1.7, (0.55, 0.35), 10.0  # inches; below and above the rows
_DRAWN = 1000  # pairs of lowest and highest value that a long channel is drawn by
_BELOW_FLOOR = 1e-4  # of the floor; what lies lower is no more shown


@dataclass(frozen=True, eq=False)
class Curve:
    """A channel of one record.

    Args:
        label: What it is called beside others of its panel.
        time: (n,) in s, or sample numbers.
        values: (n,); gaps where they are not finite.
        frequency: (m,) in Hz, or cycles a sample; None where there is no spectrum.
        density: (m,) power spectral density.
        floor: The density of the noise.
    """

    label: str
    time: NDArray[np.float64]
    values: NDArray[np.float64]
    frequency: NDArray[np.float64] | None = None
    density: NDArray[np.float64] | None = None
    floor: float = 0.0


@dataclass(frozen=True, eq=False)
class Panel:
    """A channel to draw: its title, the unit of its values ("" where it is not known), and a curve for each record."""

    name: str
    unit: str
    curves: tuple[Curve, ...]


def inspection_figure(panels: Sequence[Panel], in_seconds: bool = True) -> Figure:
    """Every channel in a row of its own, at most MOST_PANELS of them.

    Args:
        panels: The channels.
        in_seconds: Whether times are in s; sample numbers where no rate is known.
    """
    shown = panels[:MOST_PANELS]
    with styled():
        height = _MARGINS[0] + _MARGINS[1] + _ROW * max(1, len(shown))
        figure = new_figure(height, _WIDTH, None)  # the constrained layout takes as long as all the drawing
        bottom, top = _MARGINS[0] / height, 1 - _MARGINS[1] / height
        figure.subplots_adjust(left=0.09, right=0.98, bottom=bottom, top=top, hspace=0.55, wspace=0.3)
        rows = figure.subplots(max(1, len(shown)), 2, squeeze=False, width_ratios=(3, 2))
        for (left, right), panel in zip(rows, shown, strict=False):
            _draw_time(left, panel)
            _draw_spectrum(right, panel)
        rows[-1][0].set_xlabel("time / s" if in_seconds else "sample")
        rows[-1][1].set_xlabel("frequency / Hz" if in_seconds else "cycles a sample")
        if not shown:
            mark_empty(rows[0][0], "no channel to show")
        if len(panels) > len(shown):
            rows[-1][1].set_title(f"{len(panels) - len(shown)} more channels are not drawn", color=PALE)
    return figure


def _draw_time(axes: Axes, panel: Panel) -> None:
    for number, curve in enumerate(panel.curves):
        axes.plot(*drawn(curve.time, curve.values), color=colour_of("", number), linewidth=0.8, label=curve.label)
    count = len(panel.curves)
    if 1 < count <= len(CYCLE):
        legend_above(axes, columns=count)
    else:
        axes.set_title(panel.name if count == 1 else f"{panel.name} of {count} records in their order")
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.xaxis.set_major_locator(MaxNLocator(8))
    axes.set_ylabel(f"{panel.name}\n{panel.unit or '?'}" if count > 1 else panel.unit or "?")


def _draw_spectrum(axes: Axes, panel: Panel) -> None:
    curves = [curve for curve in panel.curves if curve.frequency is not None and np.any(curve.density > 0)]
    if not curves:
        mark_empty(axes, "no spectrum")
        return
    for number, curve in enumerate(panel.curves):
        if curve.frequency is None or not np.any(curve.density > 0):
            continue
        amplitude = np.sqrt(np.maximum(curve.density, _BELOW_FLOOR * curve.floor))[1:]
        axes.semilogy(*drawn(curve.frequency[1:], amplitude), color=colour_of("", number), linewidth=0.8)
    floors = [curve.floor**0.5 for curve in curves if curve.floor > 0]
    if floors:
        axes.axhline(float(np.median(floors)), color=INK, linestyle="--", linewidth=0.8)
    axes.set_ylabel(f"{panel.unit or '?'}/√Hz")
    axes.yaxis.set_major_locator(LogLocator(numticks=5))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter("{x:.0e}")  # powers set as formulas take as long as the rest of the figure
    axes.xaxis.set_major_locator(MaxNLocator(5))


def drawn(time: NDArray[np.float64], values: NDArray[np.float64]) -> tuple[NDArray, NDArray]:
    """A long channel by the lowest and the highest value of each of many stretches: nothing that sticks out is lost."""
    every = values.size // _DRAWN
    if every < 4:
        return time, values
    n = values.size // every * every
    folded = np.where(np.isfinite(values[:n]), values[:n], np.nan).reshape(-1, every)
    held = np.isfinite(folded).any(axis=1)
    low, high = (np.full(len(folded), np.nan) for _ in range(2))
    low[held], high[held] = np.nanmin(folded[held], axis=1), np.nanmax(folded[held], axis=1)
    return np.repeat(time[:n:every], 2), np.column_stack([low, high]).ravel()
