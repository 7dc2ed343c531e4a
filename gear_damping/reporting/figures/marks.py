"""Lines at the frequencies and orders that gears make: shafts, mesh harmonics, natural frequency."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from gear_damping.reporting.style import GREEN, INK, ORANGE, PURPLE

MOST_MESH_HARMONICS = 40  # beyond which marks are a grey band
MESH = {"color": ORANGE, "linewidth": 0.9, "linestyle": (0, (4, 2))}
PINION = {"color": GREEN, "linewidth": 1.1, "linestyle": "-."}
GEAR = {"color": PURPLE, "linewidth": 1.1, "linestyle": ":"}


def mark_orders(
    axes: Axes,
    highest: float,
    *,
    pinion_order: float | None = None,
    gear_order: float | None = None,
    mesh_order: float | None = None,
) -> None:
    """Vertical lines at the shafts' orders and at the harmonics of the mesh up to `highest`, with labels."""
    _line(axes, pinion_order, highest, "pinion shaft", PINION)
    _line(axes, gear_order, highest, "gear shaft", GEAR)
    for harmonic, order in enumerate(harmonics(mesh_order, highest), start=1):
        axes.axvline(order, label="mesh harmonics" if harmonic == 1 else None, zorder=0.9, **MESH)


def harmonics(first: float | None, highest: float) -> list[float]:
    """The multiples of `first` up to `highest`."""
    if not first or not np.isfinite(highest):
        return []
    return [h * first for h in range(1, min(int(highest / first + 1e-9), MOST_MESH_HARMONICS) + 1)]


def _line(axes: Axes, place: float | None, highest: float, label: str, look: Mapping[str, object]) -> None:
    if place is not None and 0 < place <= highest:
        axes.axvline(place, label=label, zorder=0.9, **look)


def name_on_right(axes: Axes, marks: Mapping[str, float], gap: float = 0.055) -> None:
    """Names beside the right edge at the heights of `marks` (data of a logarithmic axis), none on another.

    Args:
        axes: Their limits must be set.
        marks: Name -> value on the vertical axis; values outside of the limits are left out.
        gap: Least distance of two names, as a share of the height.
    """
    low, high = np.log(axes.get_ylim())
    heights = {n: (np.log(v) - low) / (high - low) for n, v in marks.items() if low <= np.log(v) <= high}
    ordered = sorted(heights, key=heights.__getitem__)
    for name, place in zip(ordered, spaced([heights[n] for n in ordered], gap), strict=True):
        axes.annotate(
            name,
            xy=(1.0, heights[name]),
            xytext=(1.03, place),
            xycoords="axes fraction",
            fontsize=9,
            color=INK,
            va="center",
            arrowprops={"arrowstyle": "-", "color": INK, "linewidth": 0.6, "shrinkA": 0, "shrinkB": 0},
            annotation_clip=False,
        )


def spaced(places: Sequence[float], gap: float) -> list[float]:
    """Ascending places moved apart to at least `gap`, those above pushed up and then all kept below 1."""
    moved = list(places)
    for i in range(1, len(moved)):
        moved[i] = max(moved[i], moved[i - 1] + gap)
    for i in reversed(range(len(moved))):
        highest = 1.0 if i == len(moved) - 1 else moved[i + 1] - gap
        moved[i] = min(moved[i], highest)
    return moved
