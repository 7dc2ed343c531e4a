"""The wavelet transform of a record as a picture over time and frequency."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from gear_damping.reporting.figures.arrays import Array, grid, series, time_axis
from gear_damping.reporting.figures.marks import harmonics, name_on_right
from gear_damping.reporting.style import INK, SEQUENTIAL, mark_empty, new_figure, styled

DECIBELS = 50  # shown below the peak
MOST_HARMONICS = 6  # that are marked


def scalogram_figure(
    time: ArrayLike,
    frequencies_hz: ArrayLike,
    coefficients: ArrayLike,
    cone_of_influence: ArrayLike,
    *,
    mesh_frequency_hz: float | None = None,
    natural_frequency_hz: float | None = None,
) -> Figure:
    """Magnitude of wavelet coefficients in dB of the peak, with mesh harmonics and natural frequency marked.

    Args:
        time: In s, shape (time,), at least 2.
        frequencies_hz: Frequency of each scale (Hz), ascending, shape (scale,), at least 2.
        coefficients: Real or complex, shape (scale, time).
        cone_of_influence: True where the ends of the record are felt, shape (scale, time): shaded.
        mesh_frequency_hz: Marks the mesh frequency M and its harmonics; None: no mesh.
        natural_frequency_hz: Marks f_n.

    Raises:
        ValueError: the shapes do not fit.
    """
    (time,), (frequencies,) = series(time=time), series(frequencies_hz=frequencies_hz)
    size = grid(np.abs(np.asarray(coefficients)), frequencies, time, "coefficients")
    affected = grid(np.asarray(cone_of_influence, dtype=float), frequencies, time, "cone_of_influence")
    shown_time, time_label = time_axis(time)
    with styled():
        figure = new_figure(4.6)
        axes = figure.subplots()
        axes.set(xlabel=time_label, ylabel="frequency / Hz")
        axes.grid(visible=False)
        if min(size.shape) < 2 or not np.nanmax(np.nan_to_num(size)) > 0:
            mark_empty(axes, "no coefficients to show")
            return figure
        _picture(axes, shown_time, frequencies, size)
        _cone(axes, shown_time, frequencies, affected)
        _frequency_marks(axes, mesh_frequency_hz, natural_frequency_hz)
        axes.set_title(_explanation(affected, mesh_frequency_hz, natural_frequency_hz), fontsize=9, color=INK)
        return figure


def _picture(axes: Axes, time: Array, frequencies: Array, size: Array) -> None:
    level = 20 * np.log10(np.maximum(size / np.nanmax(size), 1e-12))
    image = axes.pcolormesh(
        time, frequencies, level, vmin=-DECIBELS, vmax=0, cmap=SEQUENTIAL, shading="nearest", rasterized=True
    )
    axes.set(yscale="log", xlim=(time[0], time[-1]), ylim=(frequencies[0], frequencies[-1]))
    axes.figure.colorbar(image, ax=axes, label="magnitude / dB of the peak", pad=0.015)


def _cone(axes: Axes, time: Array, frequencies: Array, affected: NDArray[np.float64]) -> None:
    """Shade what the ends of the record reach."""
    if not affected.any():
        return
    axes.contourf(time, frequencies, affected, levels=[0.5, 1.5], colors=["white"], alpha=0.35)
    axes.contourf(time, frequencies, affected, levels=[0.5, 1.5], colors="none", hatches=["///"])
    if not affected.all():
        axes.contour(time, frequencies, affected, levels=[0.5], colors="white", linewidths=1.2)


def _frequency_marks(axes: Axes, mesh: float | None, natural: float | None) -> None:
    """Dotted lines at the mesh harmonics, a dashed one at the natural frequency, names at the right."""
    low, high = axes.get_ylim()
    found = {("M" if h == 1 else f"{h} M"): f for h, f in enumerate(harmonics(mesh, high)[:MOST_HARMONICS], start=1)}
    for frequency in found.values():
        axes.axhline(frequency, color="white", linewidth=0.9, linestyle=":")
    if natural and low <= natural <= high:
        axes.axhline(natural, color="white", linewidth=1.1, linestyle="--")
        found["$f_n$"] = natural
    name_on_right(axes, found)


def _explanation(affected: Array, mesh: float | None, natural: float | None) -> str:
    """What the marks mean."""
    parts = ["hatched: the transform reaches beyond the record"] if affected.any() else []
    parts += ["M: mesh frequency"] if mesh else []
    parts += ["$f_n$: natural frequency"] if natural else []
    return "      ".join(parts)
