"""Splines, whose library is imported where the first one is made: most records need none, and it takes long."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Curve = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def cubic_spline(place: NDArray[np.float64], values: NDArray[np.float64]) -> Curve:
    """The cubic spline through (n,) `values` at increasing places."""
    from scipy.interpolate import CubicSpline

    return CubicSpline(place, values)


def monotone_spline(place: NDArray[np.float64], values: NDArray[np.float64]) -> Curve:
    """The cubic Hermite interpolant that is monotone where (n,) `values` are."""
    from scipy.interpolate import PchipInterpolator

    return PchipInterpolator(place, values)
