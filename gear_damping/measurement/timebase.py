"""From time stamps to a time base: uniform, put on a grid, or left at the stamps and said."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.record import Finding
from gear_damping.measurement.splines import cubic_spline
from gear_damping.measurement.stamps import REMEDY, irregularity, jitter_note, written_in

RATE_TOLERANCE = 0.01  # relative; rates within are one
GRID_TOLERANCE = 1e-6  # of a step; stamps this close to a grid are one
# Of a step: a cubic spline that moves samples this far errs by at most 0.07 % of content at 4 samples a period and
# 0.001 % of content at 10, because its slope errs by 4.5 and 0.1 %; beyond, samples are fitted at their stamps.
SPLINE_TOLERANCE = 0.01


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
        return values if self.stamps is None else cubic_spline(self.stamps, values)(self.time)


def steady_time(rate: float, first: int, n: int, start: float = 0.0) -> TimeBase:
    """The times of `n` samples at a rate in Hz from row `first` on, where row 0 lies at `start` in s."""
    return TimeBase(start + (first + np.arange(n)) / rate, rate)


def stamped_time(stamps: NDArray[np.float64], key: str, source: str, first: int = 0) -> TimeBase:
    """The time base that stamps give.

    Stamps on a grid stay; stamps within a hundredth of a step of one are moved there by a spline; stamps that were
    rounded to few digits are replaced by the grid that they round; stamps that jitter are kept, and their samples
    are fitted where they were taken (`uniform` is False, with a note), and so are those of a changing rate. Lost
    samples and a clock that jumps are data problems.

    Args:
        stamps: (n,) in s, n >= 2.
        key: What the stamps are called in messages.
        source: The file that they come from.
        first: The row of the first stamp, for messages.

    Raises:
        InputError: a stamp repeats the one before, or lies before it.
    """
    _refuse_repeated_or_backward(np.diff(stamps), key, source, first)
    rate = (stamps.size - 1) / float(stamps[-1] - stamps[0])
    grid = np.linspace(stamps[0], stamps[-1], stamps.size)
    away = float(np.max(np.abs(stamps - grid))) * rate
    if away <= GRID_TOLERANCE:
        return TimeBase(stamps, rate)
    if away <= SPLINE_TOLERANCE:
        spread = 100 * float(np.max(np.abs(np.diff(stamps) * rate - 1)))
        note = f"time steps vary by up to {spread:.2g} %: resampled to a uniform grid at {rate:.6g} Hz"
        return TimeBase(grid, rate, stamps=stamps, notes=(note,))
    written = written_in(stamps)
    if written is not None:
        note = f"time stamps are rounded to {written.digit:.3g} s: taken as an even {written.rate:.6g} Hz"
        return TimeBase(written.start + np.arange(stamps.size) / written.rate, written.rate, notes=(note,))
    found = irregularity(stamps)
    if found:
        usual = rate if found.severity == "note" else 1 / float(np.median(np.diff(stamps)))
        return TimeBase(stamps, usual, uniform=False, findings=(found,))
    return TimeBase(stamps, rate, uniform=False, findings=(jitter_note(stamps),))


def _refuse_repeated_or_backward(steps: NDArray, key: str, source: str, first: int) -> None:
    problems = []
    for kind, bad in (("repeated", steps == 0), ("backward", steps < 0)):
        where = np.flatnonzero(bad) + 1 + first
        if where.size:
            rule = f"{where.size} {kind} time stamp(s), the first at sample {where[0]}"
            problems.append(Problem(key, rule, remedy=f"leave those rows out, {REMEDY}", source=source))
    if problems:
        raise InputError(problems)


def moved_to(
    time: NDArray[np.float64], own: TimeBase, values: NDArray[np.float64], key: str, source: str
) -> NDArray[np.float64]:
    """Values on their own time base, at the record's `time`, by a cubic spline.

    Raises:
        InputError: the record lasts longer than the channel.
    """
    refuse_uncovered(time, own, key, source)
    return cubic_spline(own.time, own.resample(values))(time)


def refuse_uncovered(time: NDArray[np.float64], own: TimeBase, key: str, source: str) -> None:
    """Raise InputError where the record's `time` reaches more than one step beyond a channel's own."""
    step = 1 / own.sampling_rate
    if time[0] < own.time[0] - step or time[-1] > own.time[-1] + step:
        rule = f"covers {own.time[0]:.6g} to {own.time[-1]:.6g} s"
        rule += f", the record {time[0]:.6g} to {time[-1]:.6g} s"
        raise InputError(Problem(key, rule, remedy="shorten the record with slice", source=source))
