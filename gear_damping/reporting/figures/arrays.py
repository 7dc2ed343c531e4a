"""What every figure does with the arrays that it is given."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
PREFIXED = ("m", "rad")  # units whose values are mostly small fractions of one
PREFIXES = ((1e6, "µ"), (1e3, "m"))  # factors with their signs, the smallest unit first
MOST = 1e3  # the largest number that an axis shows in a prefixed unit


def series(**named: ArrayLike) -> tuple[Array, ...]:
    """One-dimensional arrays of one length in f64; what is not finite becomes NaN, which lines leave out.

    Raises:
        ValueError: an argument has another shape than the first.
    """
    found = {name: np.asarray(values, dtype=float) for name, values in named.items()}
    first, length = next((name, values.shape) for name, values in found.items())
    for name, values in found.items():
        if values.ndim != 1 or values.shape != length:
            rule = f"{name} must be one-dimensional and as long as {first}"
            raise ValueError(f"{rule} {length}, got {values.shape}: cut both to the same samples")
    return tuple(np.where(np.isfinite(values), values, np.nan) for values in found.values())


def grid(values: ArrayLike, rows: Array, columns: Array, name: str) -> Array:
    """A two-dimensional array of (rows, columns) in f64, NaN where it is not finite.

    Raises:
        ValueError: it has another shape.
    """
    found = np.asarray(values, dtype=float)
    if found.shape != (len(rows), len(columns)):
        rule = f"{name} must have shape ({len(rows)}, {len(columns)}), got {found.shape}"
        raise ValueError(f"{rule}: transpose or cut it")
    return np.where(np.isfinite(found), found, np.nan)


def extent(values: Iterable[Any], margin: float = 0.0) -> tuple[float, float] | None:
    """Lowest and highest finite value with a margin (share of the span); None where there are not two."""
    flat = np.concatenate([np.ravel(np.asarray(part, dtype=float)) for part in values] or [np.empty(0)])
    flat = flat[np.isfinite(flat)]
    if not len(flat) or flat.min() == flat.max():
        return None
    low, high = float(flat.min()), float(flat.max())
    return low - margin * (high - low), high + margin * (high - low)


def any_finite(*arrays: ArrayLike) -> bool:
    """Whether there is anything to draw."""
    return any(np.isfinite(np.asarray(values, dtype=float)).any() for values in arrays)


def in_prefixed(unit: str, *given: Array) -> tuple[float, str]:
    """Factor and unit in which the largest of values in m or rad is no small fraction; 1 and the unit of all others."""
    largest = max((float(np.nanmax(np.abs(one))) for one in given if any_finite(one)), default=0.0)
    if unit not in PREFIXED or not largest:
        return 1.0, unit
    return next(((factor, f"{sign}{unit}") for factor, sign in PREFIXES if largest * factor < MOST), (1.0, unit))


def time_axis(time: Array) -> tuple[Array, str]:
    """Times in the unit that suits their span, and the label of their axis."""
    span = extent([time])
    if span is not None and span[1] - span[0] < 2.0:
        return time * 1e3, "time / ms"
    return time, "time / s"
