"""The spectrum of what the simulation leaves, before and after, over orders or frequencies."""

from dataclasses import dataclass

from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.axis_names import axis
from gear_damping.reporting.figures.spectra import (
    FREQUENCY_LABEL,
    Spectra,
    draw_spectra,
    spectra_over_orders,
)
from gear_damping.reporting.style import PURPLE, legend_above, new_figure, styled


@dataclass(frozen=True, eq=False)
class ResidualSpectrum:
    """Spectrum of the residual of one record; amplitudes of shape (place,) in the channel's unit.

    Args:
        places: Orders of the pinion, or frequencies (Hz) where `mesh_order` is None; ascending, shape (place,).
        before: Amplitudes of the nominal simulation's residual.
        after: Those of the extended simulation; None: nothing was added.
        measured: Amplitudes of the record.
        floor: Amplitudes of the noise alone.
        mesh_order: Teeth of the pinion; None: no gears, or no whole turn.
        gear_order: Turns of the gear per turn of the pinion.
        natural_frequency_hz: Marked over frequencies with its third harmonic, where a hardening spring shows.
        record: Whose spectrum it is.
    """

    places: ArrayLike
    before: ArrayLike
    after: ArrayLike | None = None
    measured: ArrayLike | None = None
    floor: ArrayLike | None = None
    mesh_order: float | None = None
    gear_order: float | None = None
    natural_frequency_hz: float | None = None
    record: str = ""

    @property
    def lines(self) -> Spectra:
        """Amplitudes by label."""
        found = {"measured": self.measured, "before": self.before, "after": self.after, "noise floor": self.floor}
        return {label: values for label, values in found.items() if values is not None}


def residual_spectrum_figure(spectrum: ResidualSpectrum, unit: str) -> Figure:
    """Amplitudes of the residual over orders of the pinion with shaft and mesh orders marked, or over frequencies.

    Args:
        spectrum: The spectrum.
        unit: Unit of the channel.

    Raises:
        ValueError: the arrays have different shapes.
    """
    name = axis("residual amplitude", unit)
    if spectrum.mesh_order is None:
        return _over_frequencies(spectrum, name)
    marks = {"pinion_order": 1.0, "gear_order": spectrum.gear_order, "mesh_order": spectrum.mesh_order}
    return spectra_over_orders(spectrum.places, spectrum.lines, name, marks)


def _over_frequencies(spectrum: ResidualSpectrum, name: str) -> Figure:
    with styled():
        figure = new_figure(4.0)
        axes = figure.subplots()
        axes.set(xlabel=FREQUENCY_LABEL, ylabel=name)
        top = draw_spectra(axes, spectrum.places, spectrum.lines)
        for harmonic, label in ((1, "natural frequency"), (3, "three times it")):
            place = harmonic * (spectrum.natural_frequency_hz or 0.0)
            if 0 < place <= top:
                axes.axvline(place, color=PURPLE, linewidth=1.1, linestyle=":" if harmonic > 1 else "--", label=label)
        legend_above(axes, columns=6)
        return figure
