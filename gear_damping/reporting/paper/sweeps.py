"""Figures 9 and 14: the error against the noise of the load, and predictions against the damping ratio."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gear_damping.reporting.paper.names import one_run_of
from gear_damping.reporting.paper.printed import RATIOS_PERCENT, SNRS_DB
from gear_damping.reporting.paper.study import BLIND, MEAN, NETWORKS, MeanAndStd, Study
from gear_damping.reporting.style import INK, colour_of, marker_of, new_figure, styled

TITLES = {"paper": "one run, cut by time (the paper's protocol)", "by_run": "runs that were not trained on"}
LABELS = {BLIND: "white noise (control)", MEAN: "mean of the labels (control)"}


def noise_figure(study: Study) -> Figure:
    """RMSE (1/N) against the signal-to-noise ratio of the load, under two protocols, with deviations over seeds."""
    with styled():
        figure = new_figure(4.2)
        panels = figure.subplots(1, 2)
        for axes, (protocol, title) in zip(panels, TITLES.items(), strict=True):
            shown = (*NETWORKS, BLIND) if protocol == "paper" else (*NETWORKS, BLIND, MEAN)
            for name in shown:
                _line(axes, name, SNRS_DB, lambda snr, n=name, p=protocol: study.score(f"noise_{snr:g}_db", p, n))
            axes.set(xlabel="signal-to-noise ratio of the load / dB", ylabel="RMSE (1/N) / % of critical")
            axes.set_title(title, fontsize=9.5)
            axes.set_xticks(SNRS_DB)
            axes.set_xlim(-2, 52)
            axes.set_ylim(0, 1.25 * axes.get_ylim()[1])
        _legend(figure)
        return figure


def ratios_figure(study: Study) -> Figure:
    """Predicted against true damping ratio: each its own run, trained on it, and runs that were not trained on."""
    with styled():
        figure = new_figure(4.7)
        panels = figure.subplots(1, 2, sharex=True, sharey=True)
        for axes, (protocol, title) in zip(panels, TITLES.items(), strict=True):
            axes.plot((0, 0.7), (0, 0.7), ":", color=INK, linewidth=1)
            for number, name in enumerate((*NETWORKS, BLIND, MEAN)):
                find = _of_one_run if protocol == "paper" else _of_unseen
                shift = 0.009 * (number - 1.5)  # % to the side, so that bars do not cover each other
                _line(axes, name, RATIOS_PERCENT, lambda ratio, n=name, f=find: f(study, ratio, n), shift)
            axes.set(xlabel="true damping ratio / %", ylabel="predicted damping ratio / %")
            axes.set(xlim=(0.05, 0.65), ylim=(0, 0.75))
            axes.set_title(title, fontsize=9.5)
        _legend(figure)
        return figure


def _of_one_run(study: Study, ratio: float, name: str) -> MeanAndStd | None:
    """What is predicted on the test windows of the run that was trained on, over windows and seeds."""
    parts = study.of(one_run_of(ratio), "paper")
    if not parts:
        return None
    return _all_windows(
        [part["predictions"][name]["predicted"][0] for part in parts],
        [part["predictions"][name]["spread"][0] for part in parts],
    )


def _of_unseen(study: Study, ratio: float, name: str) -> MeanAndStd | None:
    """What is predicted on unseen runs of the ratio, over runs and seeds."""
    means, deviations = (study.of_ratio(ratio, name, key) for key in ("predicted", "spread"))
    return None if means is None else _all_windows(means.values, deviations.values)


def _all_windows(means: list[float] | tuple[float, ...], deviations: list[float] | tuple[float, ...]) -> MeanAndStd:
    """Mean, and deviation within and between seeds together."""
    within, between = np.mean(np.square(deviations)), np.var(means)
    return MeanAndStd(float(np.mean(means)), float((within + between) ** 0.5), tuple(means))


def _line(
    axes: Axes, name: str, places: tuple[float, ...], find: Callable[[float], MeanAndStd | None], shift: float = 0.0
) -> None:
    found = [(place, find(place)) for place in places]
    found = [(place, one) for place, one in found if one is not None]
    if not found:
        return
    look = {"color": colour_of(name), "marker": marker_of(name), "markersize": 5, "capsize": 3, "elinewidth": 1}
    style = "--" if name in LABELS else "-"
    axes.errorbar(
        [place + shift for place, _ in found], [one.mean for _, one in found], yerr=[one.std for _, one in found],
        linestyle="none" if shift else style, linewidth=1, **look,
    )  # fmt: skip


def _legend(figure: Figure) -> None:
    handles = [
        Line2D([], [], color=colour_of(name), marker=marker_of(name), linestyle="--" if name in LABELS else "-",
               label=LABELS.get(name, name))
        for name in (*NETWORKS, BLIND, MEAN)
    ]  # fmt: skip
    figure.legend(handles=handles, loc="outside upper left", ncols=4)
