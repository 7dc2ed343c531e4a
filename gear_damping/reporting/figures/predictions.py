"""Predicted against true damping ratio."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from gear_damping.reporting.figures.arrays import Array, any_finite, extent, series
from gear_damping.reporting.style import INK, colour_of, mark_empty, marker_of, new_figure, styled

MEAN = "mean"  # the control that always says one value: a line in every panel instead of a panel
MOST_COLUMNS = 3  # of panels on one page
RIGHT_LINE = {"color": INK, "linewidth": 0.9, "linestyle": ":", "label": "predicted = true"}
MEAN_LINE = {"color": INK, "linewidth": 0.9, "linestyle": "--", "label": "mean of the training labels (control)"}


def predicted_against_true_figure(predictions: Mapping[str, Any]) -> Figure:
    """Predicted against true damping ratio of each test run, one panel a model.

    Args:
        predictions: Model -> (true, predicted), or (true, predicted, std), in % of critical, each of shape
            (runs,); or what `compare_models` returns for it, of which `per_run` is shown. `mean` is the
            control that always says one value.

    Raises:
        ValueError: the arrays of a model have different lengths.
    """
    found = {name: _arrays(name, pair) for name, pair in predictions.items()}
    constant = found.pop(MEAN, None)
    level = float(np.nanmean(constant[1])) if constant is not None and any_finite(constant[1]) else None
    limits = extent([part for arrays in found.values() for part in arrays[:2]], margin=0.05)
    with styled():
        figure, grid = _panels(max(len(found), 1))
        if not found:
            mark_empty(grid[0], "no predictions to show")
        for number, (axes, (name, arrays)) in enumerate(zip(grid, found.items(), strict=False)):
            _panel(axes, name, number, arrays)
            if limits:
                _references(axes, limits, level)
        if limits:
            lines = [Line2D([], [], **RIGHT_LINE)] + ([] if level is None else [Line2D([], [], **MEAN_LINE)])
            figure.legend(handles=lines, loc="outside upper left", ncols=2)
        return figure


def _panels(count: int) -> tuple[Figure, NDArray[np.object_]]:
    """A figure with square panels; rows are full but for the last one."""
    columns = min(count, MOST_COLUMNS)
    rows = -(-count // columns)
    figure = new_figure(0.4 + {1: 4.6, 2: 4.1, 3: 3.2}[columns] * rows)
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for axes in grid.flat:
        axes.set_box_aspect(1)
    for row in grid:
        row[0].set_ylabel("predicted damping ratio / %")
    for axes in grid.flat[max(count - columns, 0) : count]:
        axes.set_xlabel("true damping ratio / %")
        axes.tick_params(labelbottom=True)
    for unused in grid.flat[count:]:
        unused.set_axis_off()
    return figure, grid.flat[:count]


def _arrays(name: str, pair: Mapping[str, Any] | Sequence[Any]) -> tuple[Array, ...]:
    """True, predicted and standard deviation (0 where there is none) of a model."""
    if isinstance(pair, Mapping):
        pair = pair.get("per_run", pair)
        pair = (pair["true"], pair["predicted"], pair.get("spread"))
    true, predicted, std = (*pair, None)[:3]
    std = np.zeros(np.shape(true)) if std is None else std
    return series(**{f"{name}, true": true, f"{name}, predicted": predicted, f"{name}, spread": std})


def _panel(axes: Axes, name: str, number: int, arrays: tuple[Array, ...]) -> None:
    true, predicted, std = arrays
    if not any_finite(true + predicted):
        axes.set_title(name)
        mark_empty(axes)
        return
    colour = colour_of(name, number)
    if np.nansum(std) > 0:
        axes.errorbar(true, predicted, yerr=np.nan_to_num(std), fmt="none", ecolor=colour, alpha=0.35, linewidth=0.8)
    axes.plot(true, predicted, marker_of(name), markersize=4, color=colour, linestyle="none")
    error = float(np.sqrt(np.nanmean((predicted - true) ** 2)))
    axes.set_title(f"{name}\nRMSE over runs {error:.3g} %")


def _references(axes: Axes, limits: tuple[float, float], level: float | None) -> None:
    """The line of right answers, and that of the mean predictor."""
    axes.plot(limits, limits, zorder=1, **RIGHT_LINE)
    if level is not None:
        axes.axhline(level, zorder=1, **MEAN_LINE)
    axes.set(xlim=limits, ylim=limits)
