"""Predicted against true damping ratio."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gear_damping.reporting.figures.arrays import Array, any_finite, extent, series
from gear_damping.reporting.style import (
    CYCLE,
    FAINT,
    INK,
    MODEL_COLOURS,
    colour_of,
    marker_of,
    new_figure,
    say_empty,
    styled,
)

ALWAYS_ONE_VALUE = "mean"  # the control without a picture of its own: it is drawn as a line in every panel


def predicted_against_true_figure(predictions: Mapping[str, Any]) -> Figure:
    """Predicted against true damping ratio of each test run, one panel a model.

    Args:
        predictions: Model -> (true, predicted), or (true, predicted, spread), in % of critical, each of shape
            (runs,); or what `compare_models` returns for it, of which `per_run` is shown. `mean` is the
            control that always says one value.

    Raises:
        ValueError: the arrays of a model have different lengths.
    """
    found = {name: _arrays(name, pair) for name, pair in predictions.items()}
    constant = found.pop(ALWAYS_ONE_VALUE, None)
    limits = extent([part for arrays in found.values() for part in arrays[:2]], margin=0.05)
    with styled():
        panels = max(len(found), 1)
        columns = min(panels, 3)
        figure = new_figure(0.5 + 3.2 * -(-panels // columns) * (1.0 if columns > 1 else 1.3))
        grid = figure.subplots(-(-panels // columns), columns, squeeze=False, sharex=True, sharey=True)
        for unused in grid.flat[panels:]:
            unused.set_axis_off()
        for row in grid:
            row[0].set_ylabel("predicted damping ratio / %")
        for axes in grid[-1]:
            axes.set_xlabel("true damping ratio / %")
        if not found:
            say_empty(grid.flat[0], "no predictions to show")
        for number, (axes, (name, arrays)) in enumerate(zip(grid.flat, found.items(), strict=False)):
            _panel(axes, name, number, arrays)
            if limits:
                _references(axes, limits, constant)
        return figure


def _arrays(name: str, pair: Mapping[str, Any] | Sequence[Any]) -> tuple[Array, Array, Array]:
    """True, predicted and spread (0 where there is none) of a model."""
    if isinstance(pair, Mapping):
        pair = pair.get("per_run", pair)
        pair = (pair["true"], pair["predicted"], pair.get("spread"))
    true, predicted, spread = (*pair, None)[:3]
    spread = np.zeros(np.shape(true)) if spread is None else spread
    return series(**{f"{name}_true": true, f"{name}_predicted": predicted, f"{name}_spread": spread})


def _panel(axes: Axes, name: str, number: int, arrays: tuple[Array, Array, Array]) -> None:
    true, predicted, spread = arrays
    if not any_finite(true + predicted):
        axes.set_title(name)
        say_empty(axes)
        return
    colour = MODEL_COLOURS.get(name, CYCLE[number % len(CYCLE)])
    if np.nansum(spread) > 0:
        axes.errorbar(true, predicted, yerr=np.nan_to_num(spread), fmt="none", ecolor=colour, alpha=0.3, linewidth=0.8)
    axes.plot(true, predicted, marker_of(name), markersize=4, color=colour_of(name, number), linestyle="none")
    error = float(np.sqrt(np.nanmean((predicted - true) ** 2)))
    axes.set_title(f"{name}: RMSE over runs {error:.3g} %")


def _references(axes: Axes, limits: tuple[float, float], constant: tuple[Array, ...] | None) -> None:
    """The line of right answers, and that of the mean predictor."""
    axes.plot(limits, limits, color=INK, linewidth=0.9, linestyle=":", zorder=1)
    axes.annotate("right", limits, (-4, -4), textcoords="offset points", fontsize=8, color=INK, ha="right", va="top")
    if constant is not None and any_finite(constant[1]):
        level = float(np.nanmean(constant[1]))
        axes.axhline(level, color=INK, linewidth=0.9, linestyle="--", zorder=1)
        axes.annotate("mean", (limits[1], level), (0, 3), textcoords="offset points", fontsize=8, ha="right")
    axes.set(xlim=limits, ylim=limits, aspect="equal", facecolor="white")
    axes.grid(color=FAINT)
