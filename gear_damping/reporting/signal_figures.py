"""Figures of signals: stiffness, response, scalogram, simulated runs, identified records."""

from collections.abc import Mapping, Sequence
from math import pi

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from gear_damping.reporting.style import BLUE, GREEN, INK, ORANGE, PALE, RED, new_figure, styled

Array = NDArray[np.floating]
SHOWN_MESH_PERIODS = 3
DECIBELS = 50  # shown below the peak of a scalogram


def mesh_stiffness_figure(mesh_angle: Array, stiffness: Array) -> Figure:
    """Mesh stiffness (N/m) over mesh angle (rad), the first periods."""
    with styled():
        figure = new_figure(8, 3)
        axes = figure.subplots()
        turns = (np.asarray(mesh_angle) - mesh_angle[0]) / (2 * pi)
        shown = np.abs(turns) <= SHOWN_MESH_PERIODS
        axes.plot(np.abs(turns[shown]), np.asarray(stiffness)[shown] / 1e6, color=BLUE)
        axes.set(xlabel="mesh periods", ylabel="mesh stiffness / (N/µm)", xlim=(0, SHOWN_MESH_PERIODS), ylim=(0, None))
        return figure


def response_figure(time: Array, signal: Array, unit: str, label: str = "transmission error") -> Figure:
    """A record over time: the whole of it, and its beginning."""
    with styled():
        figure = new_figure(8, 4.5)
        whole, beginning = figure.subplots(2, 1)
        part = max(2, len(time) // 10)
        for axes, stop in ((whole, len(time)), (beginning, part)):
            axes.plot(np.asarray(time[:stop]) * 1e3, signal[:stop], color=BLUE, linewidth=0.8)
            axes.set(ylabel=f"{label} / {unit}", xlim=(time[0] * 1e3, time[stop - 1] * 1e3))
        beginning.set(xlabel="time / ms")
        return figure


def scalogram_figure(
    time: Array,
    frequencies_hz: Array,
    coefficients: Array,
    cone_of_influence: NDArray[np.bool_],
    *,
    mesh_frequency_hz: float | None = None,
    natural_frequency_hz: float | None = None,
) -> Figure:
    """Magnitude of wavelet coefficients (scale, time) in dB; what the ends touch is hatched."""
    with styled():
        figure = new_figure(8, 4.5)
        axes = figure.subplots()
        size = np.abs(np.asarray(coefficients, dtype=float))
        level = 20 * np.log10(np.maximum(size / max(float(size.max()), 1e-300), 1e-12))
        milliseconds = np.asarray(time) * 1e3
        image = axes.pcolormesh(
            milliseconds,
            frequencies_hz,
            level,
            vmin=-DECIBELS,
            vmax=0,
            cmap="cividis",
            shading="nearest",
            rasterized=True,
        )
        affected = np.asarray(cone_of_influence, dtype=float)
        axes.contourf(milliseconds, frequencies_hz, affected, levels=[0.5, 1.5], colors="none", hatches=["///"])
        axes.contour(milliseconds, frequencies_hz, affected, levels=[0.5], colors="white", linewidths=0.8)
        axes.set(
            yscale="log", xlabel="time / ms", ylabel="frequency / Hz", ylim=(min(frequencies_hz), max(frequencies_hz))
        )
        axes.grid(visible=False)
        marks = _marks(mesh_frequency_hz, natural_frequency_hz, max(frequencies_hz))
        edge = axes.secondary_yaxis("right")
        edge.set_yscale("log")
        inside = {f: name for f, name in marks.items() if min(frequencies_hz) <= f <= max(frequencies_hz)}
        edge.set_yticks(list(inside), labels=list(inside.values()))
        edge.minorticks_off()
        for frequency in inside:
            axes.axhline(frequency, color="white", linewidth=0.6, linestyle=":")
        figure.colorbar(image, ax=axes, label="magnitude / dB of the peak", pad=0.08)
        axes.set_title("hatched: the transform reaches beyond the record", fontsize=9, color=PALE, loc="left")
        return figure


def _marks(mesh: float | None, natural: float | None, highest: float) -> dict[float, str]:
    """Mesh harmonics and the natural frequency by frequency."""
    marks = {}
    if mesh:
        marks |= {h * mesh: "M" if h == 1 else f"{h}M" for h in range(1, int(highest / mesh) + 1) if h <= 4}
    if natural:
        marks |= {natural: "$f_n$"}
    return marks


def simulation_figure(
    time: Array,
    signal: Array,
    velocity: Array,
    unit: str,
    sampling_rate: float,
    *,
    shaft_frequency_hz: float | None = None,
    n_teeth_pinion: float | None = None,
    gear_order: float | None = None,
) -> Figure:
    """A simulated run: time, spectrum (in orders of the pinion shaft where there is one), phase plane."""
    with styled():
        figure = new_figure(9, 6.5)
        grid = figure.add_gridspec(2, 2)
        over_time, spectrum, phase = (figure.add_subplot(grid[p]) for p in (np.s_[0, :], np.s_[1, 0], np.s_[1, 1]))
        over_time.plot(np.asarray(time) * 1e3, signal, color=BLUE, linewidth=0.7)
        over_time.set(xlabel="time / ms", ylabel=f"response / {unit}", xlim=(time[0] * 1e3, time[-1] * 1e3))
        _spectrum(spectrum, signal, unit, sampling_rate, shaft_frequency_hz, n_teeth_pinion, gear_order)
        phase.plot(signal, velocity, color=BLUE, linewidth=0.4, alpha=0.7)
        phase.set(xlabel=f"response / {unit}", ylabel="velocity / (m/s)")
        return figure


def _spectrum(
    axes: Axes,
    signal: Array,
    unit: str,
    rate: float,
    shaft: float | None,
    teeth: float | None,
    gear_order: float | None,
) -> None:
    window = np.hanning(len(signal))
    size = 2 * np.abs(np.fft.rfft((signal - np.mean(signal)) * window)) / window.sum()
    frequency = np.fft.rfftfreq(len(signal), 1 / rate)
    axis = frequency / shaft if shaft else frequency
    axes.semilogy(axis, np.maximum(size, size.max() * 1e-9), color=BLUE, linewidth=0.7)
    axes.set(ylabel=f"amplitude / {unit}", xlabel="order of the pinion shaft" if shaft else "frequency / Hz")
    axes.set(ylim=(size.max() * 1e-6, size.max() * 3), xlim=(0, axis[-1]))
    if shaft and teeth:
        for h in range(1, int(axis[-1] / teeth) + 1):
            axes.axvline(h * teeth, color=ORANGE, linewidth=0.8, alpha=0.6, label="mesh orders" if h == 1 else None)
        axes.axvline(1, color=GREEN, linewidth=0.8, label="pinion shaft")
        axes.axvline(gear_order or 0.5, color=RED, linewidth=0.8, label="gear shaft")
        axes.legend(fontsize=8, loc="upper right")


def identification_figure(
    panels: Sequence[Mapping[str, object]], unit: str, parameters: Sequence[str], label: str = "response"
) -> Figure:
    """Measured and simulated records with their residuals.

    Args:
        panels: For each record `name`, `role`, `time` (s), `measured`, `simulated`.
        unit: Unit of the channel.
        parameters: Lines of text about what was found.
        label: What the channel is.
    """
    with styled():
        figure = new_figure(9, 1.2 + 2.6 * len(panels))
        grid = figure.subplots(len(panels), 2, squeeze=False, width_ratios=(3, 1))
        for row, panel in zip(grid, panels, strict=True):
            _record_panel(row[0], panel, unit, label)
            _close_panel(row[1], panel, unit)
        grid[0][0].legend(loc="upper right", fontsize=8, ncols=3)
        figure.suptitle("   ".join(parameters), fontsize=9, x=0.01, ha="left", wrap=True)
        return figure


def _record_panel(axes: Axes, panel: Mapping[str, object], unit: str, label: str) -> None:
    time, measured, simulated = (np.asarray(panel[key]) for key in ("time", "measured", "simulated"))
    axes.plot(time, measured, color=INK, linewidth=0.9, label="measured")
    axes.plot(time, simulated, color=BLUE, linewidth=0.9, linestyle="--", label="simulated")
    axes.plot(time, measured - simulated, color=RED, linewidth=0.7, label="residual")
    axes.set(xlabel="time / s", ylabel=f"{label} / {unit}", xlim=(time[0], time[-1]))
    axes.set_title(f"{panel['name']} ({panel['role']})", fontsize=9, loc="left")


def _close_panel(axes: Axes, panel: Mapping[str, object], unit: str) -> None:
    """A short piece of the record, so that single samples are seen."""
    time, measured, simulated = (np.asarray(panel[key]) for key in ("time", "measured", "simulated"))
    start = len(time) // 3
    piece = slice(start, start + max(10, min(120, len(time) // 8)))
    axes.plot(time[piece], measured[piece], ".", color=INK, markersize=3)
    axes.plot(time[piece], simulated[piece], color=BLUE, linewidth=0.9)
    axes.set(xlabel="time / s", title="")
