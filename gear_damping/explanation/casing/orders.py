"""Orders: the spectrum against angle, its lines at shafts, mesh and sidebands, and lines that belong to none."""

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.ndimage import median_filter, uniform_filter1d

from gear_damping.explanation.casing.cycles import Patterns
from gear_damping.explanation.casing.heard import TURN, Heard
from gear_damping.signals.spectra import order_spectrum

Array = NDArray[np.float64]
MESH_HARMONICS = 6  # of the mesh that are looked at: higher ones are weak in a casing
SHAFT_HARMONICS = 3  # sidebands on either side of each
FLOOR = 50  # lines on either side that give the floor of a line
NEIGHBOURS = 2.0  # orders over which the skirt of a synchronous line reaches

TEETH = range(8, 201)  # of a pinion: fewer do not mesh, and more are not cut on one that a casing hears
COMB, STRONGER = 3, 10.0  # harmonics; times any line of the declared mesh, assumed: a burst makes all orders alike
LOWEST = 1.0  # order: below, load and speed drift
HIGHEST = 0.8  # of half the sampling rate: above, a filter against aliasing leaves no even floor


@dataclass(frozen=True)
class Line:
    """A line of the order spectrum.

    Args:
        what: In words, for example `mesh 2` or `mesh 1 + gear`.
        order: Cycles per turn of the pinion.
        amplitude: Peak amplitude in the unit of the acceleration.
        floor: Median amplitude around it.
    """

    what: str
    order: float
    amplitude: float
    floor: float


@dataclass(frozen=True)
class Asynchronous:
    """The strongest line at no order of a shaft.

    Args:
        order: Cycles per turn of the pinion.
        ratio: Its power over the floor around it.
        p: Probability of that ratio or more in noise, over all lines that were looked at.
        lines: How many those were.
    """

    order: float
    ratio: float
    p: float
    lines: int


def spectrum(heard: Heard) -> tuple[Array, Array]:
    """Orders of the pinion and peak amplitudes, over whole turns."""
    values = torch.as_tensor(heard.values, dtype=torch.float64)[None]
    orders, amplitude = order_spectrum(values, torch.as_tensor(heard.turn * TURN))
    return orders.numpy(), amplitude[0].numpy()


def lines(heard: Heard, orders: Array, amplitude: Array) -> list[Line]:
    """Amplitudes at the shafts' orders, the mesh harmonics and their first sidebands."""
    gear, mesh = heard.orders["gear"], heard.orders["mesh"]
    named = [(f"{name} {h}", h * order) for name, order in (("gear", gear), ("pinion", 1.0)) for h in _harmonics()]
    for h in range(1, MESH_HARMONICS + 1):
        named.append((f"mesh {h}", h * mesh))
        for name, order in (("pinion", 1.0), ("gear", gear)):
            named += [(f"mesh {h} - {name}", h * mesh - order), (f"mesh {h} + {name}", h * mesh + order)]
    step = orders[1]
    found = []
    for what, order in named:
        at = round(order / step)
        if order <= orders[-1] and at >= 2:
            found.append(Line(what, order, *_height_and_floor(amplitude, at)))
    return found


def _height_and_floor(amplitude: Array, at: int) -> tuple[float, float]:
    around = amplitude[max(at - FLOOR, 1) : at + FLOOR]
    return float(amplitude[at - 1 : at + 2].max()), float(np.median(around))


def mesh_elsewhere(heard: Heard, orders: Array, amplitude: Array) -> int | None:
    """The number of teeth whose mesh the spectrum shows, where it shows none of the declared one; else None.

    All its lines stand out from what is beside them, and by far more than any of the declared mesh: a burst once a turn
    has lines at every order.
    """

    def least_and_most(teeth: float) -> tuple[float, float]:
        places = [round(h * teeth / orders[1]) for h in range(1, COMB + 1)]
        if places[-1] + FLOOR >= len(amplitude):
            return 0.0, 0.0
        lines = (_height_and_floor(amplitude, at) for at in places)
        over = [height / max(floor, 1e-300) for height, floor in lines]
        return min(over), max(over)

    declared = least_and_most(heard.orders["mesh"])[1]
    others = (teeth for teeth in TEETH if declared and round(teeth / orders[1]) > FLOOR)
    return next((teeth for teeth in others if least_and_most(teeth)[0] > STRONGER * declared), None)


def _harmonics() -> range:
    return range(1, SHAFT_HARMONICS + 1)


def asynchronous(found: Patterns) -> Asynchronous | None:
    """The line that stands out most in what is not synchronous; None where none stands out or shafts leave no room.

    A synchronous line has a skirt, because path and load make it vary with the speed. A line counts therefore only
    where it is stronger than the synchronous ones beside it together.
    """
    window = np.hanning(found.asynchronous.size)
    power, whole = (np.abs(np.fft.rfft(values.ravel() * window)) ** 2 for values in (found.asynchronous, found.cut))
    order = np.arange(len(power)) * found.teeth[0] / found.cycles
    free = _free(found, order)
    if free.sum() < 2 * FLOOR:
        return None
    size = 2 * int(NEIGHBOURS / order[1]) + 1
    neighbours = size * uniform_filter1d(np.where(free, 0, whole), size, mode="constant")
    floor = median_filter(power[free], 2 * FLOOR + 1, mode="nearest") / np.log(2)  # of an exponential distribution
    ratio = np.where(power[free] > neighbours[free], power[free] / floor, 0)
    count, at = len(ratio), int(ratio.argmax())
    if not ratio[at] > 0:
        return None
    p = -np.expm1(count * np.log1p(-np.exp(-ratio[at])))
    return Asynchronous(float(order[free][at]), float(ratio[at]), float(p), count)


def _free(found: Patterns, order: Array) -> NDArray[np.bool_]:
    """Lines away from the orders of both shafts."""
    z1, z2 = found.teeth
    width = 2.5 * z1 / found.cycles  # of a line under the window, in orders
    free = (order > LOWEST) & (order < HIGHEST * order[-1])
    for spacing in (1.0, z1 / z2):
        free &= np.abs(order / spacing - np.round(order / spacing)) * spacing > width
    return free
