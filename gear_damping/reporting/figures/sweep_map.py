"""What a sweep over two numbers found: a heat map, a panel for each estimator or figure."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_damping.reporting.figures.axis_names import swept_axis
from gear_damping.reporting.figures.sweep import (
    SUFFIX,
    Row,
    figures_of_sweep,
    numbers_of,
    over_seeds,
    sweep_figure,
)
from gear_damping.reporting.numbers import number
from gear_damping.reporting.style import SEQUENTIAL, new_figure, styled

MOST_MAPS = 4  # panels
MOST_WRITTEN = 64  # cells of a panel, in which their value is written
MIDDLE = 0.6  # of the range of colours, from where text is dark


def sweep_figures(rows: Sequence[Row], keys: Sequence[str], names: tuple[str, str]) -> Mapping[str, Figure]:
    """The figures of a sweep by the names of their files: lines, and over two numbers a map.

    Args:
        rows: One row a finished job.
        keys: The swept configuration keys; over values of `seed` means are taken.
        names: Of the file of the lines, and of that of the map.
    """
    rows, keys = over_seeds(rows, keys)
    found: dict[str, Figure] = {}
    if not rows or not keys:
        return found
    is_of_errors = any(column.endswith(SUFFIX) for row in rows for column in row)
    lines = (sweep_figure if is_of_errors else figures_of_sweep)(rows, keys[0], keys[1:])
    if lines is not None:
        found[names[0]] = lines
    if len(keys) == 2 and all(len(_values(rows, key)) > 1 for key in keys):
        chart = sweep_map_figure(rows, keys[0], keys[1])
        found |= {} if chart is None else {names[1]: chart}
    return found


def sweep_map_figure(rows: Sequence[Row], across: str, up: str) -> Figure | None:
    """A heat map of each error, or of each figure, over two swept numbers; None where there is no number.

    Args:
        rows: One row a job; a missing job leaves an empty cell.
        across: The key of the horizontal axis.
        up: That of the vertical one.
    """
    columns, xs, ys = _shown(rows, (across, up)), _values(rows, across), _values(rows, up)
    if not columns:
        return None
    with styled():
        figure = new_figure(1.6 + 0.45 * max(len(ys), 3), 2.0 + len(columns) * max(2.2, 0.6 * len(xs)))
        panels = figure.subplots(1, len(columns), squeeze=False, sharey=True)[0]
        tables = [_table(rows, column, (across, xs), (up, ys)) for column in columns]
        is_one = all(column.endswith(SUFFIX) for column in columns)  # one unit, one scale
        limits = _limits(np.stack(tables)) if is_one else None
        for axes, column, table in zip(panels, columns, tables, strict=True):
            low, high = limits or _limits(table)
            image = axes.imshow(table, origin="lower", aspect="auto", vmin=low, vmax=high, cmap=SEQUENTIAL)
            axes.set_xticks(range(len(xs)), labels=[f"{x:g}" for x in xs])
            axes.set_yticks(range(len(ys)), labels=[f"{y:g}" for y in ys])
            axes.set_title(column.removesuffix(SUFFIX))
            axes.grid(visible=False)
            _write(axes, table, low, high)
            if not is_one:
                figure.colorbar(image, ax=axes)
        figure.supxlabel(swept_axis(across), fontsize=10)
        figure.supylabel(swept_axis(up), fontsize=10)
        if is_one:
            figure.colorbar(image, ax=list(panels), label="test RMSE / % of critical")
    return figure


def _shown(rows: Sequence[Row], keys: Sequence[str]) -> list[str]:
    """Errors where there are any, else numbers that differ between jobs."""
    columns = numbers_of(rows, keys)
    errors = [column for column in columns if column.endswith(SUFFIX)]
    varied = [column for column in columns if len({row.get(column) for row in rows}) > 1]
    return (errors or varied)[:MOST_MAPS]


def _values(rows: Sequence[Row], key: str) -> list[float]:
    """Values of a key in their order; none where one of them is no number."""
    values = [row.get(key) for row in rows]
    if not all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
        return []
    return sorted(set(values))


def _table(
    rows: Sequence[Row], column: str, across: tuple[str, Sequence[float]], up: tuple[str, Sequence[float]]
) -> np.ndarray:
    (x_key, xs), (y_key, ys) = across, up
    table = np.full((len(ys), len(xs)), np.nan)
    for row in rows:
        value: Any = row.get(column)
        if isinstance(value, (int, float)):
            table[ys.index(row[y_key]), xs.index(row[x_key])] = value
    return table


def _limits(values: np.ndarray) -> tuple[float, float]:
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)


def _write(axes: Any, table: np.ndarray, low: float, high: float) -> None:
    """The value of each cell, where there is room."""
    if table.size > MOST_WRITTEN:
        return
    for (row, column), value in np.ndenumerate(table):
        if np.isfinite(value):
            colour = "black" if value > low + MIDDLE * (high - low) else "white"
            axes.text(column, row, number(value, 2), ha="center", va="center", color=colour, fontsize=7)
