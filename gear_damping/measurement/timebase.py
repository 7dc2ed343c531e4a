"""From time stamps to a time base: uniform, put on a grid, or left at the stamps and said.

What uneven stamps are: rounded, jittering as a recorder's do, or a fault. Jitter is explained where every step rounds
to one: a step between 0.5 and 1.5 of the usual one is what two stamps within a quarter of a step of their places make,
and a band-limited signal is determined by samples so placed (Kadec's theorem). Beyond, a step could as well be a lost
or a doubled sample, and the stamps alone no longer say which. A few late stamps (one in a thousand) that the next ones
make good again are a busy recorder's and are let pass. Another rate over an eighth of the record is a recorder's that
slowed down, or one that writes events, and steps of which a tenth and more are odd are those of samples that come when
they come, as by a serial line: samples are taken at their stamps, which is said. What stays unexplained is a data
problem: a lasting shift of whole steps (samples were dropped), any other lasting shift (the clock jumps, or the
recorder paused where the values move as long), steps all over the place. Whether the values were taken at their
stamps is asked of them too (`record_checks`).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.record import Finding
from gear_damping.measurement.recordings import is_too_late, past_overflow, refuse_recordings

Curve = Callable[[NDArray[np.float64]], NDArray[np.float64]]
RATE_TOLERANCE = 0.01  # relative; rates within are one
GRID_TOLERANCE = 1e-6  # of a step; stamps this close to a grid are one
# Of a step: a cubic spline that moves samples this far errs by at most 0.07 % of content at 4 samples a period and
# 0.001 % of content at 10, because its slope errs by 4.5 and 0.1 %; beyond, samples are fitted at their stamps.
SPLINE_TOLERANCE = 0.01
MOST_STRAY = 0.1  # of the steps go back in a clock that stumbles; beyond, rows stand in another order
REMEDY = "or give sampling_rate instead of the time column, where the stamps are written with too few digits"
CLOCK_JUMPS, LOST = "clock_jumps", "dropped_samples"  # kinds of findings
_HALF = 0.5  # of a step; a stamp that far from where it is due counts as another sample's
_WHOLE = 0.05  # of a gap; how near a whole number of steps it must be, beside what the jitter allows
_LAST_SECOND, _MINUTE = 59, 60  # s, of a clock HHMMSS before it shows the next minute
_LISTED = 5  # gaps that a message lists
_RUN = 0.8  # share of gaps behind a gap from which they are a lower rate, not losses
_MANY = 0.1  # share of the steps; so many are no jumps but another rate, or none
_LOOSE = 0.2  # of a step; all that jitter may add to that
_SIDE = 8  # samples at either side of a gap that say whether the shift lasts
_LATE_SHARE = 1e-3  # of the stamps that may come late
_RATE = 0.01  # relative change of rate that is no longer the same rate
_PARTS, _LEAST_PART = 8, 16  # a rate is looked at over an eighth of the record, of so many steps at least
_SIGMAS = 5.0  # of the jitter, that a rate over a part must leave the mean by
_WRITTEN = 1.2  # last digits over which rounded stamps may spread about their grid
_PLACES = range(10)  # decimal places that are tried
_SIGNIFICANT = range(2, 6)  # digits of stamps that may come out alike; with more, rows are stored twice
_CLOSELY = 1e-12  # of a step: to which it is sought that the first of ten thousand stamps allow
_HOLES = 2  # in stamps of few digits that are lost samples, where more of them, regular, are rounding
_EXACT = 1e-4  # of the last digit; how near a whole number of it stamps must be


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
        InputError: a stamp repeats the one before, or lies before it, or the clock starts again.
    """
    stamps = past_overflow(stamps)
    refuse_recordings(stamps, key, source, first)
    if np.any(np.diff(stamps) == 0) and (few := written_significantly(stamps)) is not None:
        return few
    _refuse_repeated_or_backward(np.diff(stamps), key, source, first)
    rate = (stamps.size - 1) / float(stamps[-1] - stamps[0])
    grid = np.linspace(stamps[0], stamps[-1], stamps.size)
    away = float(np.max(np.abs(stamps - grid))) * rate
    if away <= GRID_TOLERANCE:
        return TimeBase(stamps, rate)
    if away <= SPLINE_TOLERANCE:
        variation = 100 * float(np.max(np.abs(np.diff(stamps) * rate - 1)))
        note = f"time steps vary by up to {variation:.2g} %: resampled to a uniform grid at {rate:.6g} Hz"
        return TimeBase(grid, rate, stamps=stamps, notes=(note,))
    written = None if _is_grid_with_holes(stamps) else written_in(stamps)
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
    step = float(np.mean(steps[steps < (1 + _HALF) * np.median(steps)]))
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


def _refuse_repeated_or_backward(steps: NDArray, key: str, source: str, first: int) -> None:
    problems = []
    for kind, bad in (("repeated", steps == 0), ("backward", steps < 0)):
        where = np.flatnonzero(bad) + 1 + first - (is_too_late(steps)[bad] if kind == "backward" else 0)
        if where.size:
            rule = f"{where.size} {kind} time stamp(s), the first at sample {where[0]}"
            is_shuffled = kind == "backward" and where.size > MOST_STRAY * steps.size
            remedy = "sort the rows by time" if is_shuffled else f"leave those rows out, {REMEDY}"
            if kind == "repeated" and 2 * where.size > steps.size:
                rule += f", {(steps.size + 1) // (steps.size + 1 - where.size)} samples at each on average"
                remedy = "give sampling_rate instead of the time column, whose stamps are those of whole packets"
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
    digit = _last_digit(since, 4 * np.spacing(np.abs(stamps).max()))
    centred = index - index.mean()
    with np.errstate(over="ignore", invalid="ignore"):
        step = float(centred @ since / (centred @ centred))
    if not step > 0:  # a stamp so far away that rounding hides all others
        return None
    rate = 1 / step
    if digit is None or np.ptp(since - index / rate) > _WRITTEN * digit:
        return None
    plain = (float(f"{rate:.{places}g}") for places in range(1, 7))
    rate = next((r for r in plain if np.ptp(since - index / r) <= (1 + _EXACT) * digit), rate)
    off = since - index / rate
    return Written(digit, float(stamps[0] + (off.max() + off.min()) / 2), rate)


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
        if np.all(np.abs(wholes - np.round(wholes)) <= _EXACT):
            is_gap = steps.max() > 2 * (last.max() + float(np.median(steps[steps > 0])))
            found = None if is_gap else _even(stamps, last / 2)
            if found is None:
                return None
            start, rate = found
            note = f"time stamps have {digits} significant digits: taken as an even {rate:.6g} Hz"
            return TimeBase(start + np.arange(stamps.size) / rate, rate, notes=(note,))
    return None


def _even(stamps: NDArray, half: NDArray) -> tuple[float, float] | None:
    """Start and rate of the plainest grid from which no stamp lies farther than half of its last digit."""
    from scipy.optimize import minimize_scalar

    index, slope = np.arange(stamps.size), np.polyfit(np.arange(stamps.size), stamps, 1)[0]
    half = (1 + _EXACT) * half + GRID_TOLERANCE * slope

    def starts(step: float) -> tuple[float, float]:
        """The latest of the earliest starts that the stamps allow, and the earliest of the latest."""
        return float(np.max(stamps - half - index * step)), float(np.min(stamps + half - index * step))

    def apart(step: float) -> float:  # convex, and no more than 0 where the grid is possible
        return starts(step)[0] - starts(step)[1]

    near = (1 - _RATE) * slope, (1 + _RATE) * slope
    best = 1 / minimize_scalar(apart, bounds=near, method="bounded", options={"xatol": _CLOSELY * slope}).x
    for rate in (*(float(f"{best:.{places}g}") for places in range(1, 7)), float(best)):
        if apart(1 / rate) <= 0:
            return sum(starts(1 / rate)) / 2, rate
    return None


def _last_digit(since: NDArray, rounding: float) -> float | None:
    """The largest power of ten in s that times are whole multiples of."""
    for digit in (10.0**-places for places in _PLACES):
        if np.all(np.abs(since - digit * np.round(since / digit)) <= _EXACT * digit + rounding):
            return digit
    return None


def irregularity(stamps: NDArray[np.float64], first: int = 0) -> Finding | None:
    """The data problem or the note that uneven stamps call for, or None where they jitter as a recorder's do.

    Args:
        stamps: (n,) strictly increasing, in s.
        first: The row of the first one, from which messages count, as slices do.
    """
    steps = np.diff(stamps)
    usual, slack = _usual_step(stamps, steps)
    odd = np.flatnonzero(np.abs(steps / usual - 1) > _HALF + slack)
    lasting = np.array([k for k in odd if abs(_shift(stamps, usual, k)) > _HALF + slack], int)
    gaps = steps[lasting] / usual
    run = np.mean(np.diff(lasting) == 1) if lasting.size > 2 else 0.0
    is_lost = lasting.size and run < _RUN and not written_on_change(stamps)
    if is_lost and _are_whole(gaps, scatter(steps) / usual):
        return _dropped(np.round(gaps) - 1, stamps, lasting, first)
    few = run < _RUN and lasting.size < _MANY * steps.size
    changes = _change_of_rate(np.delete(steps, lasting) if few else steps)
    if changes is not None:
        return _changing(steps, changes, first)
    if odd.size >= _MANY * steps.size:
        return _scattered(steps)
    if lasting.size:
        return replace(_unexplained(steps, int(lasting[0]) + 1, "the clock jumps", first), kind=CLOCK_JUMPS)
    if odd.size > 2 * max(1.0, _LATE_SHARE * steps.size):  # a late stamp has an odd step at either side
        what = "more than jitter, for some steps are nearer to none or to two"
        return _unexplained(steps, int(odd[0]) + 1, what, first)
    return None


def written_on_change(stamps: NDArray[np.float64]) -> bool:
    """Whether a recorder writes when something changes: at many places, it would have lost more than it kept."""
    steps = np.diff(stamps) / np.median(np.diff(stamps))
    return bool(np.mean(steps > 1 + _HALF) >= _MANY and np.sum(steps - 1) > steps.size)


def jitter_note(stamps: NDArray[np.float64]) -> Finding:
    """The note on stamps that jitter."""
    steps = np.diff(stamps)
    mean = float(steps.mean())
    message = (
        f"time steps scatter by {100 * steps.std() / mean:.2g} % (from {steps.min():.4g} to {steps.max():.4g} s) about "
        f"{1 / mean:.6g} Hz: samples are taken at their stamps"
    )
    return Finding("uneven_stamps", message, channel="time", severity="note")


def _shift(stamps: NDArray, usual: float, k: int) -> float:
    """By how many steps the stamps behind step k are later than those before it say, beside the step itself."""
    first, last = max(0, k + 1 - _SIDE), min(stamps.size, k + 1 + _SIDE)
    late = stamps[first:last] - stamps[first] - usual * np.arange(last - first)
    at = k + 1 - first
    return float(np.median(late[at:]) - np.median(late[:at])) / usual


def _usual_step(stamps: NDArray, steps: NDArray) -> tuple[float, float]:
    """The usual step in s, and what the rounding of stamps may add to one, in steps; none where none shows."""
    usual = float(np.median(steps))
    digit = _last_digit(stamps - stamps[0], 4 * np.spacing(np.abs(stamps).max()))
    if digit is None or np.mean(np.abs(np.abs(steps - usual) - digit) <= _EXACT * digit) < _MANY:
        return usual, 0.0
    usual = float(np.mean(steps[steps < (1 + _HALF) * usual]))
    return usual, digit / usual


def scatter(steps: NDArray) -> float:
    """Standard deviation of steps in s; neither gaps nor changes of the rate count."""
    return 1.4826 * float(np.median(np.abs(np.diff(steps)))) / np.sqrt(2)


def _are_whole(gaps: NDArray, scatter: float) -> bool:
    """Whether gaps, in steps, are two steps or more and whole ones, up to the jitter."""
    whole = np.round(gaps)
    return bool(np.all((whole >= 2) & (np.abs(gaps - whole) <= _WHOLE * whole + min(_SIGMAS * scatter, _LOOSE))))


def _change_of_rate(steps: NDArray) -> int | None:
    """The first sample of the part with another rate, or None where one rate holds throughout."""
    part = max(_LEAST_PART, steps.size // _PARTS)
    if steps.size < 2 * part:
        return None
    time = np.r_[0.0, np.cumsum(steps)]
    local = (time[part:] - time[:-part]) / part
    mean = float(np.median(local))
    allowed = _RATE + _SIGMAS * scatter(steps) / mean / np.sqrt(part)
    if np.max(np.abs(local / mean - 1)) <= allowed:
        return None
    return int(np.argmax(np.abs(time - np.linspace(0.0, time[-1], time.size)))) + 1


def _dropped(lost: NDArray, stamps: NDArray, gaps: NDArray, first: int) -> Finding:
    rows = ", ".join(str(gap + 1 + first) for gap in gaps[:_LISTED].tolist())
    times = ", ".join(f"{stamps[gap + 1]:.6g}" for gap in gaps[:_LISTED].tolist())
    more = " and others" if gaps.size > _LISTED else ""
    if _are_clocks(stamps[gaps], stamps[gaps + 1]):
        message = (
            f"numbers such as {stamps[gaps[0]]:.12g} and then {stamps[gaps[0] + 1]:.12g} are clocks, HHMMSS, and no "
            "seconds; write them as 12:34:56.7, or give sampling_rate instead of the time column"
        )
        return Finding(LOST, message, channel="time", sample=int(gaps[0]) + 1)
    message = (
        f"about {lost.sum():.12g} sample(s) were dropped in {gaps.size} gap(s), before row(s) {rows} of the file "
        f"(at {times} s){more}; use slices or windows between the gaps"
    )
    return Finding(LOST, message, channel="time", sample=int(gaps[0]) + 1)


def _are_clocks(before: NDArray, behind: NDArray) -> bool:
    """Whether stamps leap from the last second of a minute to the next hundred, as those of HHMMSS do."""
    return bool(np.all(before % 100 >= _LAST_SECOND) and np.all(behind % 100 < 1) and np.all(before % 100 < _MINUTE))


def _changing(steps: NDArray, where: int, first: int) -> Finding:
    message = (
        f"{_range_of(steps)}: the rate changes, first before row {where + first}; samples are taken at their stamps; "
        "where the clock and not the sampling did that, give sampling_rate instead of the time column"
    )
    return Finding("uneven_stamps", message, channel="time", sample=where, severity="note")


def _scattered(steps: NDArray) -> Finding:
    message = (
        f"{_range_of(steps)}, and many are long: samples are taken at their stamps; where the clock and not the "
        "sampling did that, give sampling_rate instead of the time column"
    )
    return Finding("uneven_stamps", message, channel="time", severity="note")


def _unexplained(steps: NDArray, where: int, what: str, first: int) -> Finding:
    message = f"{_range_of(steps)}: {what}, first before row {where + first}; use slices of one rate, {REMEDY}"
    return Finding("uneven_stamps", message, channel="time", sample=where)


def _range_of(steps: NDArray) -> str:
    return f"time steps from {steps.min():.4g} to {steps.max():.4g} s about a median of {np.median(steps):.4g} s"
