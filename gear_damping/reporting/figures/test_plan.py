"""How well tests would tell a damping ratio: a map over speed and torque, or curves over the length of a record."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from gear_damping.reporting.style import (
    CYCLE,
    FAINT,
    INK,
    RED,
    SEQUENTIAL,
    legend_above,
    mark_empty,
    new_figure,
    styled,
)

Array = NDArray[np.float64]
STEPS = np.array([1.0])  # of a decade, at which contours are drawn
DARKEST, PALEST = 0.01, 1000.0  # % between which colours tell
MOST_CURVES = 12  # that can be told apart


@dataclass(frozen=True, eq=False)
class PlanMap:
    """A map.

    Args:
        speeds: rpm, (n,).
        torques: N m, (m,).
        percent: (m, n); nan where nothing is told.
        tests: Speed and torque of each setting.
        chosen: Numbers of those that are chosen.
    """

    speeds: Array
    torques: Array
    percent: Array
    tests: Sequence[tuple[float, float]]
    chosen: Sequence[int]


@dataclass(frozen=True, eq=False)
class PlanCurves:
    """Curves.

    Args:
        durations: s, (n,).
        percent: (settings, n); nan where nothing is told.
        labels: Of the settings.
        chosen: Number of the setting and length in s of each test that is chosen.
    """

    durations: Array
    percent: Array
    labels: Sequence[str]
    chosen: Sequence[tuple[int, float]]


@dataclass(frozen=True, eq=False)
class PlanPicture:
    """A plan.

    Args:
        title: What is shown.
        wanted: Half interval that is wanted, %.
        reached: Whether the chosen tests reach it.
        shown: The map or the curves.
    """

    title: str
    wanted: float
    reached: bool
    shown: PlanMap | PlanCurves


def test_plan_figure(picture: PlanPicture) -> Figure:
    """Half intervals in % of the damping ratio, the wanted one in red, the tests of the chosen set filled."""
    with styled():
        figure = new_figure(4.6)
        axes = figure.subplots()
        figure.suptitle(picture.title, fontsize=10, x=0.01, ha="left")
        name = "cheapest set" if picture.reached else "best set"
        if not np.isfinite(picture.shown.percent).any():
            mark_empty(axes, "no test tells anything of the damping")
        elif isinstance(picture.shown, PlanMap):
            _map(figure, axes, picture.shown, picture.wanted, name)
        else:
            _curves(axes, picture.shown, picture.wanted, name)
        return figure


def _map(figure: Figure, axes: Axes, shown: PlanMap, wanted: float, name: str) -> None:
    axes.grid(False)
    axes.set_facecolor(FAINT)
    percent = np.ma.masked_invalid(shown.percent).clip(DARKEST, PALEST)
    missing = np.ma.getmaskarray(percent)
    norm = LogNorm(max(float(percent.min()), DARKEST), float(percent.max()) * 1.0001)
    filled = axes.pcolormesh(shown.speeds, shown.torques, percent, norm=norm, cmap=SEQUENTIAL + "_r", shading="nearest")
    filled.set_rasterized(True)
    bar = figure.colorbar(filled, ax=axes, label="± % of the damping ratio", pad=0.02)
    _plain(bar.ax.yaxis)
    levels = [one for one in _levels(float(percent.min()), float(percent.max())) if not np.isclose(one, wanted)]
    if levels:
        lines = axes.contour(shown.speeds, shown.torques, percent, levels=levels, colors=INK, linewidths=0.5)
        axes.clabel(lines, fmt=lambda value: f"{value:g} %", fontsize=7)
    if percent.min() < wanted < percent.max():
        axes.contour(shown.speeds, shown.torques, percent, levels=[wanted], colors=RED, linewidths=1.8)
        axes.plot([], [], color=RED, linewidth=1.8, label=f"wanted: ± {wanted:g} %")
    look = {"linestyle": "none", "marker": "o", "markeredgecolor": INK, "markersize": 6, "clip_on": False, "zorder": 5}
    if missing.any():
        axes.plot([], [], "s", color=FAINT, markersize=8, label="nothing promised")
    axes.plot(*np.transpose(shown.tests), markerfacecolor="white", label="tests", **look)
    chosen = [shown.tests[number] for number in shown.chosen]
    axes.plot(*np.transpose(chosen), **(look | {"markerfacecolor": RED, "markersize": 9}), label=name)
    axes.set_xlabel("pinion speed / rpm")
    axes.set_ylabel("pinion torque / N m")
    legend_above(axes)


def _curves(axes: Axes, shown: PlanCurves, wanted: float, name: str) -> None:
    colours = [colour for colour in CYCLE if colour != RED]  # which is that of what is wanted
    for number, curve in enumerate(shown.percent[:MOST_CURVES]):
        style = "-" if number < len(colours) else "--"
        label = shown.labels[number]
        axes.plot(shown.durations, curve, color=colours[number % len(colours)], linestyle=style, label=label)
    axes.axhline(wanted, color=RED, linewidth=1.8, label=f"wanted: ± {wanted:g} %")
    for place, (setting, seconds) in enumerate(shown.chosen):
        value = np.interp(seconds, shown.durations, shown.percent[setting])
        label = f"{name}, each test" if place == 0 else None
        axes.plot(seconds, value, "o", color=RED, markeredgecolor=INK, markersize=8, label=label, zorder=5)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("length of the record / s")
    axes.set_ylabel("± % of the damping ratio")
    for axis in (axes.xaxis, axes.yaxis):
        _plain(axis)
    legend_above(axes, columns=3)


def _levels(low: float, high: float) -> list[float]:
    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    return [float(level) for level in np.outer(decades, STEPS).ravel() if low < level < high]


def _plain(axis: object) -> None:
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, place: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
