"""Figures of results: predictions, sweeps."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from gear_damping.reporting.style import INK, PALE, colour_of, new_figure, styled

SUFFIX = "/rmse_percent"
CONTROLS = ("mean", "white_noise")


def predicted_against_true_figure(predictions: Mapping[str, Any]) -> Figure:
    """Predicted against true damping ratio of each test run, one panel a model.

    Args:
        predictions: model -> {`per_run`: {`true`, `predicted`, `spread` (optional)}}, in % of critical.
    """
    shown = {name: found["per_run"] for name, found in predictions.items() if name != "mean"}
    with styled():
        figure = new_figure(3.2 * max(len(shown), 1) + 0.6, 3.6)
        panels = figure.subplots(1, max(len(shown), 1), squeeze=False, sharex=True, sharey=True)[0]
        for number, (axes, (name, found)) in enumerate(zip(panels, shown.items(), strict=False)):
            true, predicted = np.asarray(found["true"]), np.asarray(found["predicted"])
            spread = found.get("spread")
            colour = colour_of(name, number)
            axes.errorbar(
                true, predicted, yerr=spread, fmt="o", markersize=3.5, color=colour, ecolor=PALE, linewidth=0.7
            )
            low, high = min(true.min(), predicted.min()), max(true.max(), predicted.max())
            axes.plot([low, high], [low, high], color=INK, linewidth=0.8, linestyle=":")
            axes.set(xlabel="true damping ratio / %", title=name)
        panels[0].set_ylabel("predicted, mean over windows / %")
        return figure


def sweep_figure(rows: Sequence[Mapping[str, Any]], key: str) -> Figure:
    """Test error against the swept value: a line per model with its spread over seeds, controls dashed.

    Args:
        rows: One row a job, with `key` and `<model>/rmse_percent`, `<model>/rmse_percent_std`.
        key: The swept key.
    """
    with styled():
        figure = new_figure(8, 4.2)
        axes = figure.subplots()
        ordered = sorted(rows, key=lambda row: _place(row[key]))
        numeric = all(isinstance(row[key], (int, float)) for row in ordered)
        places = [float(row[key]) for row in ordered] if numeric else list(range(len(ordered)))
        names = [column.removesuffix(SUFFIX) for column in ordered[0] if column.endswith(SUFFIX)]
        for number, name in enumerate(names):
            mean = np.array([row.get(name + SUFFIX, np.nan) for row in ordered], dtype=float)
            spread = np.array([row.get(f"{name}{SUFFIX}_std") or 0.0 for row in ordered], dtype=float)
            style = "--" if name in CONTROLS else "-"
            axes.plot(places, mean, style, marker="o", markersize=4, color=colour_of(name, number), label=name)
            axes.fill_between(places, mean - spread, mean + spread, color=colour_of(name, number), alpha=0.15)
        if not numeric:
            axes.set_xticks(places, labels=[str(row[key]) for row in ordered])
        axes.set(xlabel=_axis_name(key), ylabel="test RMSE / % of critical", ylim=(0, None))
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        return figure


def _place(value: Any) -> tuple[int, Any]:
    return (0, float(value)) if isinstance(value, (int, float)) else (1, str(value))


def _axis_name(key: str) -> str:
    """The swept key in words, with its unit."""
    words = key.removeprefix("simulator.").replace("_percent", " / %").replace(".", ": ").replace("_", " ")
    return words.replace("snr db", "signal-to-noise ratio / dB")
