"""A simulated run: time, spectrum and phase plane."""

import numpy as np
import torch
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.arrays import Array, any_finite, extent, series, time_axis
from gear_damping.reporting.figures.marks import mark_orders
from gear_damping.reporting.figures.spectra import FREQUENCY_LABEL, ORDER_LABEL, SHOWN_MESH_HARMONICS, draw_spectra
from gear_damping.reporting.style import BLUE, legend_above, new_figure, say_empty, styled
from gear_damping.signals.envelope import upsample
from gear_damping.signals.spectra import amplitude_spectrum

LEAST_SAMPLES = 32
REFINEMENT = 8


def simulation_figure(
    time: ArrayLike,
    signal: ArrayLike,
    velocity: ArrayLike,
    unit: str,
    sampling_rate: float,
    *,
    label: str = "response",
    shaft_frequency_hz: float | None = None,
    n_teeth_pinion: float | None = None,
    gear_order: float | None = None,
) -> Figure:
    """A simulated run over time, its spectrum (in orders of the pinion shaft where there is one), phase plane.

    Args:
        time: In s, shape (time,).
        signal: In `unit`, shape (time,).
        velocity: In m/s, shape (time,).
        unit: Unit of the signal.
        sampling_rate: Samples per second (Hz).
        label: What the signal is.
        shaft_frequency_hz: Turns of the pinion per second; None: no shaft, the spectrum is over Hz.
        n_teeth_pinion: Order of the mesh.
        gear_order: Turns of the gear per turn of the pinion.

    Raises:
        ValueError: the arrays have different shapes.
    """
    time, signal, velocity = series(time=time, signal=signal, velocity=velocity)
    with styled():
        figure = new_figure(6.4)
        grid = figure.add_gridspec(2, 2, width_ratios=(1.6, 1))
        over_time, spectrum, phase = (figure.add_subplot(grid[p]) for p in (np.s_[0, :], np.s_[1, 0], np.s_[1, 1]))
        _over_time(over_time, time, signal, f"{label} / {unit}")
        spectrum.set(xlabel=ORDER_LABEL if shaft_frequency_hz else FREQUENCY_LABEL, ylabel=f"amplitude / {unit}")
        top = _spectrum(spectrum, signal, sampling_rate, shaft_frequency_hz, n_teeth_pinion)
        if top and shaft_frequency_hz:
            mark_orders(spectrum, top, pinion_order=1.0, gear_order=gear_order, mesh_order=n_teeth_pinion)
            legend_above(spectrum, spectrum.get_legend_handles_labels()[0][1:], columns=3)
        _phase_plane(phase, signal, velocity)
        phase.set(xlabel=f"{label} / {unit}", ylabel="velocity / (m/s)")
        return figure


def _phase_plane(axes: Axes, signal: Array, velocity: Array) -> None:
    """The orbit; between samples it is interpolated, since a cycle may have few of them."""
    if not np.isfinite(signal + velocity).all() or len(signal) < LEAST_SAMPLES:
        say_empty(axes, "no orbit: too short or not finite")
        return
    orbit = upsample(torch.as_tensor(np.stack([signal, velocity])), REFINEMENT).numpy()
    axes.plot(orbit[0], orbit[1], color=BLUE, linewidth=0.5, alpha=0.8)


def _over_time(axes: Axes, time: Array, signal: Array, name: str) -> None:
    shown, time_label = time_axis(time)
    axes.plot(shown, signal, color=BLUE, linewidth=0.7)
    axes.set(xlabel=time_label, ylabel=name)
    limits = extent([shown])
    if limits:
        axes.set_xlim(limits)
    if not any_finite(signal):
        say_empty(axes)


def _spectrum(axes: Axes, signal: Array, rate: float, shaft: float | None, teeth: float | None) -> float:
    """Draw the amplitude spectrum; returns the highest order or frequency shown."""
    if len(signal) < LEAST_SAMPLES or not np.isfinite(signal).all():
        say_empty(axes, "no spectrum: too short or not finite")
        return 0.0
    frequencies, amplitudes = amplitude_spectrum(torch.as_tensor(signal - signal.mean())[None], rate)
    orders = frequencies.numpy() / (shaft or 1.0)
    highest = SHOWN_MESH_HARMONICS * teeth if shaft and teeth else None
    return draw_spectra(axes, orders, {"response": amplitudes[0].numpy()}, highest)
