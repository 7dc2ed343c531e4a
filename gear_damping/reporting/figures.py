"""Every figure of the project by one name."""

from matplotlib.figure import Figure

from gear_damping.reporting.result_figures import predicted_against_true_figure, sweep_figure
from gear_damping.reporting.signal_figures import (
    identification_figure,
    mesh_stiffness_figure,
    response_figure,
    scalogram_figure,
    simulation_figure,
)
from gear_damping.reporting.style import save

__all__ = [
    "Figure",
    "identification_figure",
    "mesh_stiffness_figure",
    "predicted_against_true_figure",
    "response_figure",
    "save",
    "scalogram_figure",
    "simulation_figure",
    "sweep_figure",
]
