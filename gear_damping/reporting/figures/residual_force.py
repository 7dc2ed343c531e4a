"""The force that the simulation misses, over the teeth and over the state."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from gear_damping.reporting.figures.arrays import Array, any_finite, grid, series
from gear_damping.reporting.figures.axis_names import axis
from gear_damping.reporting.style import BLUE, DIVERGING, FAINT, PALE, mark_empty, new_figure, styled

ROBUST_PERCENTILE = 99.0  # of the sizes; a few outliers may saturate
NOT_VISITED = "#D9D9D9"


@dataclass(frozen=True, eq=False)
class ForceMap:
    """The residual force by pinion tooth and mesh phase.

    Args:
        mesh_phase: Centres of the bins in mesh periods, 0 … 1, ascending, shape (phase,), at least 2.
        force: Mean force that the simulation misses, shape (phase, tooth), tooth 1 first; NaN: not visited.
        unit: Unit of the force.
    """

    mesh_phase: ArrayLike
    force: ArrayLike
    unit: str = "N"


@dataclass(frozen=True, eq=False)
class ForceSurface:
    """The residual force over displacement and velocity.

    Args:
        displacement: Centres of the bins in `displacement_unit`, ascending, shape (displacement,), at least 2.
        velocity: Centres of the bins in `velocity_unit`, ascending, shape (velocity,), at least 2.
        force: Mean force that the simulation misses, shape (velocity, displacement); NaN: not visited.
        displacement_unit: Unit of the displacement.
        velocity_unit: Unit of the velocity.
        force_unit: Unit of the force.
        visits: How many samples each bin holds, the shape of `force`: weights of the means; None: equal.
    """

    displacement: ArrayLike
    velocity: ArrayLike
    force: ArrayLike
    displacement_unit: str = "µm"
    velocity_unit: str = "m/s"
    force_unit: str = "N"
    visits: ArrayLike | None = None


def residual_force_map_figure(shown: ForceMap) -> Figure:
    """The residual force by pinion tooth and mesh phase: a fault of one tooth is a column, of all teeth a row.

    Raises:
        ValueError: the shapes do not fit.
    """
    (phase,) = series(mesh_phase=shown.mesh_phase)
    teeth = np.arange(1.0, np.asarray(shown.force).shape[-1] + 1)
    force = grid(shown.force, phase, teeth, "force")
    with styled():
        figure = new_figure(3.9)
        axes = figure.subplots()
        axes.set(xlabel="pinion tooth", ylabel="mesh phase / mesh periods")
        if _picture(axes, teeth, phase, force, axis("residual force", shown.unit)):
            axes.set_xticks(teeth[:: max(1, len(teeth) // 20)])
            axes.set_title(_grey(force), fontsize=9)
        return figure


def residual_force_surface_figure(shown: ForceSurface) -> Figure:
    """The residual force over displacement and velocity, with its means along either.

    The mean over velocities shows a missing stiffness, the mean over displacements a missing damping force
    (restoring-force surface; Masri & Caughey 1979, J. Appl. Mech. 46(2)).

    Raises:
        ValueError: the shapes do not fit.
    """
    (x,), (v,) = series(displacement=shown.displacement), series(velocity=shown.velocity)
    force = grid(shown.force, v, x, "force")
    weights = np.ones_like(force) if shown.visits is None else grid(shown.visits, v, x, "visits")
    name = axis("residual force", shown.force_unit)
    x_name, v_name = axis("displacement", shown.displacement_unit), axis("velocity", shown.velocity_unit)
    with styled():
        figure = new_figure(5.6)
        layout = figure.add_gridspec(2, 2, width_ratios=(2.6, 1), height_ratios=(1, 2.2))
        surface = figure.add_subplot(layout[1, 0])
        over_x = figure.add_subplot(layout[0, 0], sharex=surface)
        over_v = figure.add_subplot(layout[1, 1], sharey=surface)
        surface.set(xlabel=x_name, ylabel=v_name)
        over_x.set_ylabel(f"mean\n{name}")
        over_v.set_xlabel(f"mean {name}")
        if _picture(surface, x, v, force, name, below=(surface, over_v)):
            _profile(over_x, x, _mean(force, weights, axis=0), upright=False)
            _profile(over_v, v, _mean(force, weights, axis=1), upright=True)
            over_x.set_title("over all velocities: a missing stiffness slopes", fontsize=9)
            over_v.set_title("over all displacements:\nmissing damping slopes", fontsize=9)
        over_x.tick_params(labelbottom=False)
        over_v.tick_params(labelleft=False)
        return figure


def _picture(axes: Axes, across: Array, up: Array, force: Array, name: str, below: Sequence[Axes] = ()) -> bool:
    """Draw the bins with symmetric colours; False where there is nothing to draw."""
    axes.grid(visible=False)
    if not any_finite(force) or min(force.shape) < 2:
        mark_empty(axes, "the residual force was not estimated")
        return False
    axes.set_facecolor(NOT_VISITED)
    size = float(np.nanpercentile(np.abs(force), ROBUST_PERCENTILE)) or 1e-12
    image = axes.pcolormesh(
        across, up, force, cmap=DIVERGING, vmin=-size, vmax=size, shading="nearest", rasterized=True
    )
    place = (
        {"ax": list(below), "location": "bottom", "aspect": 50, "pad": 0.03} if below else {"ax": axes, "pad": 0.015}
    )
    axes.figure.colorbar(image, label=name, extend="both", **place)
    return True


def _profile(axes: Axes, place: Array, mean: Array, *, upright: bool) -> None:
    axes.plot(*((mean, place) if upright else (place, mean)), color=BLUE, marker=".", markersize=4)
    (axes.axvline if upright else axes.axhline)(0, color=PALE, linewidth=0.8)
    axes.grid(color=FAINT)


def _mean(force: Array, weights: Array, axis: int) -> Array:
    """Weighted mean over the visited bins, NaN where there are none."""
    weights = np.where(np.isfinite(force), np.nan_to_num(weights), 0.0)
    total = weights.sum(axis=axis)
    summed = (np.nan_to_num(force) * weights).sum(axis=axis)
    return np.divide(summed, total, out=np.full(total.shape, np.nan), where=total > 0)


def _grey(force: Array) -> str:
    return "" if np.isfinite(force).all() else "grey: not visited"
