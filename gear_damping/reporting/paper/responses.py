"""Figures 4, 5 and 10: the mesh stiffness, and the wavelet transform of the response."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gear_damping.reporting.paper.physics import Response
from gear_damping.reporting.paper.printed import STIFFNESS_N_PER_M
from gear_damping.reporting.paper.study import Study
from gear_damping.reporting.style import BLUE, CYCLE, GREEN, INK, RED, SEQUENTIAL, legend_above, new_figure, styled

DECIBELS = 40  # shown below the peak
SHOWN_S = 0.012  # of the response: more would be a blur
HARMONICS = 8  # of the mesh that are marked
NAMES = {
    "right": "mass of Table 1",
    "as_printed": "as printed: mass 1 kg",
    "eccentricity": "eccentric by 20 µm",
    "eccentricity_printed": "as printed: E added to K",
}
COLOURS = {"right": BLUE, "as_printed": RED, "eccentricity": GREEN, "eccentricity_printed": RED}


def stiffness_figure(study: Study) -> Figure:
    """Mesh stiffness over time in the three readings of the paper's words; a formula, so without an interval."""
    with styled():
        figure = new_figure(3.4)
        axes = figure.subplots()
        for (label, one), colour in zip(study.physics.stiffnesses.items(), CYCLE, strict=False):
            mean = one.stiffness[:-1].mean() / 1e8
            line = "--" if label.startswith("rect") else "-"
            axes.plot(1e3 * one.time_s, one.stiffness / 1e8, line, color=colour, label=f"{label}; mean {mean:.2f}")
        for value, name in zip(STIFFNESS_N_PER_M, ("printed $K_{min}$", "printed $K_{max}$"), strict=True):
            axes.axhline(value / 1e8, color=INK, linewidth=0.8, linestyle=":")
            axes.annotate(name, (1.01, value / 1e8), xycoords=("axes fraction", "data"), va="center", fontsize=9)
        first = next(iter(study.physics.stiffnesses.values()))
        axes.set(xlabel="time / ms", ylabel="mesh stiffness / (10⁸ N/m)", xlim=(0, 1e3 * first.time_s[-1]), ylim=(0, 5))
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=1)
        return figure


def responses_figure(study: Study, left: str, right: str, beside: str | None = None) -> Figure:
    """Two scalograms over the mean magnitude of both, with the ridges that they show.

    Args:
        study: What was found.
        left: Response of the left scalogram.
        right: Of the right one.
        beside: A further one, of which the mean magnitude alone is shown.
    """
    found = study.physics.responses
    with styled():
        figure = new_figure(6.6)
        grid = figure.add_gridspec(2, 2, height_ratios=(1.25, 1))
        first = figure.add_subplot(grid[0, 0])
        second = figure.add_subplot(grid[0, 1], sharey=first)
        image = None
        for axes, name in ((first, left), (second, right)):
            image = _scalogram(axes, found[name])
            axes.set_title(NAMES[name])
        first.set_ylabel("frequency / Hz")
        second.tick_params(labelleft=False)
        figure.colorbar(image, ax=[first, second], label="magnitude / dB of the peak", pad=0.015, aspect=14)
        names = [name for name in (beside, left, right) if name]
        _spectra(figure.add_subplot(grid[1, :]), {name: found[name] for name in names})
        return figure


def _scalogram(axes: Axes, one: Response) -> object:
    """The transform of the first milliseconds; hatched: what the ends reach; dashed: the natural frequency."""
    shown = one.time_s <= SHOWN_S
    time = 1e3 * one.time_s[shown]
    level = 20 * np.log10(np.maximum(one.magnitude[:, shown] / one.magnitude.max(), 1e-12))
    look = {"vmin": -DECIBELS, "vmax": 0, "cmap": SEQUENTIAL, "shading": "nearest", "rasterized": True}
    image = axes.pcolormesh(time, one.frequencies_hz, level, **look)
    cone = one.cone[:, shown].astype(float)
    if cone.any():
        axes.contourf(time, one.frequencies_hz, cone, levels=[0.5, 1.5], colors="none", hatches=["///"])
    axes.axhline(one.natural_frequency_hz, color="white", linestyle="--", linewidth=1.2)
    axes.annotate(
        f"$f_n$ = {one.natural_frequency_hz:.0f} Hz", (time[-1], one.natural_frequency_hz), (-4, 4), color="white",
        textcoords="offset points", ha="right", fontsize=9,
    )  # fmt: skip
    axes.set(yscale="log", xlabel="time / ms", xlim=(time[0], time[-1]))
    axes.set_ylim(one.frequencies_hz[0], one.frequencies_hz[-1])
    axes.grid(visible=False)
    return image


def _spectra(axes: Axes, responses: dict[str, Response]) -> None:
    """Mean magnitude with its range over damping ratios; ridges with their half-power width."""
    top = max(float(np.nanmax(one.mean_magnitude)) for one in responses.values())
    for number, (name, one) in enumerate(responses.items()):
        size, colour = one.mean_magnitude / top, COLOURS[name]
        line = "--" if name == "eccentricity_printed" else "-"
        count = len(one.ridges)
        label = f"{NAMES[name]}: {count} ridge" + ("s" if count != 1 else "")
        axes.plot(one.fine_hz, size.mean(axis=0), line, color=colour, label=label)
        axes.fill_between(one.fine_hz, size.min(axis=0), size.max(axis=0), color=colour, alpha=0.18, linewidth=0)
        highest = size.mean(axis=0).max()
        for ridge in one.ridges:
            width = [[ridge.frequency_hz - ridge.low_hz], [ridge.high_hz - ridge.frequency_hz]]
            height = ridge.share * highest * (1 + 0.05 * number)
            axes.errorbar(ridge.frequency_hz, height, xerr=width, fmt="o", color=colour, markersize=4, capsize=3)
    one = next(iter(responses.values()))
    for harmonic in range(1, HARMONICS + 1):
        axes.axvline(harmonic * one.mesh_frequency_hz, color=INK, linewidth=0.6, linestyle=":", zorder=0.5)
    for name, other in responses.items():
        axes.axvline(other.natural_frequency_hz, color=COLOURS[name], linewidth=0.9, linestyle="--", zorder=0.6)
    axes.set(xscale="log", xlabel="frequency / Hz", ylabel="mean magnitude / largest", ylim=(0, 1.2))
    axes.set_xlim(one.fine_hz[0], one.fine_hz[-1])
    axes.set_title(
        "mean over time, its range over damping ratios of 0.1 to 0.6 %, and ridges\n"
        "bars: half-power width, moved apart; dotted: mesh harmonics; dashed: $f_n$", fontsize=9, pad=20,
    )  # fmt: skip
    legend_above(axes)
    axes.get_legend().set_in_layout(False)  # the title keeps the room for it, and its width shall not cost any
