"""What uneven stamps are: rounded, jittering as a recorder's do, or a fault.

Jitter is explained where every step rounds to one: a step between 0.5 and 1.5 of the usual one is what two stamps
within a quarter of a step of their places make, and a band-limited signal is determined by samples so placed
(Kadec's theorem). Beyond, a step could as well be a lost or a doubled sample, and the stamps alone no longer say
which. A few late stamps (one in a thousand) that the next ones make good again are a busy recorder's and are let
pass. Another rate over an eighth of the record is a recorder's that slowed down, or one that writes events, and
steps of which a tenth and more are odd are those of samples that come when they come, as by a serial line: samples
are taken at their stamps, which is said. What stays unexplained is a data problem: a lasting shift of whole steps
(samples were dropped), any other lasting shift (the clock jumps, or the recorder paused where the values move as
long), steps all over the place.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.record import Finding

REMEDY = "or give sampling_rate instead of the time column, where the stamps are written with too few digits"
CLOCK_JUMPS, LOST = "clock_jumps", "dropped_samples"  # kinds of findings
HALF = 0.5  # of a step; a stamp that far from where it is due counts as another sample's
_PLACES = range(10)  # decimal places that are tried
EXACT = 1e-4  # of the last digit; how near a whole number of it stamps must be
_WHOLE = 0.05  # of a gap; how near a whole number of steps it must be, beside what the jitter allows
_LAST_SECOND, _MINUTE = 59, 60  # s, of a clock HHMMSS before it shows the next minute
_LISTED = 5  # gaps that a message lists
_DIGITS = (6, 15)  # that a time is told with: as numbers are elsewhere, and as many as a number in memory has
_RUN = 0.8  # share of gaps behind a gap from which they are a lower rate, not losses
_MANY = 0.1  # share of the steps; so many are no jumps but another rate, or none
_LOOSE = 0.2  # of a step; all that jitter may add to that
_SIDE = 8  # samples at either side of a gap that say whether the shift lasts
_LATE_SHARE = 1e-3  # of the stamps that may come late
SAME_RATE = 0.01  # relative change of rate that is no longer the same rate
_PARTS, _LEAST_PART = 8, 16  # a rate is looked at over an eighth of the record, of so many steps at least
_SIGMAS = 5.0  # of the jitter, that a rate over a part must leave the mean by


def irregularity(stamps: NDArray[np.float64], first: int = 0) -> Finding | None:
    """The data problem or the note that uneven stamps call for, or None where they jitter as a recorder's do.

    Args:
        stamps: (n,) strictly increasing, in s.
        first: The row of the first one, from which messages count, as slices do.
    """
    steps = np.diff(stamps)
    usual, slack = _usual_step(stamps, steps)
    odd = np.flatnonzero(np.abs(steps / usual - 1) > HALF + slack)
    lasting = np.array([k for k in odd if abs(_shift(stamps, usual, k)) > HALF + slack], int)
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
    return bool(np.mean(steps > 1 + HALF) >= _MANY and np.sum(steps - 1) > steps.size)


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
    digit = last_digit(stamps - stamps[0], 4 * np.spacing(np.abs(stamps).max()))
    if digit is None or np.mean(np.abs(np.abs(steps - usual) - digit) <= EXACT * digit) < _MANY:
        return usual, 0.0
    usual = float(np.mean(steps[steps < (1 + HALF) * usual]))
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
    allowed = SAME_RATE + _SIGMAS * scatter(steps) / mean / np.sqrt(part)
    if np.max(np.abs(local / mean - 1)) <= allowed:
        return None
    return int(np.argmax(np.abs(time - np.linspace(0.0, time[-1], time.size)))) + 1


def _dropped(lost: NDArray, stamps: NDArray, gaps: NDArray, first: int) -> Finding:
    before, behind = stamps[gaps], stamps[gaps + 1]
    if _are_clocks(before, behind):
        message = (
            f"numbers such as {before[0]:.12g} and then {behind[0]:.12g} are clocks, HHMMSS, and no seconds; write "
            "them as 12:34:56.7, or give sampling_rate instead of the time column"
        )
    else:
        rows = ", ".join(str(gap + 1 + first) for gap in gaps[:_LISTED].tolist())
        digits = _digits_for(float(behind[0]), float(np.median(np.diff(stamps))))
        times = ", ".join(f"{time:.{digits}g}" for time in behind[:_LISTED].tolist())
        most = int(np.argmax(lost))
        longest = f"the longest before row {gaps[most] + 1 + first} (at {behind[most]:.{digits}g} s)"
        more = f" and others, {longest}" if gaps.size > _LISTED else ""
        message = (
            f"about {lost.sum():.12g} sample(s) were dropped in {gaps.size} gap(s), before row(s) {rows} of the file "
            f"(at {times} s){more}; use slices or windows between the gaps"
        )
    return Finding(LOST, message, channel="time", sample=int(gaps[0]) + 1)


def _digits_for(time: float, step: float) -> int:
    """The digits by which a time in s is told from the one a step before it; those of a usual number at least."""
    return int(np.clip(np.ceil(np.log10(max(abs(time), step) / step)) + 1, *_DIGITS))


def _are_clocks(before: NDArray, behind: NDArray) -> bool:
    """Whether stamps leap from the last second of a minute to the next hundred, as those of HHMMSS do."""
    last = before % 100
    return bool(np.all((last >= _LAST_SECOND) & (last < _MINUTE) & (behind % 100 < 1)))


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


def last_digit(since: NDArray, rounding: float) -> float | None:
    """The largest power of ten in s that times are whole multiples of."""
    for digit in (10.0**-places for places in _PLACES):
        if np.all(np.abs(since - digit * np.round(since / digit)) <= EXACT * digit + rounding):
            return digit
    return None
