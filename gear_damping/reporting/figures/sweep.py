"""Test error against a swept value."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gear_damping.reporting.figures.arrays import any_finite
from gear_damping.reporting.figures.axis_names import swept_axis
from gear_damping.reporting.style import colour_of, legend_above, marker_of, new_figure, say_empty, styled

SUFFIX = "/rmse_percent"
CONTROLS = ("mean", "white_noise")
LOGARITHMIC_FROM = 200.0  # ratio of the highest to the lowest swept value

Row = Mapping[str, Any]


def sweep_figure(rows: Sequence[Row], key: str, others: Sequence[str] = ()) -> Figure:
    """Test error against the swept value: a line per model with its spread over seeds, controls dashed.

    Args:
        rows: One row a job, with `key`, `<model>/rmse_percent` and `<model>/rmse_percent_std` (% of critical);
            a job without a model's column leaves a gap. A value of None means that the effect is off.
        key: The swept configuration key.
        others: Further swept keys: each combination of their values has a panel.
    """
    panels: dict[str, list[Row]] = {}
    for row in rows:
        panels.setdefault(", ".join(f"{other} = {row.get(other)}" for other in others), []).append(row)
    with styled():
        figure = new_figure(1.2 + 3.2 * max(len(panels), 1))
        grid = figure.subplots(max(len(panels), 1), 1, squeeze=False, sharey=True)[:, 0]
        for axes in grid:
            axes.set_ylabel("test RMSE / % of critical")
        grid[-1].set_xlabel(swept_axis(key))
        highest = 0.0
        for axes, (title, found) in zip(grid, panels.items(), strict=False):
            axes.set_title(title, loc="right", fontsize=9)
            highest = max(highest, _panel(axes, found, key))
        if highest > 0:
            grid[0].set_ylim(0, 1.06 * highest)
            legend_above(grid[0])
        else:
            say_empty(grid[0], "no finished jobs to show")
        return figure


def _panel(axes: Axes, rows: Sequence[Row], key: str) -> float:
    """Draw the lines; returns the highest value drawn."""
    ordered = sorted(rows, key=lambda row: _place(row.get(key)))
    places = _places(axes, [row.get(key) for row in ordered])
    columns = dict.fromkeys(column for row in rows for column in row if column.endswith(SUFFIX))
    highest = 0.0
    for number, name in enumerate(column.removesuffix(SUFFIX) for column in columns):
        mean = np.array([_number(row.get(name + SUFFIX)) for row in ordered])
        spread = np.nan_to_num([_number(row.get(f"{name}{SUFFIX}_std")) for row in ordered])
        if any_finite(mean):
            _line(axes, name, colour_of(name, number), places, mean, spread)
            highest = max(highest, float(np.nanmax(mean + spread)))
    return highest


def _line(axes: Axes, name: str, colour: str, places: Sequence[float], mean: np.ndarray, spread: np.ndarray) -> None:
    label = f"{name} (control)" if name in CONTROLS else name
    style = "--" if name in CONTROLS else "-"
    look = {"color": colour, "marker": marker_of(name), "markersize": 5, "linestyle": style}
    axes.plot(places, mean, label=label, zorder=2 if name in CONTROLS else 3, **look)
    if spread.any():
        axes.fill_between(places, mean - spread, mean + spread, color=colour, alpha=0.15, linewidth=0)


def _places(axes: Axes, values: Sequence[Any]) -> list[float]:
    """Where the values stand: as numbers, or side by side with their names as ticks."""
    if not all(isinstance(value, (int, float)) for value in values):
        axes.set_xticks(range(len(values)), labels=["off" if value is None else str(value) for value in values])
        return list(map(float, range(len(values))))
    if values and min(values) > 0 and max(values) / min(values) >= LOGARITHMIC_FROM:
        axes.set_xscale("log")
    elif len(values) <= 10:
        axes.set_xticks(values, labels=[f"{value:g}" for value in values])
    return list(map(float, values))


def _place(value: Any) -> tuple[int, float, str]:
    if value is None:
        return (2, 0.0, "")
    return (0, float(value), "") if isinstance(value, (int, float)) else (1, 0.0, str(value))


def _number(value: Any) -> float:
    return float(value) if isinstance(value, (int, float)) and np.isfinite(value) else float("nan")
