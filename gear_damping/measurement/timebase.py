"""From time stamps to a time base: uniform, put on a grid, or left at the stamps and said."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.record import Finding

RATE_TOLERANCE = 0.01  # of the median step; every step of a constant rate lies within
GRID_TOLERANCE = 1e-6  # of a step; stamps this close to a grid are one
_GAP_TOLERANCE = 0.05  # of a step; how near a whole number of steps a gap must be
_REMEDY = "or give sampling_rate instead of the time column, where the stamps are written with too few digits"


@dataclass(frozen=True, eq=False)
class TimeBase:
    """The samples' times: (n,) s, their rate in Hz, and the stamps that they replace, if any."""

    time: NDArray[np.float64]
    sampling_rate: float
    uniform: bool = True
    stamps: NDArray[np.float64] | None = None
    notes: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()

    def resample(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values at `stamps` moved to `time` by a cubic spline; untouched where nothing was moved."""
        return values if self.stamps is None else CubicSpline(self.stamps, values)(self.time)


def steady_time(rate: float, first: int, n: int, start: float = 0.0) -> TimeBase:
    """The times of `n` samples at a rate in Hz from row `first` on, where row 0 lies at `start` in s."""
    return TimeBase(start + (first + np.arange(n)) / rate, rate)


def stamped_time(stamps: NDArray[np.float64], key: str, source: str, first: int = 0) -> TimeBase:
    """The time base that stamps give.

    Args:
        stamps: (n,) in s, n >= 2.
        key: What the stamps are called in messages.
        source: The file that they come from.
        first: The row of the first stamp, for messages.

    Raises:
        InputError: a stamp repeats the one before, or lies before it.
    """
    steps = np.diff(stamps)
    _refuse_repeated_or_backward(steps, key, source, first)
    median = float(np.median(steps))
    irregular = np.flatnonzero(np.abs(steps / median - 1) > RATE_TOLERANCE)
    if irregular.size:
        return TimeBase(stamps, 1 / median, uniform=False, findings=(_irregular(steps, median, irregular),))
    grid = np.linspace(stamps[0], stamps[-1], stamps.size)
    rate = (stamps.size - 1) / float(stamps[-1] - stamps[0])
    if np.max(np.abs(stamps - grid)) <= GRID_TOLERANCE * median:
        return TimeBase(stamps, rate)
    spread = float(np.max(np.abs(steps / median - 1)))
    note = f"time steps vary by up to {100 * spread:.2g} %: resampled to a uniform grid at {rate:.6g} Hz"
    return TimeBase(grid, rate, stamps=stamps, notes=(note,))


def _refuse_repeated_or_backward(steps: NDArray, key: str, source: str, first: int) -> None:
    problems = []
    for kind, bad in (("repeated", steps == 0), ("backward", steps < 0)):
        where = np.flatnonzero(bad) + 1 + first
        if where.size:
            rule = f"{where.size} {kind} time stamp(s), the first at sample {where[0]}"
            problems.append(Problem(key, rule, remedy=f"leave those rows out, {_REMEDY}", source=source))
    if problems:
        raise InputError(problems)


def _irregular(steps: NDArray, median: float, irregular: NDArray) -> Finding:
    """Gaps of whole steps are dropped samples; anything else is an uneven rate."""
    ratio = steps[irregular] / median
    where = int(irregular[0]) + 1
    if np.all((ratio > 1.5) & (np.abs(ratio - np.round(ratio)) <= _GAP_TOLERANCE * np.round(ratio))):
        lost = int(np.sum(np.round(ratio) - 1))
        message = (
            f"about {lost} sample(s) were dropped in {irregular.size} gap(s), "
            f"the first before sample {where}; use slices between the gaps"
        )
        return Finding("dropped_samples", message, channel="time", sample=where)
    share = 100 * irregular.size / steps.size
    message = (
        f"{share:.2g} % of the time steps differ by more than 1 % from the median {median:.4g} s "
        f"(from {steps.min():.4g} to {steps.max():.4g} s), the first before sample {where}; "
        f"record at one rate, {_REMEDY}"
    )
    return Finding("uneven_stamps", message, channel="time", sample=where)


def moved_to(
    time: NDArray[np.float64], own: TimeBase, values: NDArray[np.float64], key: str, source: str
) -> NDArray[np.float64]:
    """Values on their own time base, at the record's `time`, by a cubic spline.

    Raises:
        InputError: the record lasts longer than the channel.
    """
    refuse_uncovered(time, own, key, source)
    return CubicSpline(own.time, own.resample(values))(time)


def refuse_uncovered(time: NDArray[np.float64], own: TimeBase, key: str, source: str) -> None:
    """Raise InputError where the record's `time` reaches more than one step beyond a channel's own."""
    step = 1 / own.sampling_rate
    if time[0] < own.time[0] - step or time[-1] > own.time[-1] + step:
        rule = f"covers {own.time[0]:.6g} to {own.time[-1]:.6g} s"
        rule += f", the record {time[0]:.6g} to {time[-1]:.6g} s"
        raise InputError(Problem(key, rule, remedy="shorten the record with slice", source=source))
