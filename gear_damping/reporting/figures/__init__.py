"""Every figure of the project by one name, from plain arrays or a few that belong together; a matplotlib Figure."""

from matplotlib.figure import Figure

from gear_damping.reporting.figures.candidates import candidates_figure
from gear_damping.reporting.figures.casing import (
    Turn,
    casing_kurtosis_figure,
    casing_orders_figure,
    casing_turns_figure,
)
from gear_damping.reporting.figures.damping import DampingBand, DampingPanel, damping_figure
from gear_damping.reporting.figures.forest import forest_figure
from gear_damping.reporting.figures.identification import identification_figure
from gear_damping.reporting.figures.misfit import misfit_figure
from gear_damping.reporting.figures.overlay import Overlay, overlay_figure
from gear_damping.reporting.figures.predictions import predicted_against_true_figure
from gear_damping.reporting.figures.residual_force import (
    ForceMap,
    ForceSurface,
    residual_force_map_figure,
    residual_force_surface_figure,
)
from gear_damping.reporting.figures.residual_spectrum import ResidualSpectrum, residual_spectrum_figure
from gear_damping.reporting.figures.response import response_figure
from gear_damping.reporting.figures.scalogram import scalogram_figure
from gear_damping.reporting.figures.simulation import ShownRun, simulation_figure
from gear_damping.reporting.figures.stiffness import mesh_stiffness_figure
from gear_damping.reporting.figures.sweep import sweep_figure
from gear_damping.reporting.figures.sweep_map import sweep_figures, sweep_map_figure
from gear_damping.reporting.figures.test_plan import PlanCurves, PlanMap, PlanPicture, test_plan_figure
from gear_damping.reporting.figures.training import training_figure
from gear_damping.reporting.figures.visible import visible_figure
from gear_damping.reporting.style import save

__all__ = [
    "DampingBand",
    "DampingPanel",
    "Figure",
    "ForceMap",
    "ForceSurface",
    "Overlay",
    "PlanCurves",
    "PlanMap",
    "PlanPicture",
    "ResidualSpectrum",
    "ShownRun",
    "Turn",
    "candidates_figure",
    "casing_kurtosis_figure",
    "casing_orders_figure",
    "casing_turns_figure",
    "damping_figure",
    "forest_figure",
    "identification_figure",
    "mesh_stiffness_figure",
    "misfit_figure",
    "overlay_figure",
    "predicted_against_true_figure",
    "residual_force_map_figure",
    "residual_force_surface_figure",
    "residual_spectrum_figure",
    "response_figure",
    "save",
    "scalogram_figure",
    "simulation_figure",
    "sweep_figure",
    "sweep_figures",
    "sweep_map_figure",
    "test_plan_figure",
    "training_figure",
    "visible_figure",
]
