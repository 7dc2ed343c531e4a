"""The spectrum of what the simulation leaves, before and after, over orders or frequencies."""

from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.spectra import (
    FREQUENCY_LABEL,
    Spectra,
    draw_spectra,
    spectra_over_orders,
)
from gear_damping.reporting.style import PURPLE, legend_above, new_figure, styled


def residual_orders_figure(
    orders: ArrayLike,
    before: ArrayLike,
    after: ArrayLike | None = None,
    *,
    unit: str,
    measured: ArrayLike | None = None,
    floor: ArrayLike | None = None,
    pinion_order: float = 1.0,
    gear_order: float | None = None,
    mesh_order: float | None = None,
) -> Figure:
    """Amplitudes of the residual over orders of the pinion, with shaft and mesh orders marked.

    Args:
        orders: Cycles per turn of the pinion, ascending, shape (order,).
        before: Amplitudes of the nominal simulation's residual in `unit`, shape (order,).
        after: Those of the extended simulation; None: nothing was added.
        unit: Unit of the channel.
        measured: Amplitudes of the record itself.
        floor: Amplitudes that the noise alone would have.
        pinion_order: Order of the pinion shaft.
        gear_order: Order of the gear shaft.
        mesh_order: Order of the mesh, marked with its harmonics.

    Raises:
        ValueError: the arrays have different shapes.
    """
    marks = {"pinion_order": pinion_order, "gear_order": gear_order, "mesh_order": mesh_order}
    return spectra_over_orders(orders, _spectra(before, after, measured, floor), f"residual amplitude / {unit}", marks)


def residual_frequencies_figure(
    frequencies_hz: ArrayLike,
    before: ArrayLike,
    after: ArrayLike | None = None,
    *,
    unit: str,
    measured: ArrayLike | None = None,
    floor: ArrayLike | None = None,
    natural_frequency_hz: float | None = None,
    highest_hz: float | None = None,
) -> Figure:
    """The same for a rig without shafts, over frequencies (Hz), with the natural frequency marked.

    Args:
        frequencies_hz: Ascending, shape (frequency,).
        before: Amplitudes of the nominal simulation's residual in `unit`, shape (frequency,).
        after: Those of the extended simulation; None: nothing was added.
        unit: Unit of the channel.
        measured: Amplitudes of the record itself.
        floor: Amplitudes that the noise alone would have.
        natural_frequency_hz: Marked with its third harmonic, where a hardening spring shows.
        highest_hz: End of the axis; None: the last frequency.

    Raises:
        ValueError: the arrays have different shapes.
    """
    with styled():
        figure = new_figure(4.0)
        axes = figure.subplots()
        axes.set(xlabel=FREQUENCY_LABEL, ylabel=f"residual amplitude / {unit}")
        top = draw_spectra(axes, frequencies_hz, _spectra(before, after, measured, floor), highest_hz)
        for harmonic, label in ((1, "natural frequency"), (3, "three times it")):
            place = harmonic * (natural_frequency_hz or 0.0)
            if 0 < place <= top:
                axes.axvline(place, color=PURPLE, linewidth=1.1, linestyle=":" if harmonic > 1 else "--", label=label)
        legend_above(axes, columns=6)
        return figure


def _spectra(
    before: ArrayLike, after: ArrayLike | None, measured: ArrayLike | None, floor: ArrayLike | None
) -> Spectra:
    found = {"measured": measured, "before": before, "after": after, "noise floor": floor}
    return {label: values for label, values in found.items() if values is not None}
