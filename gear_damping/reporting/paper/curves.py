"""Figures 6 and 11: how the error falls over the epochs."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gear_damping.reporting.paper.printed import CONVERGED_AT
from gear_damping.reporting.paper.study import BLIND, NETWORKS, Part, Study
from gear_damping.reporting.style import INK, colour_of, new_figure, styled

TITLES = {"paper": "one run, cut by time (the paper's protocol)", "by_run": "runs that were not trained on"}


def convergence_figure(study: Study, name: str, effect: str) -> Figure:
    """Training and validation error over epochs under two protocols, with the range over seeds.

    Args:
        study: What was found.
        name: Of the figure, for the epochs that are printed.
        effect: Whose trainings are shown.
    """
    with styled():
        figure = new_figure(4.6)
        panels = figure.subplots(1, 2)
        for axes, (protocol, title) in zip(panels, TITLES.items(), strict=True):
            for network in (*NETWORKS, BLIND):
                _curves(axes, network, study.of(effect, protocol))
            axes.set(xlabel="epoch", ylabel="RMSE / % of critical", yscale="log")
            axes.xaxis.get_major_locator().set_params(integer=True)
            axes.set_title(title, fontsize=9.5)
        panels[1].yaxis.set_minor_formatter("{x:g}")
        for network, epoch in CONVERGED_AT[name].items():
            look = {"color": colour_of(network), "linewidth": 0.9, "linestyle": ":"}
            panels[0].axvline(epoch, **look)
        handles = [Line2D([], [], color=colour_of(one), linewidth=2, label=one) for one in (*NETWORKS, BLIND)]
        handles.append(Line2D([], [], color=INK, label="validation"))
        handles.append(Line2D([], [], color=INK, linestyle="--", label="training"))
        handles.append(Line2D([], [], color=INK, linestyle=":", label="printed: converged"))
        figure.legend(handles=handles, loc="outside upper left", ncols=6, handlelength=1.6, columnspacing=1.2)
        return figure


def _curves(axes: Axes, network: str, parts: list[Part]) -> None:
    """Mean over the seeds and their range, as long as all of them train."""
    for which, line in (("validation", "-"), ("train", "--")):
        curves = [part["histories"][network][which] for part in parts]
        if not curves:
            return
        length = min(map(len, curves))
        errors = np.array([curve[:length] for curve in curves])
        epochs = np.arange(1, length + 1)
        axes.plot(epochs, errors.mean(axis=0), line, color=colour_of(network), linewidth=1.2)
        if which == "validation":
            low, high = errors.min(axis=0), errors.max(axis=0)
            axes.fill_between(epochs, low, high, color=colour_of(network), alpha=0.18, linewidth=0)
