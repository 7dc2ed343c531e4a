"""The figure of task=inspect: every channel over time, and beside it its spectrum with the floor of the noise.

It lies outside of `figures`, whose other members need torch: an inspection is to be quick.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator
from numpy.typing import NDArray

from gear_damping.reporting.style import BLUE, PALE, RED, new_figure, say_empty, styled

MOST_PANELS = 12
_ROW, _MARGINS, _WIDTH = 1.7, (0.55, 0.35), 10.0  # inches; below and above the rows
_DRAWN = 1000  # pairs of lowest and highest value that a long channel is drawn by
_BELOW_FLOOR = 1e-4  # of the floor; what lies lower is no more shown


@dataclass(frozen=True, eq=False)
class Panel:
    """A channel to draw.

    Args:
        name: Its title.
        unit: Of the values, "" where it is not known.
        time: (n,) in s, or sample numbers.
        values: (n,); gaps where they are not finite.
        frequency: (m,) in Hz, or cycles a sample; None where there is no spectrum.
        density: (m,) power spectral density.
        floor: The density of the noise.
    """

    name: str
    unit: str
    time: NDArray[np.float64]
    values: NDArray[np.float64]
    frequency: NDArray[np.float64] | None = None
    density: NDArray[np.float64] | None = None
    floor: float = 0.0


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
            left.plot(*drawn(panel.time, panel.values), color=BLUE, linewidth=0.8)
            left.set_title(panel.name)
            left.yaxis.set_major_locator(MaxNLocator(4))
            left.xaxis.set_major_locator(MaxNLocator(8))
            left.set_ylabel(panel.unit or "?")
            _draw_spectrum(right, panel)
        rows[-1][0].set_xlabel("time / s" if in_seconds else "sample")
        rows[-1][1].set_xlabel("frequency / Hz" if in_seconds else "cycles a sample")
        if not shown:
            say_empty(rows[0][0], "no channel to show")
        if len(panels) > len(shown):
            rows[-1][1].set_title(f"{len(panels) - len(shown)} more channels are not drawn", color=PALE)
    return figure


def _draw_spectrum(axes: object, panel: Panel) -> None:
    if panel.frequency is None or not np.any(panel.density > 0):
        say_empty(axes, "no spectrum")
        return
    amplitude = np.sqrt(np.maximum(panel.density, _BELOW_FLOOR * panel.floor))[1:]
    axes.semilogy(*drawn(panel.frequency[1:], amplitude), color=BLUE, linewidth=0.8)
    if panel.floor > 0:
        axes.axhline(panel.floor**0.5, color=RED, linestyle="--", linewidth=0.8)
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
