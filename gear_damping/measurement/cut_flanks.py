"""Whether a fast signal was cut: its last three samples before a plateau lead beyond it, however they were rounded.

Where a motion has few samples a period, those that a long parabola is laid through reach over a whole swing. At a
smooth extremum of few steps the three nearest samples turn within the plateau.
"""

from itertools import product

import numpy as np
from numpy.typing import NDArray

LEAST_PLATEAU = 3  # samples of one level: a smooth extremum of a fast signal has two
_FLANK = 3  # samples that say place, speed and acceleration next to a plateau
_ROUNDED = 0.5  # of a step, which each of them may be off either way
_BEYOND = 1.5  # steps that they lead farther than the plateau lies, as a long parabola must


def is_cut(outward: NDArray[np.float64], first: int, last: int, step: float) -> bool:
    """Whether both flanks of a plateau lead beyond it; at the end of a record the flank that there is decides.

    Args:
        outward: (n,) values, the larger the farther out.
        first: Sample at which the plateau begins.
        last: Its last sample.
        step: Of the values, that they are rounded to.
    """
    length, top = last + 1 - first, float(outward[first])
    sides = outward[max(0, first - _FLANK) : first], outward[last + 1 : last + 1 + _FLANK][::-1]
    whole = [side for side in sides if side.size == _FLANK]
    if length < LEAST_PLATEAU or not whole:
        return False
    return all(_leads_beyond(side, top, length, step) for side in whole)


def _leads_beyond(flank: NDArray[np.float64], top: float, length: int, step: float) -> bool:
    """Whether three samples that rise to `top` go on beyond it within half the plateau, at the least by rounding."""
    if not np.all(np.diff(np.r_[flank, top]) > 0):
        return False
    off = _ROUNDED * step * np.array(list(product((-1, 1), repeat=_FLANK)))
    third, second, nearest = (flank + off).T
    slowing = 2 * second - nearest - third
    speed = (3 * nearest - 4 * second + third) / 2
    turn = np.where(slowing > 0, speed / np.where(slowing > 0, slowing, 1.0), np.inf)
    ahead = np.minimum(turn, (length + 1) / 2)
    reached = nearest + speed * ahead - slowing * ahead**2 / 2
    return bool(np.all(speed > 0) and reached.min() > top + _BEYOND * step)
