"""The quantisation step of a channel: what a converter, an encoder or few written digits leave of a signal."""

import numpy as np
from numpy.typing import NDArray

_ROUNDING = 16 * 2.0**-52  # of the largest magnitude; values closer than this are one
_SINGLE = 4 * 2.0**-23  # the same of values that single precision holds exactly
_FINEST = 2.0**-33  # of the range: converters have 32 bits at most, and closer values are rounding
_DIVISORS = (1, 2, 3, 4)  # of a difference that may be more than one step
_QUANTILES = (0.5, 0.05, 0.0)  # of the differences that are tried as a step
_OFF = 0.1  # of a step; how far a value may be from its level (few digits round the levels themselves)
_SHARE = 0.9  # of the samples that stand at a level (some loggers write more digits near zero)
_REPEATS = 0.5  # of the samples: with noise as large as half a step fewer of them repeat the one before
_WIDENING = 4.0  # factor by which the differences grow that refine a step


def step_of(values: NDArray[np.float64]) -> float:
    """The step that values are multiples of, about any offset; its rounding leaves a noise of step / sqrt(12).

    An offset, a conversion of units and levels that were themselves rounded to fewer digits do not matter.

    Args:
        values: (n,) samples in any unit.

    Returns:
        The step in the values' unit; 0.0 for a constant, and where no step can be told from a fine grid, which is
        so where the values leave almost all levels unused, or were interpolated.
    """
    gaps = _gaps(values)
    if gaps.size < 2:
        return float(gaps.sum())  # a constant, or two levels
    tried = {float(np.quantile(gaps, q, method="lower")) / k for q in _QUANTILES for k in _DIVISORS}
    found = (_refined(guess, gaps) for guess in sorted(tried, reverse=True))
    return next((step for step in found if step > 0 and _stand_at_levels(values, step)), 0.0)


def rounding_of(values: NDArray[np.float64]) -> float:
    """Standard deviation of what rounding leaves of values at a lower rate: (n,) values stand still between steps.

    A mean over samples that repeat one another is as rounded as each. Where noise spreads them over several steps, the
    rounding is noise as well, and a mean has less of it: 0.0.
    """
    if values.size < 2 or np.mean(np.diff(values) == 0) < _REPEATS:
        return 0.0
    return step_of(values) / 12**0.5


def _gaps(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Differences between neighbouring distinct levels, ascending; levels that differ by rounding alone are one."""
    levels = np.unique(values)
    rounding = _SINGLE if np.array_equal(levels, levels.astype(np.float32)) else _ROUNDING
    finest = max(rounding * float(np.max(np.abs(levels), initial=0.0)), _FINEST * float(np.ptp(levels)))
    apart = np.diff(levels) > finest
    firsts, lasts = levels[np.r_[True, apart]], levels[np.r_[apart, True]]
    return np.sort(np.diff((firsts + lasts) / 2))


def _refined(guess: float, gaps: NDArray[np.float64]) -> float:
    """The step near a guess, learnt from ever wider gaps that are near a multiple of it; 0.0 where none is."""
    step, reach = guess, 1.5 * guess
    while True:
        multiples = np.round(gaps / step)
        near = (multiples >= 1) & (gaps <= reach) & (np.abs(gaps / step - multiples) <= 2 * _OFF)
        if not near.any():
            return 0.0
        step = float(gaps[near].sum() / multiples[near].sum())
        if reach >= gaps[-1]:
            return step
        reach *= _WIDENING


def _stand_at_levels(values: NDArray[np.float64], step: float) -> bool:
    """Whether values less a common offset are multiples of a step."""
    cycles = (values - values[0]) / step
    offset = np.angle(np.mean(np.exp(2j * np.pi * cycles))) / (2 * np.pi)
    off = (cycles - offset + 0.5) % 1.0 - 0.5
    return bool(np.mean(np.abs(off) <= _OFF) >= _SHARE)
