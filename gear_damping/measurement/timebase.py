"""From time stamps to a time base: uniform, put on a grid, or left at the stamps and said.

What uneven stamps are is told by `irregular_stamps`: rounded, jittering as a recorder's do, or a fault. Whether the
values were taken at their stamps is asked of them too (`record_checks`).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.irregular_stamps import (
    EXACT,
    HALF,
    LOST,
    REMEDY,
    SAME_RATE,
    irregularity,
    jitter_note,
    last_digit,
)
from gear_damping.measurement.record import Finding
from gear_damping.measurement.recordings import is_too_late, past_overflow, refuse_recordings

Curve = Callable[[NDArray[np.float64]], NDArray[np.float64]]
RATE_TOLERANCE = 0.01  # relative; rates within are one
GRID_TOLERANCE = 1e-6  # of a step; stamps this close to a grid are one
# Of a step: a cubic spline that moves samples this far errs by at most 0.07 % of content at 4 samples a period and
# 0.001 % of content at 10, because its slope errs by 4.5 and 0.1 %; beyond, samples are fitted at their stamps.
SPLINE_TOLERANCE = 0.01
MOST_STRAY = 0.1  # of the steps go back in a clock that stumbles; beyond, rows stand in another order
_WRITTEN = 1.2  # last digits over which rounded stamps may spread about their grid
_SIGNIFICANT = range(2, 6)  # digits of stamps that may come out alike; with more, rows are stored twice
_CLOSELY = 1e-12  # of a step: to which it is sought that the first of ten thousand stamps allow
_LEAST_LEAPS = 8  # changes of stamps that many samples share: fewer tell no rate
_OFF = 2  # changes of so many stamps, that a straight line through their ends may be off by over the record
_HALVINGS = 60  # of an interval: as many as a number has binary digits
_ROUND_DIGITS = 4  # of a rate that somebody sets: 1024 and 51.2, and hardly more
_BY_CHANCE = 0.1  # of the way between rates of so many digits: a longer interval of rates holds one too often
_HOLES = 2  # in stamps of few digits that are lost samples, where more of them, regular, are rounding


def cubic_spline(place: NDArray[np.float64], values: NDArray[np.float64]) -> Curve:
    """The cubic spline through (n,) `values` at increasing places."""
    from scipy.interpolate import CubicSpline

    return CubicSpline(place, values)


def monotone_spline(place: NDArray[np.float64], values: NDArray[np.float64]) -> Curve:
    """The cubic Hermite interpolant that is monotone where (n,) `values` are."""
    from scipy.interpolate import PchipInterpolator

    return PchipInterpolator(place, values)


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

    Stamps on a grid stay; stamps that were rounded are replaced by the grid that they round; others within a hundredth
    of a step of one are moved there by a spline; stamps that jitter are kept, and their samples are fitted where they
    were taken (`uniform` is False, with a note), and so are those of a changing rate. Lost samples and a clock that
    jumps are data problems.

    Args:
        stamps: (n,) in s, n >= 2.
        key: What the stamps are called in messages.
        source: The file that they come from.
        first: The row of the first stamp, for messages.

    Raises:
        InputError: a stamp repeats the one before, or lies before it, or the clock starts again.
    """
    stamps = past_overflow(stamps)
    refuse_recordings(stamps, key, source, first)
    if np.any(np.diff(stamps) == 0) and (few := written_significantly(stamps)) is not None:
        return few
    shared = shared_grid(stamps)
    if shared is not None and shared.rate is not None:
        return shared.base(stamps.size)
    _refuse_repeated_or_backward(np.diff(stamps), key, source, first, shared)
    rate = (stamps.size - 1) / float(stamps[-1] - stamps[0])
    grid = np.linspace(stamps[0], stamps[-1], stamps.size)
    away = float(np.max(np.abs(stamps - grid))) * rate
    if away <= GRID_TOLERANCE:
        return TimeBase(stamps, rate)
    written = None if _is_grid_with_holes(stamps) else written_in(stamps)
    if away <= SPLINE_TOLERANCE and written is None:
        variation = 100 * float(np.max(np.abs(np.diff(stamps) * rate - 1)))
        note = f"time steps vary by up to {variation:.2g} %: resampled to a uniform grid at {rate:.6g} Hz"
        return TimeBase(grid, rate, stamps=stamps, notes=(note,))
    if written is not None:
        note = f"time stamps are rounded to {written.digit:.3g} s: taken as an even {written.rate:.6g} Hz"
        return TimeBase(written.start + np.arange(stamps.size) / written.rate, written.rate, notes=(note,))
    if (few := written_significantly(stamps)) is not None:
        return few
    found = irregularity(stamps, first)
    if found and found.kind == LOST:
        return _with_losses(stamps, found)
    if found:
        usual = rate if found.severity == "note" else 1 / float(np.median(np.diff(stamps)))
        return TimeBase(stamps, usual, uniform=False, findings=(found,))
    return TimeBase(stamps, rate, uniform=False, findings=(jitter_note(stamps),))


def counted(stamps: NDArray[np.float64]) -> NDArray[np.float64]:
    """How many steps of the clock every stamp lies behind the first, (n,)."""
    steps = np.diff(stamps)
    step = float(np.mean(steps[steps < (1 + HALF) * np.median(steps)]))
    return np.r_[0.0, np.cumsum(np.round(steps / step))]


def _is_grid_with_holes(stamps: NDArray[np.float64]) -> bool:
    """Whether stamps lie on a grid of which one or two are not there.

    Rounding to a digit of almost the length of a step leaves holes too, but regular ones, and seldom so few.
    """
    index = counted(stamps)
    if not 0 < index[-1] + 1 - stamps.size <= _HOLES:
        return False
    step, start = np.polyfit(index, stamps - stamps[0], 1)
    return float(np.max(np.abs(stamps - stamps[0] - start - step * index))) <= SPLINE_TOLERANCE * step


def _with_losses(stamps: NDArray[np.float64], found: Finding) -> TimeBase:
    """The stamps where samples were lost, freed of their rounding, at the rate of the steps that they count."""
    index = counted(stamps)
    written = written_in(stamps, index)
    if written is None:
        return TimeBase(stamps, index[-1] / float(stamps[-1] - stamps[0]), uniform=False, findings=(found,))
    note = f"time stamps are rounded to {written.digit:.3g} s: taken as steps of an even {written.rate:.6g} Hz"
    time = written.start + index / written.rate
    return TimeBase(time, written.rate, uniform=False, notes=(note,), findings=(found,))


def _refuse_repeated_or_backward(
    steps: NDArray, key: str, source: str, first: int, shared: "Shared | None" = None
) -> None:
    problems = []
    for kind, bad in (("repeated", steps == 0), ("backward", steps < 0)):
        where = np.flatnonzero(bad) + 1 + first - (is_too_late(steps)[bad] if kind == "backward" else 0)
        if where.size:
            rule = f"{where.size} {kind} time stamp(s), the first at sample {where[0]}"
            is_shuffled = kind == "backward" and where.size > MOST_STRAY * steps.size
            remedy = "sort the rows by time" if is_shuffled else f"leave those rows out, {REMEDY}"
            if kind == "repeated" and 2 * where.size > steps.size:
                rule += f", {(steps.size + 1) // (steps.size + 1 - where.size)} samples at each on average"
                rule += f"; {shared.says}" if shared else ""
                remedy = "give sampling_rate instead of the time column, whose stamps are rounded or of whole packets"
                remedy += f"; about {steps.size / steps.sum():.3g} Hz by them" if steps.sum() > 0 else ""
            problems.append(Problem(key, rule, remedy=remedy, source=source))
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


@dataclass(frozen=True)
class Written:
    """A grid that stamps are rounded to: the last digit in s, the first sample's time in s, the rate in Hz."""

    digit: float
    start: float
    rate: float


def written_in(stamps: NDArray[np.float64], index: NDArray[np.float64] | None = None) -> Written | None:
    """The even grid that stamps of few digits stand for; None where they are not rounded, or not from a grid.

    Rounding moves a stamp by half of its last digit, so that it tells nothing against a grid that is nearer. Of the
    rates that the digits allow, the one with the fewest digits of its own is taken.

    Args:
        stamps: (n,) in s.
        index: (n,) steps since the first; absent, one a stamp.
    """
    since, index = stamps - stamps[0], np.arange(stamps.size) if index is None else index
    digit = last_digit(since, 4 * np.spacing(np.abs(stamps).max()))
    centred = index - index.mean()
    with np.errstate(over="ignore", invalid="ignore"):
        step = float(centred @ since / (centred @ centred))
    if not step > 0:  # a stamp so far away that rounding hides all others
        return None
    rate = 1 / step
    if digit is None or np.ptp(since - index / rate) > _WRITTEN * digit:
        return None
    plain = (float(f"{rate:.{places}g}") for places in range(1, 7))
    rate = next((r for r in plain if np.ptp(since - index / r) <= (1 + EXACT) * digit), rate)
    off = since - index / rate
    return Written(digit, float(stamps[0] + (off.max() + off.min()) / 2), rate)


@dataclass(frozen=True)
class Shared:
    """An even grid whose samples share stamps that were rounded to steps longer than its own.

    Args:
        digit: The last digit of the stamps in s.
        start: Time of the first sample in s.
        rates: The lowest and the highest rate in Hz that rounds to the stamps.
        rate: The round one of them, in Hz; None where several may be meant.
    """

    digit: float
    start: float
    rates: tuple[float, float]
    rate: float | None

    @property
    def says(self) -> str:
        """What the stamps tell of the rate."""
        low, high = self.rates
        return f"rounded to {self.digit:.3g} s they may stand for any even rate from {low:.6g} to {high:.6g} Hz"

    def base(self, n: int) -> TimeBase:
        """The time of n samples at the round rate."""
        within = 50 * (self.rates[1] - self.rates[0]) / self.rate
        note = (
            f"time stamps are rounded to {self.digit:.3g} s, or those of whole packets: taken as an even "
            f"{self.rate:.6g} Hz, of which they tell {within:.2g} %; where that is wrong, give sampling_rate instead"
        )
        return TimeBase(self.start + np.arange(n) / self.rate, self.rate, notes=(note,))


def shared_grid(stamps: NDArray[np.float64]) -> Shared | None:
    """The even grid that (n,) stamps in s stand for, of which most repeat the one before; None where there is none."""
    steps, since = np.diff(stamps), stamps - stamps[0]
    leaps = np.flatnonzero(steps)
    if np.any(steps < 0) or leaps.size < _LEAST_LEAPS or 2 * leaps.size >= steps.size:
        return None
    digit = last_digit(since, 4 * np.spacing(np.abs(stamps).max()))
    if digit is None:
        return None
    ends = np.r_[0, np.column_stack([leaps, leaps + 1]).ravel(), steps.size]  # of the samples that share a stamp
    since = since[ends]

    def spread(step: float) -> float:  # convex in the step
        return float(np.ptp(since - step * ends))

    def is_possible(step: float) -> bool:
        return spread(step) <= (1 + EXACT) * digit

    centred = ends - ends.mean()
    fitted = float(centred @ since / (centred @ centred))
    near = (1 - _OFF / leaps.size) * fitted, (1 + _OFF / leaps.size) * fitted
    best = minimum(spread, near, _CLOSELY * fitted)
    if not is_possible(best):
        return None
    low, high = (1 / _last(is_possible, best, best * end) for end in (2.0, 0.5))
    rate = _round_in(low, high)
    off = since - ends / (rate or 1 / best)
    return Shared(digit, float(stamps[0] + (off.max() + off.min()) / 2), (low, high), rate)


def _last(is_possible: Callable[[float], bool], inside: float, beyond: float) -> float:
    """The last possible number on the way from one to a number beyond it, by halving."""
    for _ in range(_HALVINGS):
        middle = (inside + beyond) / 2
        inside, beyond = (middle, beyond) if is_possible(middle) else (inside, middle)
    return inside


def _round_in(low: float, high: float) -> float | None:
    """The rate of few digits, or of such a step, from low to high in Hz; None where it may be there by chance."""
    middle = (low + high) / 2
    for places in range(1, _ROUND_DIGITS + 1):
        for rate in (float(f"{middle:.{places}g}"), 1 / float(f"{1 / middle:.{places}g}")):
            if low <= rate <= high:
                apart = 10.0 ** (np.floor(np.log10(middle)) + 1 - places)  # from one rate of so many digits to the next
                return rate if high - low <= _BY_CHANCE * apart else None
    return None


def written_significantly(stamps: NDArray[np.float64]) -> TimeBase | None:
    """The even grid that (n,) stamps in s of a few significant digits stand for, as some programs write all numbers.

    Those far from zero are rounded to longer steps, until two come out alike; those before a trigger lie on the other
    side of it. None where they have more digits than a few, or
    where no even grid rounds to them.
    """
    steps = np.diff(stamps)
    if np.any(steps < 0) or not np.any(steps):
        return None
    for digits in _SIGNIFICANT:
        with np.errstate(divide="ignore"):
            last = 10.0 ** (np.floor(np.log10(np.abs(stamps))) - digits + 1)  # of 0: 0
        wholes = stamps / np.where(last > 0, last, 1.0)
        if np.all(np.abs(wholes - np.round(wholes)) <= EXACT):
            is_gap = steps.max() > 2 * (last.max() + float(np.median(steps[steps > 0])))
            found = None if is_gap else _even(stamps, last / 2)
            if found is None:
                return None
            start, rate = found
            note = f"time stamps have {digits} significant digits: taken as an even {rate:.6g} Hz"
            return TimeBase(start + np.arange(stamps.size) / rate, rate, notes=(note,))
    return None


def minimum(of: Callable[[float], float], between: tuple[float, float], closely: float) -> float:
    """Where a convex function of a number is least."""
    from scipy.optimize import minimize_scalar

    return float(minimize_scalar(of, bounds=between, method="bounded", options={"xatol": closely}).x)


def _even(stamps: NDArray, half: NDArray) -> tuple[float, float] | None:
    """Start and rate of the plainest grid from which no stamp lies farther than half of its last digit."""
    index, slope = np.arange(stamps.size), np.polyfit(np.arange(stamps.size), stamps, 1)[0]
    half = (1 + EXACT) * half + GRID_TOLERANCE * slope

    def starts(step: float) -> tuple[float, float]:
        """The latest of the earliest starts that the stamps allow, and the earliest of the latest."""
        return float(np.max(stamps - half - index * step)), float(np.min(stamps + half - index * step))

    def apart(step: float) -> float:  # convex, and no more than 0 where the grid is possible
        return starts(step)[0] - starts(step)[1]

    near = (1 - SAME_RATE) * slope, (1 + SAME_RATE) * slope
    best = 1 / minimum(apart, near, _CLOSELY * slope)
    for rate in (*(float(f"{best:.{places}g}") for places in range(1, 7)), float(best)):
        if apart(1 / rate) <= 0:
            return sum(starts(1 / rate)) / 2, rate
    return None
