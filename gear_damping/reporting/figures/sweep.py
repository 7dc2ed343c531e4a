"""What a sweep found against its swept values: small multiples with bands."""

from collections.abc import Mapping, Sequence
from math import ceil
from statistics import fmean, stdev
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gear_damping.reporting.figures.arrays import any_finite
from gear_damping.reporting.figures.axis_names import swept_axis
from gear_damping.reporting.style import WIDTH, colour_of, legend_above, mark_empty, marker_of, new_figure, styled

SUFFIX = "/rmse_percent"
CONTROLS = ("mean", "white_noise")
LOGARITHMIC_FROM = 200.0  # ratio of the highest to the lowest swept value
SEED = "seed"  # the key over whose values a band is drawn
COLUMNS, PANEL, HEIGHT = 3, 3.6, 2.8  # panels beside each other, and the size of one in inches
LONGEST_NAME = 16  # characters of the name of a value
MOST_PANELS = 12  # of figures of a task that states no errors

Row = Mapping[str, Any]


def sweep_figure(rows: Sequence[Row], key: str, others: Sequence[str] = ()) -> Figure:
    """Test error against the swept value: a line per model with its standard deviation over seeds, controls dashed.

    Args:
        rows: One row a job, with `key`, `<model>/rmse_percent` and `<model>/rmse_percent_std` (% of critical);
            a job without a model's column leaves a gap. A value of None means that the effect is off.
        key: The swept configuration key.
        others: Further swept keys: each combination of their values has a panel.
    """
    panels: dict[str, list[Row]] = {}
    for row in rows:
        panels.setdefault(_others(row, others, key), []).append(row)
    with styled():
        figure, grid = _grid(len(panels))
        _name_axes(figure, grid, key, "test RMSE / % of critical")
        highest = 0.0
        for axes, (title, found) in zip(grid, panels.items(), strict=False):
            axes.set_title(title, fontsize=9)
            highest = max(highest, _panel(axes, found, key))
        if highest > 0:
            for axes in grid:
                axes.set_ylim(0, 1.06 * highest)
            _legend(figure, grid)
        else:
            mark_empty(grid[0], "no finished jobs to show")
        return figure


def figures_of_sweep(rows: Sequence[Row], key: str, others: Sequence[str]) -> Figure | None:
    """Every figure that jobs of some other task state, each in a panel of its own; None where there is no number.

    Args:
        rows: One row a job.
        key: The swept configuration key.
        others: Further swept keys: each combination of their values has a line.
    """
    names = numbers_of(rows, (key, *others))[:MOST_PANELS]
    if not names:
        return None
    lines: dict[str, list[Row]] = {}
    for row in sorted(rows, key=lambda row: _place(row.get(key))):
        lines.setdefault(_others(row, others, key), []).append(row)
    with styled():
        figure, grid = _grid(len(names))
        for axes, name in zip(grid, names, strict=True):
            axes.set_title(name, fontsize=9)
            for number, (title, found) in enumerate(lines.items()):
                places = _places(axes, [row.get(key) for row in found])
                values = np.array([_number(row.get(name)) for row in found])
                std = np.nan_to_num([_number(row.get(f"{name}_std")) for row in found])
                _line(axes, title, colour_of(title, number), places, values, std)
        _name_axes(figure, grid, key)
        if len(lines) > 1:
            _legend(figure, grid)
    return figure


def numbers_of(rows: Sequence[Row], keys: Sequence[str]) -> list[str]:
    """Columns that hold numbers, without the swept ones and standard deviations."""
    columns = dict.fromkeys(column for row in rows for column in row)
    return [
        name
        for name in columns
        if name not in keys and not name.endswith("_std") and name != "job"
        and any(isinstance(row.get(name), (int, float)) and not isinstance(row.get(name), bool) for row in rows)
    ]  # fmt: skip


def over_seeds(rows: Sequence[Row], keys: Sequence[str]) -> tuple[list[Row], list[str]]:
    """The rows with means and standard deviations over swept seeds, and the other keys."""
    if SEED not in keys or len(keys) == 1:
        return list(rows), list(keys)
    others = [key for key in keys if key != SEED]
    groups: dict[tuple, list[Row]] = {}
    for row in rows:
        groups.setdefault(tuple(str(row.get(key)) for key in others), []).append(row)
    return [_mean(group, others) for group in groups.values()], others


def _mean(group: Sequence[Row], keys: Sequence[str]) -> Row:
    found: dict[str, Any] = {key: group[0].get(key) for key in keys}
    for name in numbers_of(group, (*keys, SEED)):
        values = [row[name] for row in group if isinstance(row.get(name), (int, float))]
        found[name] = fmean(values)
        found[f"{name}_std"] = stdev(values) if len(values) > 1 else 0.0
    return found


def _others(row: Row, others: Sequence[str], key: str) -> str:
    """The other swept values by the last part of their keys, and by two parts where that would name two keys."""
    last = [one.rpartition(".")[2] for one in (key, *others)]
    parts = {one: 1 if last.count(name) == 1 else 2 for one, name in zip((key, *others), last, strict=True)}
    return ", ".join(f"{'.'.join(one.split('.')[-parts[one] :])} = {row.get(one)}" for one in others)


def _name_axes(figure: Figure, grid: Sequence[Axes], key: str, value: str = "") -> None:
    """What the axes are, once for all panels."""
    if len(grid) == 1:
        grid[0].set(xlabel=swept_axis(key), ylabel=value)
        return
    figure.supxlabel(swept_axis(key), fontsize=10)
    figure.supylabel(value, fontsize=10)


def _legend(figure: Figure, grid: Sequence[Axes]) -> None:
    """The legend over all panels."""
    if len(grid) == 1:
        legend_above(grid[0])
        return
    shown = dict(zip(*reversed(grid[0].get_legend_handles_labels()), strict=True))
    figure.legend(shown.values(), shown.keys(), loc="outside upper left", ncols=4)


def _grid(panels: int) -> tuple[Figure, list[Axes]]:
    """A figure with so many panels, at least one."""
    columns = min(max(panels, 1), COLUMNS)
    rows = ceil(max(panels, 1) / columns)
    figure = new_figure(1.2 + HEIGHT * rows, WIDTH if columns == 1 else PANEL * columns)
    axes = figure.subplots(rows, columns, squeeze=False, sharey=False).ravel().tolist()
    for unused in axes[max(panels, 1) :]:
        unused.remove()
    return figure, axes[: max(panels, 1)]


def _panel(axes: Axes, rows: Sequence[Row], key: str) -> float:
    """Draw the lines; returns the highest value drawn."""
    ordered = sorted(rows, key=lambda row: _place(row.get(key)))
    places = _places(axes, [row.get(key) for row in ordered])
    columns = dict.fromkeys(column for row in rows for column in row if column.endswith(SUFFIX))
    highest = 0.0
    for number, name in enumerate(column.removesuffix(SUFFIX) for column in columns):
        mean = np.array([_number(row.get(name + SUFFIX)) for row in ordered])
        std = np.nan_to_num([_number(row.get(f"{name}{SUFFIX}_std")) for row in ordered])
        if any_finite(mean):
            _line(axes, name, colour_of(name, number), places, mean, std)
            highest = max(highest, float(np.nanmax(mean + std)))
    return highest


def _line(axes: Axes, name: str, colour: str, places: Sequence[float], mean: np.ndarray, std: np.ndarray) -> None:
    label = f"{name} (control)" if name in CONTROLS else name
    style = "--" if name in CONTROLS else "-"
    look = {"color": colour, "marker": marker_of(name), "markersize": 5, "linestyle": style}
    axes.plot(places, mean, label=label, zorder=2 if name in CONTROLS else 3, **look)
    if std.any():
        axes.fill_between(places, mean - std, mean + std, color=colour, alpha=0.15, linewidth=0)


def _places(axes: Axes, values: Sequence[Any]) -> list[float]:
    """Where the values stand: as numbers, or side by side with their names as ticks."""
    if not all(isinstance(value, (int, float)) for value in values):
        axes.set_xticks(range(len(values)), labels=[_named(value) for value in values])
        return list(map(float, range(len(values))))
    if values and min(values) > 0 and max(values) / min(values) >= LOGARITHMIC_FROM:
        axes.set_xscale("log")
    elif len(values) <= 10:
        axes.set_xticks(values, labels=[f"{value:g}" for value in values])
    return list(map(float, values))


def _named(value: Any) -> str:
    """The name of a value below the axis; of a long path its end."""
    text = "off" if value is None else str(value)
    return text if len(text) <= LONGEST_NAME else f"…{text[1 - LONGEST_NAME :]}"


def _place(value: Any) -> tuple[int, float, str]:
    if value is None:
        return (2, 0.0, "")
    return (0, float(value), "") if isinstance(value, (int, float)) else (1, 0.0, str(value))


def _number(value: Any) -> float:
    return float(value) if isinstance(value, (int, float)) and np.isfinite(value) else float("nan")
