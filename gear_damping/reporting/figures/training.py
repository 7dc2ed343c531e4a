"""Learning curves."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gear_damping.reporting.figures.arrays import any_finite
from gear_damping.reporting.style import INK, colour_of, legend_above, mark_empty, new_figure, styled

History = Sequence[Mapping[str, float]]
TRAINING, VALIDATION, RATE = "train_loss", "val_rmse_percent", "learning_rate"
LOGARITHMIC_FROM = 8.0  # ratio of the highest to the lowest error


def training_figure(histories: Mapping[str, History]) -> Figure:
    """Error of training (dashed) and validation (line) over epochs, the best epoch marked, and the step size.

    Args:
        histories: Name of a fit -> its epochs in order (`FitResult.history`), each with `train_loss` and
            `val_rmse_percent` in % of critical and `learning_rate`. A name may be `model` or `model, seed 1`:
            fits of one model have one colour.
    """
    with styled():
        figure = new_figure(4.8)
        errors, steps = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
        models = list(dict.fromkeys(_model(name) for name in histories))
        for name, history in histories.items():
            _curves(errors, steps, colour_of(_model(name), models.index(_model(name))), history)
        errors.set(ylabel="RMSE / % of critical", yscale=_scale(histories))
        steps.set(xlabel="epoch", ylabel="learning rate", yscale="log")
        if not any_finite(*[_column(history, VALIDATION) for history in histories.values()], [np.nan]):
            mark_empty(errors, "no epochs to show")
        steps.xaxis.get_major_locator().set_params(integer=True)
        legend_above(errors, _legend(models), columns=6)
        return figure


def _scale(histories: Mapping[str, History]) -> str:
    """Logarithmic where the errors fall far."""
    columns = [_column(history, key) for history in histories.values() for key in (TRAINING, VALIDATION)]
    errors = np.concatenate([np.empty(0), *columns])
    errors = errors[np.isfinite(errors)]
    return "log" if len(errors) and errors.max() > LOGARITHMIC_FROM * errors.min() else "linear"


def _model(name: str) -> str:
    return name.partition(",")[0]


def _column(history: History, key: str) -> np.ndarray:
    values = np.array([epoch.get(key, np.nan) for epoch in history], dtype=float)
    return np.where(np.isfinite(values) & (values > 0), values, np.nan)


def _curves(errors: Axes, steps: Axes, colour: str, history: History) -> None:
    epochs = np.arange(1, len(history) + 1)
    validation = _column(history, VALIDATION)
    errors.plot(epochs, _column(history, TRAINING), "--", color=colour, linewidth=0.9)
    errors.plot(epochs, validation, color=colour, linewidth=1.4)
    steps.plot(epochs, _column(history, RATE), color=colour, drawstyle="steps-mid")
    if any_finite(validation):
        best = int(np.nanargmin(validation))
        errors.plot(epochs[best], validation[best], "o", color=colour, markersize=6, markeredgecolor=INK, zorder=5)


def _legend(models: Sequence[str]) -> list[Line2D]:
    shown = [Line2D([], [], color=colour_of(name, i), linewidth=2, label=name) for i, name in enumerate(models)]
    look = {"color": INK, "linewidth": 1.2}
    shown += [Line2D([], [], label="validation", **look), Line2D([], [], linestyle="--", label="training", **look)]
    return [*shown, Line2D([], [], marker="o", linestyle="none", color=INK, label="best epoch")]
