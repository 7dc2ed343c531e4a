"""An angle that was recorded in steps, as the counts of a coarse encoder: what turned lies between them."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from gear_damping.measurement.resolution import step_of

Array = NDArray[np.float64]
ORDER = 3  # of the polynomial in a window: speed and its change are followed
SHORTEST = 5  # samples of a window: the odd number above those that fix a cubic
WIDEST = 0.5  # of the record, so that a window still leaves some of it beside
FEW = 8  # advances from sample to sample that a shaft of nearly constant speed takes between steps
SAME = 1e-8  # rad between advances that are one: far below any encoder's step, far above the rounding of numbers
ROUNDING = 1.03  # times what rounding leaves, step / sqrt(12): from there on a window blurs how the shaft turns


def between_steps(angle: Array) -> Array:
    """The angle (time,) smoothed as far as the rounding of its steps alone is taken out; as it is without steps.

    The window of the local cubic (Savitzky & Golay 1964, Analytical Chemistry 36) is the longest that leaves no more
    than rounding does.
    """
    step, found = _step(angle), angle
    window = SHORTEST
    while step > 0 and window <= WIDEST * len(angle):
        smooth = savgol_filter(angle, window, ORDER)
        if float(np.std(angle - smooth)) <= ROUNDING * step / 12**0.5:
            found = smooth  # a short window may turn round what beats with the samples, a longer one does not
        window = 2 * window - 1
    return found


def _step(angle: Array) -> float:
    """The step of an angle; 0 where it has none."""
    every = np.sort(np.diff(angle))
    gaps = np.diff(every[np.concatenate([[True], np.diff(every) > SAME])])
    if 0 < len(gaps) < FEW:  # of a shaft that turns fast most levels are left out, but not of its advance
        shares = gaps / gaps.min()
        return float(gaps.min()) if np.allclose(shares, np.round(shares), atol=1e-3) else 0.0
    return step_of(angle)
