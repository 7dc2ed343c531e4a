"""The damping ratio against the amplitude of vibration, record by record, as estimators tell it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import NDArray

from gear_damping.reporting.style import CYCLE, INK, mark_empty, new_figure, styled

Array = NDArray[np.float64]
MOST_PANELS = 12  # that can be read on one page
ABREAST = 3  # panels in a row, at most
HEIGHT = 2.6  # inches of a row
ROOM = 0.35  # of the largest ratio, above it
FEW_TICKS = 5.0  # from the smallest to the largest: below it 1, 2 and 5 are too few
LEAST_SPAN = 1.2  # from the smallest to the largest amplitude of an axis


@dataclass(frozen=True, eq=False)
class DampingBand:
    """A damping ratio against amplitude.

    Args:
        amplitude: (n,) in the unit of the channel.
        ratio_percent: (n,).
        interval95: (n, 2).
    """

    amplitude: Array
    ratio_percent: Array
    interval95: Array


@dataclass(frozen=True, eq=False)
class DampingPanel:
    """One record.

    Args:
        record: Its name.
        bands: What each estimator tells; None where it tells nothing.
        laws: The same of fitted simulations, by what they are called; None where one has none.
    """

    record: str
    bands: Mapping[str, DampingBand | None]
    laws: Mapping[str, DampingBand | None] = field(default_factory=dict)


def damping_figure(panels: Sequence[DampingPanel], of: str) -> Figure:
    """Ratios with bands over a logarithmic amplitude; a mean over amplitudes is a line as long as these.

    Args:
        panels: One for each record.
        of: Whose amplitude it is, with its unit.
    """
    shown = list(panels)[:MOST_PANELS]
    names = list(dict.fromkeys(name for panel in shown for name in panel.bands))
    with styled():
        columns = min(ABREAST, max(len(shown), 1))
        rows = max(1, -(-len(shown) // columns))
        figure = new_figure(0.5 + HEIGHT * rows)
        grid = figure.subplots(rows, columns, squeeze=False)
        for axes in grid.flat[len(shown) :]:
            axes.set_visible(False)
        if not shown:
            mark_empty(grid[0][0], "no records to show")
        for axes, panel in zip(grid.flat, shown, strict=False):
            _panel(axes, panel, names)
        left_out = len(panels) - len(shown)
        more = f"   ({left_out} more records not shown)" if left_out else ""
        figure.supxlabel(f"amplitude {of}{more}", fontsize=10)
        figure.supylabel("damping ratio / % of critical", fontsize=10)
        drawn = [axes.get_legend_handles_labels() for axes in grid.flat]
        handles = {label: one for ones, labels in drawn for one, label in zip(ones, labels, strict=True)}
        if handles:
            figure.legend(list(handles.values()), list(handles), loc="outside upper left", ncols=4, fontsize=9)
        return figure


def _panel(axes: Axes, panel: DampingPanel, names: Sequence[str]) -> None:
    told = {name: band for name, band in panel.bands.items() if band is not None}
    axes.set_title(panel.record)
    if not told:
        mark_empty(axes, "no estimator tells anything")
        return
    for name, band in told.items():
        colour = CYCLE[names.index(name) % len(CYCLE)]
        low, high = band.interval95.T
        axes.fill_between(band.amplitude, low, high, color=colour, alpha=0.2, linewidth=0)
        axes.plot(band.amplitude, band.ratio_percent, color=colour, label=name.replace("_", " "))
    for name, law in panel.laws.items():
        if law is not None:
            axes.fill_between(law.amplitude, *law.interval95.T, color=INK, alpha=0.15, linewidth=0)
            axes.plot(law.amplitude, law.ratio_percent, color=INK, linestyle="--", label=name)
    axes.set_xscale("log")
    every = np.concatenate([band.amplitude for band in told.values()])
    if every.max() < LEAST_SPAN * every.min():
        axes.set_xlim(every.min() / LEAST_SPAN, every.max() * LEAST_SPAN)
    low, high = axes.get_xlim()
    axes.xaxis.set_major_locator(MaxNLocator(4) if high < FEW_TICKS * low else LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, place: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    largest = max(float(band.ratio_percent.max()) for band in told.values())
    axes.set_ylim(min(0.0, *(float(band.ratio_percent.min()) for band in told.values())), (1 + ROOM) * largest)
