"""A record over time: the whole of it and an excerpt that can be read."""

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.arrays import any_finite, extent, series, time_axis
from gear_damping.reporting.figures.axis_names import axis
from gear_damping.reporting.style import BLUE, SKY, mark_empty, new_figure, styled

READABLE_SAMPLES = 300  # in which single cycles are seen


def response_figure(
    time: ArrayLike,
    signal: ArrayLike,
    unit: str,
    label: str = "transmission error",
    *,
    readable: int = READABLE_SAMPLES,
) -> Figure:
    """A record: above the whole, below its first `readable` samples.

    Args:
        time: In s, shape (time,).
        signal: In `unit`, shape (time,); gaps where it is not finite.
        unit: Unit of the signal, for the axis.
        label: What the signal is.
        readable: Samples of the lower panel.

    Raises:
        ValueError: the arrays have different shapes.
    """
    time, signal = series(time=time, signal=signal)
    shown_time, time_label = time_axis(time)
    with styled():
        figure = new_figure(4.6)
        whole, excerpt = figure.subplots(2, 1)
        stop = min(readable, len(time))
        for axes, values, width in ((whole, slice(None), 0.7), (excerpt, slice(0, stop), 1.1)):
            axes.plot(shown_time[values], signal[values], color=BLUE, linewidth=width)
            axes.set(ylabel=axis(label, unit), xlabel=time_label)
            limits = extent([shown_time[values]])
            if limits:
                axes.set_xlim(limits)
        if not any_finite(signal):
            mark_empty(whole)
            return figure
        if stop < len(time):
            whole.axvspan(shown_time[0], shown_time[stop - 1], color=SKY, alpha=0.3, linewidth=0)
        whole.set_title(_extremes(signal, unit))
        excerpt.set_title("the beginning, shaded above" if stop < len(time) else "")
        return figure


def _extremes(signal: np.ndarray, unit: str) -> str:
    mean, deviation = float(np.nanmean(signal)), float(np.nanstd(signal))
    return f"mean {mean:.4g} {unit}, standard deviation {deviation:.3g} {unit}"
