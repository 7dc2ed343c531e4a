"""Figures 7, 8, 12, 13 and 15: one effect, the paper's protocol beside runs that were not trained on."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gear_damping.reporting.paper.printed import RMSE
from gear_damping.reporting.paper.study import BLIND, MEAN, NETWORKS, Part, Study
from gear_damping.reporting.style import INK, PURPLE, colour_of, marker_of, new_figure, styled

PROTOCOL_NAMES = {"paper": "one run", "paper_many_runs": "many runs, cut by time", "by_run": "unseen runs"}
AS_FRACTION = 100.0  # % of critical that 1 is, where a printed error is a fraction
OFFSET = 0.17  # rows between the estimators of one protocol
FLOOR_PERCENT = 5e-5  # of the error axis, in %: what always saying the one label leaves is 0 and lies below
USUAL_PERCENT = 10.0  # end of the axis of errors, % of critical: what was trained long enough lies below
ROOM = 1.5  # beyond a larger error, of it


def effect_figure(study: Study, name: str, effect: str) -> Figure:
    """Predictions along the test part of one run, predicted against true of unseen runs, and all errors.

    Args:
        study: What was found.
        name: Of the figure, for what is printed.
        effect: Its name in the study.
    """
    with styled():
        figure = new_figure(8.2)
        grid = figure.add_gridspec(3, 2, height_ratios=(1, 1.5, 1.05))
        _one_run(figure.add_subplot(grid[0, :]), study.of(effect, "paper"))
        shared = None
        for column, network in enumerate(NETWORKS):
            shared = figure.add_subplot(grid[1, column], sharex=shared, sharey=shared)
            _unseen(shared, network, study, effect)
        _errors(figure.add_subplot(grid[2, :]), study, name, effect)
        handles = [_handle(one) for one in (*NETWORKS, BLIND, MEAN)]
        figure.legend(handles=handles, loc="outside upper left", ncols=4)
        return figure


def _handle(name: str) -> Line2D:
    words = {BLIND: "white noise (control)", MEAN: "mean of the labels (control)"}.get(name, name)
    return Line2D([], [], color=colour_of(name), marker=marker_of(name), linestyle="none", label=words)


def _one_run(axes: Axes, parts: list[Part]) -> None:
    """Prediction of each test window, mean and range over seeds."""
    for name in (BLIND, *NETWORKS):
        seeds = np.array([part["predictions"][name]["windows"] for part in parts])
        number = np.arange(seeds.shape[1])
        axes.plot(number, seeds.mean(axis=0), color=colour_of(name), linewidth=1.0)
        axes.fill_between(number, seeds.min(axis=0), seeds.max(axis=0), color=colour_of(name), alpha=0.2, linewidth=0)
    true = parts[0]["predictions"][NETWORKS[0]]["true"][0]
    axes.axhline(true, color=INK, linestyle=":", linewidth=1.2)
    axes.set(xlabel="test window of the one run", ylabel="damping ratio / %", xlim=(0, seeds.shape[1] - 1))
    axes.set_title(f"one run, cut by time: one label ({true:g} %, dotted); bands: range over seeds")


def _unseen(axes: Axes, network: str, study: Study, effect: str) -> None:
    """Predicted against true of every test run of every seed; bars: deviation over its windows."""
    parts = study.of(effect, "by_run")
    true, predicted, std = (
        np.concatenate([part["predictions"][network][key] for part in parts]) for key in ("true", "predicted", "spread")
    )
    colour = colour_of(network)
    axes.errorbar(true, predicted, yerr=std, fmt="none", ecolor=colour, alpha=0.22, linewidth=0.7)
    axes.plot(true, predicted, marker_of(network), color=colour, markersize=3, alpha=0.8)
    ends = np.array([0.08, 0.62])
    axes.plot(ends, ends, ":", color=INK, linewidth=1)
    level = np.mean([part["predictions"][MEAN]["predicted"][0] for part in parts])
    axes.axhline(level, color=INK, linestyle="--", linewidth=0.9)
    error = study.score(effect, "by_run", network)
    axes.set(xlabel="true damping ratio / %", ylabel="predicted / %", xlim=ends, ylim=(0, 0.75))
    axes.set_title(f"unseen runs, {network}: {error.mean:.3f} ± {error.std:.3f} %", fontsize=9.5)


def _errors(axes: Axes, study: Study, name: str, effect: str) -> None:
    """RMSE (1/N) under every protocol, with the deviation over seeds; printed values in both readings."""
    rows = [protocol for protocol in PROTOCOL_NAMES if study.of(effect, protocol)]
    most = USUAL_PERCENT
    for row, protocol in enumerate(rows):
        for number, one in enumerate((*NETWORKS, BLIND, MEAN)):
            error = study.score(effect, protocol, one)
            if error is not None and error.mean > 0:
                most = max(most, ROOM * (error.mean + error.std))
                place = row + OFFSET * (number - 1.5)
                look = {"fmt": marker_of(one), "color": colour_of(one), "markersize": 5, "capsize": 2.5}
                axes.errorbar(error.mean, place, xerr=_bar(error.mean, error.std), **look)
    printed = len(rows)
    for number, network in enumerate(NETWORKS):
        value, place = RMSE[name].of(network), printed + OFFSET * (2 * number - 1)
        axes.plot([value, AS_FRACTION * value], [place, place], color=PURPLE, linewidth=0.9)
        axes.plot(value, place, marker_of(network), color=colour_of(network), markerfacecolor="none", markersize=6)
        axes.plot(AS_FRACTION * value, place, marker_of(network), color=colour_of(network), markersize=6)
    axes.set_yticks(range(printed + 1), labels=[*(PROTOCOL_NAMES[one] for one in rows), "printed"])
    axes.set(xscale="log", xlabel="RMSE (1/N) / % of critical", ylim=(printed + 0.6, -0.6), xlim=(FLOOR_PERCENT, most))
    axes.set_title("bars: deviation over seeds; printed: hollow if it is in %, full if it is a fraction", fontsize=9.5)


def _bar(mean: float, std: float) -> list[list[float]]:
    """A bar that stays on a logarithmic axis."""
    return [[min(std, 0.9 * mean)], [std]]
