"""A simulated run: time, spectrum and phase plane."""

from dataclasses import dataclass

import numpy as np
import torch
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.arrays import Array, any_finite, extent, series, time_axis
from gear_damping.reporting.figures.axis_names import axis
from gear_damping.reporting.figures.marks import mark_orders
from gear_damping.reporting.figures.spectra import (
    DECADES,
    FREQUENCY_LABEL,
    LOW_ORDERS,
    ORDER_LABEL,
    SHOWN_MESH_HARMONICS,
    draw_spectra,
)
from gear_damping.reporting.style import BLUE, mark_empty, new_figure, styled
from gear_damping.signals.envelope import upsample
from gear_damping.signals.spectra import amplitude_spectrum

LEAST_SAMPLES = 32  # for an orbit to be drawn
REFINEMENT = 8  # points of a smooth curve between two samples


@dataclass(frozen=True, eq=False)
class ShownRun:
    """A simulated run.

    Args:
        time: In s, shape (time,).
        signal: In `unit`, shape (time,).
        velocity: In `velocity_unit`, shape (time,).
        unit: Unit of the signal.
        sampling_rate: Samples per second (Hz).
        label: What the signal is.
        title: Which run it is.
        shaft_frequency_hz: Turns of the pinion per second; None: no shaft, the spectrum is over Hz.
        n_teeth_pinion: Order of the mesh.
        gear_order: Turns of the gear per turn of the pinion.
        velocity_unit: Unit of the velocity.
    """

    time: ArrayLike
    signal: ArrayLike
    velocity: ArrayLike
    unit: str
    sampling_rate: float
    label: str = "response"
    title: str = ""
    shaft_frequency_hz: float | None = None
    n_teeth_pinion: float | None = None
    gear_order: float | None = None
    velocity_unit: str = "m/s"


def simulation_figure(run: ShownRun) -> Figure:
    """A run over time, its spectrum (in orders of the pinion shaft where there is one), phase plane.

    Raises:
        ValueError: the arrays have different shapes.
    """
    time, signal, velocity = series(time=run.time, signal=run.signal, velocity=run.velocity)
    shaft, teeth = run.shaft_frequency_hz, run.n_teeth_pinion
    with styled():
        figure = new_figure(6.8)
        grid = figure.add_gridspec(2, 3, width_ratios=(0.5, 1.5, 1.1), height_ratios=(1, 1.15))
        wide = np.s_[1, 1] if shaft else np.s_[1, :2]  # without a shaft there are no low orders
        over_time, spectrum, phase = (figure.add_subplot(grid[place]) for place in (np.s_[0, :], wide, np.s_[1, 2]))
        over_time.set_title(run.title)
        _over_time(over_time, time, signal, axis(run.label, run.unit))
        orders, amplitudes = _spectrum(signal, run.sampling_rate, shaft)
        highest = SHOWN_MESH_HARMONICS * teeth if shaft and teeth else None
        top = draw_spectra(spectrum, orders, {"response": amplitudes}, highest or _content(orders, amplitudes))
        spectrum.set_xlabel(ORDER_LABEL if shaft else FREQUENCY_LABEL)
        marks = {"pinion_order": 1.0, "gear_order": run.gear_order}
        first = spectrum
        if top and shaft:
            first = figure.add_subplot(grid[1, 0], sharey=spectrum)
            spectrum.tick_params(labelleft=False)
            _shaft_orders(first, orders, amplitudes, spectrum.get_ylim())
            mark_orders(first, LOW_ORDERS, **marks)
            mark_orders(spectrum, top, mesh_order=teeth, **marks)
            figure.legend(handles=spectrum.get_legend_handles_labels()[0][1:], loc="outside lower center", ncols=3)
        first.set_ylabel(axis("amplitude", run.unit))
        _phase_plane(phase, signal, velocity)
        phase.set(xlabel=axis(run.label, run.unit), ylabel=axis("velocity", run.velocity_unit))
        phase.locator_params(axis="x", nbins=4)
        return figure


def _phase_plane(axes: Axes, signal: Array, velocity: Array) -> None:
    """The orbit; between samples it is interpolated, since a cycle may have few of them."""
    if not np.isfinite(signal + velocity).all() or len(signal) < LEAST_SAMPLES:
        mark_empty(axes, "no orbit: too short or not finite")
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
        mark_empty(axes)


def _spectrum(signal: Array, rate: float, shaft: float | None) -> tuple[Array, Array]:
    """Orders of the shaft, or frequencies, and amplitudes of what varies; empty where there is too little."""
    if len(signal) < LEAST_SAMPLES or not np.isfinite(signal).all():
        return np.empty(0), np.empty(0)
    frequencies, amplitudes = amplitude_spectrum(torch.as_tensor(signal - signal.mean())[None], rate)
    return frequencies.numpy() / (shaft or 1.0), amplitudes[0].numpy()


def _content(frequencies: Array, amplitudes: Array) -> float | None:
    """The frequency above which there is nothing to see; None where there is nothing at all."""
    seen = frequencies[amplitudes > 10.0**-DECADES * amplitudes.max(initial=0.0)]
    return 1.1 * float(seen[-1]) if len(seen) and seen[-1] > 0 else None


def _shaft_orders(axes: Axes, orders: Array, amplitudes: Array, limits: tuple[float, float]) -> None:
    """The lowest orders with their single lines."""
    draw_spectra(axes, orders, {"response": amplitudes}, LOW_ORDERS, marker=".")
    axes.set(ylim=limits, xlabel="shaft orders", xticks=range(int(LOW_ORDERS) + 1))
