"""Whether an input was put out in steps, as by a controller: it stays at each value until the next sample."""

import numpy as np
from numpy.typing import NDArray

LEVELS = 2  # a series that knows no more of them switches
LEAST_RUN = 2  # samples for which it stands still, in the median
FEW_LEVELS, LONG_RUN = 8, 10  # three bits, which no converter has so few of; samples for which such a command stands
SKIP, SHORT_RUN = 2, 5  # levels in the median change, and samples before it: what is read goes no ten times as fast
_JUMPS, _SELDOM, _RESTS = 0.1, 0.02, 0.2  # of the range; of the samples; of the range, that is left without the jumps
JUMP = 3.0  # least steps of the values in the median change: a coarse converter follows what it reads by single ones


def is_staircase(values: NDArray[np.float64]) -> bool:
    """Whether a series (time,) switches between few levels, or stands still and then jumps.

    A constant one is none: nothing of it lies between samples.
    """
    levels = np.unique(values)
    if len(levels) <= LEVELS:
        return len(levels) == LEVELS
    usual = _usual_run(values)  # a force that rests for long between strokes is no staircase: most steps are short
    if len(levels) <= FEW_LEVELS and usual >= LONG_RUN:
        return True
    places = np.abs(np.diff(np.searchsorted(levels, values)))
    if usual >= SHORT_RUN and np.median(places[places > 0]) >= SKIP:
        return True
    return leaps_from_rests(values)


def leaps_from_rests(values: NDArray[np.float64]) -> bool:
    """Whether a series (time,) stands still for two samples or more, mostly, and then leaps by several steps."""
    moved = np.abs(np.diff(values))
    moved, levels = moved[moved > 0], np.unique(values)
    if len(levels) <= LEVELS:
        return False
    return bool(_usual_run(values) >= LEAST_RUN and np.median(moved) >= JUMP * np.diff(levels).min())


def _usual_run(values: NDArray[np.float64]) -> float:
    """Median count of samples for which a series stays at a value."""
    return float(np.median(runs_of(values)))


def runs_of(values: NDArray[np.float64]) -> NDArray[np.intp]:
    """Counts of samples for which a series (time,) stays at a value, in order."""
    return np.diff(np.flatnonzero(np.concatenate([[True], np.diff(values) != 0, [True]])))


def rests_between_jumps(values: NDArray[np.float64]) -> bool:
    """Whether a series (time,) changes in a few jumps and hardly between them, as a pulse or a step that is put in."""
    steps, span = np.diff(values), np.ptp(values)
    is_jump = np.abs(steps) > _JUMPS * span
    if not 0 < is_jump.sum() <= max(LEVELS, _SELDOM * steps.size):
        return False
    between = np.cumsum(np.where(is_jump, 0.0, steps))
    return bool(np.ptp(between) < _RESTS * span)
