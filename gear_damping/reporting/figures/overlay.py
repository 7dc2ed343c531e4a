"""Measured, nominal and extended simulation on one record."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.arrays import Array, any_finite, extent, in_prefixed, series, time_axis
from gear_damping.reporting.figures.axis_names import axis
from gear_damping.reporting.style import BLUE, INK, PALE, RED, SKY, legend_above, mark_empty, new_figure, styled

SHOWN_SAMPLES = 240  # in which two curves can be told apart
LEAD = 0.1  # share of the stretch before the first of it
NOISE_BAND = 2.0  # standard deviations
MEASURED = {"color": INK, "marker": ".", "markersize": 3.5, "linestyle": "none", "label": "measured"}
NOMINAL = {"color": RED, "linewidth": 1.0, "label": "nominal simulation"}
EXTENDED = {"color": BLUE, "linewidth": 1.0, "label": "extended simulation"}


@dataclass(frozen=True, eq=False)
class Overlay:
    """A record with its simulations; arrays of shape (time,) in the channel's unit.

    Args:
        record: Its name, with the operating condition.
        time: In s.
        measured: The record.
        nominal: The calibrated nominal simulation.
        extended: The simulation with its causes; None: nothing was added.
        noise: Standard deviation of the noise, of which a band of two is shaded; None: unknown.
    """

    record: str
    time: ArrayLike
    measured: ArrayLike
    nominal: ArrayLike
    extended: ArrayLike | None = None
    noise: float | None = None


def overlay_figure(
    shown: Overlay, unit: str, quantity: str = "transmission error", samples: int = SHOWN_SAMPLES
) -> Figure:
    """Measured, nominal and extended: the stretch where the nominal is worst, its residuals, all residuals.

    Args:
        shown: The record.
        unit: Unit of the channel.
        quantity: What the channel is.
        samples: Length of the stretch.

    Raises:
        ValueError: the arrays have different shapes.
    """
    given = {"time": shown.time, "measured": shown.measured, "nominal": shown.nominal}
    more = {} if shown.extended is None else {"extended": shown.extended}
    time, measured, *simulated = series(**given, **more)
    factor, unit = in_prefixed(unit, measured)
    measured, *simulated = (factor * values for values in (measured, *simulated))
    noise = shown.noise and factor * shown.noise
    residuals = [measured - values for values in simulated]
    looks = (NOMINAL, EXTENDED)[: len(simulated)]
    time, time_label = time_axis(time)
    part = worst_stretch(residuals[0], samples)
    is_all = part == slice(None)
    with styled():
        figure = new_figure(5.0 if is_all else 6.6)
        upper, *below = figure.subplots(2 if is_all else 3, 1, height_ratios=(2.2, 1) if is_all else (2.2, 1, 1))
        middle, lower = below[0], below[-1]
        for values, look in zip(simulated, looks, strict=True):
            upper.plot(time[part], values[part], **look)
        upper.plot(time[part], measured[part], zorder=3, **MEASURED)
        upper.set(ylabel=axis(quantity, unit))
        upper.tick_params(labelbottom=False)
        for axes, excerpt in zip(below, (part, slice(None)), strict=False):
            _residuals(axes, time[excerpt], [r[excerpt] for r in residuals], looks, noise)
            axes.set_ylabel(axis("residual", unit))
        _limits(upper, time[part])
        for axes in below:
            axes.set_xlabel(time_label)
        if any_finite(time[part]) and not is_all:
            lower.axvspan(np.nanmin(time[part]), np.nanmax(time[part]), color=SKY, alpha=0.3, linewidth=0, zorder=0)
            lower.set_title("the whole record; the stretch above is shaded", fontsize=9)
        if noise:
            middle.set_title(f"grey: the noise, ±{NOISE_BAND:g} standard deviations", fontsize=9)
        if not any_finite(*residuals):
            mark_empty(upper)
        figure.align_ylabels()
        legend_above(upper)
        return figure


def worst_stretch(residual: Array, samples: int) -> slice:
    """The stretch of so many samples in which the residual has most energy."""
    if len(residual) <= samples:
        return slice(None)
    energy = np.concatenate([[0.0], np.cumsum(np.nan_to_num(residual) ** 2)])
    start = int(np.argmax(energy[samples:] - energy[:-samples]))
    start = max(0, start - round(LEAD * samples))
    return slice(start, start + samples)


def _residuals(
    axes: Axes, time: Array, residuals: list[Array], looks: tuple[dict[str, object], ...], noise: float | None
) -> None:
    for values, look in zip(residuals, looks, strict=True):
        axes.plot(time, values, color=look["color"], linewidth=0.8)
    if noise:
        band = NOISE_BAND * noise
        axes.axhspan(-band, band, color=PALE, alpha=0.25, linewidth=0, zorder=0)
    _limits(axes, time)


def _limits(axes: Axes, time: Array) -> None:
    limits = extent([time])
    if limits:
        axes.set_xlim(limits)
