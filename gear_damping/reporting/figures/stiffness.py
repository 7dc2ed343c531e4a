"""Mesh stiffness over the mesh phase."""

from math import pi

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.arrays import Array, any_finite, series
from gear_damping.reporting.style import BLUE, INK, SKY, legend_above, mark_empty, new_figure, styled

SHOWN_MESH_PERIODS = 3  # in which the edges of a period are seen


def mesh_stiffness_figure(
    mesh_angle: ArrayLike,
    stiffness: ArrayLike,
    *,
    contact_ratio: float | None = None,
    periods: int = SHOWN_MESH_PERIODS,
) -> Figure:
    """Mesh stiffness over the first mesh periods, with its mean.

    Args:
        mesh_angle: Angle of the mesh (rad, 2 pi a period; a pair of teeth enters at 0), shape (time,).
        stiffness: In N/m, shape (time,).
        contact_ratio: Shades the phases at which two pairs of teeth carry; None: unknown.
        periods: How many periods to show.

    Raises:
        ValueError: the arrays have different shapes.
    """
    angle, stiffness = series(mesh_angle=mesh_angle, stiffness=stiffness)
    with styled():
        figure = new_figure(3.2)
        axes = figure.subplots()
        axes.set(xlabel="mesh phase / mesh periods", ylabel="mesh stiffness / (N/µm)", xlim=(0, periods))
        if not any_finite(angle + stiffness):
            mark_empty(axes)
            return figure
        phase = angle / (2 * pi)
        phase = phase - np.floor(np.nanmin(phase))
        shown = phase <= periods
        axes.plot(phase[shown], stiffness[shown] / 1e6, color=BLUE, label="mesh stiffness")
        _mean(axes, phase, stiffness / 1e6)
        if contact_ratio is not None:
            _double_contact(axes, contact_ratio, periods)
        axes.set_ylim(0, 1.08 * max(float(np.nanmax(stiffness)) / 1e6, 1e-12))
        legend_above(axes)
        return figure


def _mean(axes: Axes, phase: Array, stiffness: Array) -> None:
    """The mean over whole periods, where there is one."""
    whole = int(np.nanmax(phase) - np.nanmin(phase))
    within = phase < np.nanmin(phase) + whole
    if whole and np.isfinite(stiffness[within]).any():
        mean = float(np.nanmean(stiffness[within]))
        axes.axhline(mean, color=INK, linewidth=0.9, linestyle="--", label=f"mean {mean:.4g} N/µm")


def _double_contact(axes: Axes, contact_ratio: float, periods: int) -> None:
    share = contact_ratio - np.floor(contact_ratio)
    more = int(np.floor(contact_ratio)) + 1
    for period in range(periods):
        label = f"{more} pairs of teeth in contact" if period == 0 else None
        axes.axvspan(period, period + share, color=SKY, alpha=0.18, linewidth=0, label=label)
