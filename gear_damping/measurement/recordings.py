"""Recordings that stand one after another in a file, each with a clock of its own."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem

_RESTART = 10  # usual steps that a clock goes back by where it starts again
_LEAST = 16  # stamps of a recording: fewer are rows in another order
_NEAR = 2.0  # usual steps from the end of a register and from its beginning
_PERIODS = [2.0**bits * unit for bits in (16, 24, 32) for unit in (1.0, 1e-3, 1e-6)]  # of registers of clocks
_PARTS = (1.0, 60.0, 3600.0, 86400.0)  # s: of a second, a minute, an hour, a day, where each has a column of its own
_LISTED = 5  # recordings that a message lists


def past_overflow(stamps: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n,) stamps that go on where the register of a clock was full: in counts, or in s of its milli- or microseconds.

    The last stamp before such a fall lies at the end of the register, the first one behind it at its beginning. So does
    what a clock says of a second, beside a column of whole ones; a recording that begins anew begins with 0 each time.
    """
    steps = np.diff(stamps)
    falls = np.flatnonzero(steps < 0)
    if not falls.size:
        return stamps
    near = _NEAR * float(np.median(steps))
    parts = _PARTS if stamps[0] > near else ()
    for period in (*_PERIODS, *parts):
        is_full = stamps[falls] > period - near
        if np.all(is_full & (stamps[falls + 1] < near)) and stamps.min() >= 0 and stamps.max() < period:
            return stamps + period * np.r_[0, np.cumsum(steps < 0)]
    return stamps


def recordings(stamps: NDArray[np.float64]) -> list[tuple[int, int]]:
    """First row, and the one behind the last, of recordings one after another, each with a clock that starts again.

    One for stamps that never go back far, or that do so for another reason.
    """
    steps = np.diff(past_overflow(stamps))
    far = _RESTART * float(np.median(np.abs(steps)))
    again = np.flatnonzero(steps < -far) + 1
    if np.any(is_too_late(steps)[again - 1]):
        return [(0, stamps.size)]
    ends = list(pairwise([0, *again.tolist(), stamps.size]))
    long = all(end - first >= _LEAST for first, end in ends)
    is_lasting = long and bool(np.all(steps[again] < far)) and np.sum(steps < 0) == again.size
    return ends if is_lasting else [(0, stamps.size)]


def is_too_late(steps: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether of the two stamps of a step the first is the wrong one: without it the clock goes on."""
    before, behind = np.r_[-np.inf, steps[:-1]], np.r_[steps[1:], np.inf]
    return (steps < 0) & (before + steps > 0) & (steps + behind <= 0)


def refuse_recordings(stamps: NDArray[np.float64], key: str, source: str, first: int) -> None:
    """Refuse recordings one after another.

    Raises:
        InputError: the clock starts again, with the slice of each recording.
    """
    found = recordings(stamps)
    if len(found) > 1:
        where = ", ".join(str(begin + first) for begin, _ in found[1 : 1 + _LISTED])
        slices = ", ".join(f"[{begin + first}, {end + first}]" for begin, end in found[:_LISTED])
        more = " and so on" if len(found) > _LISTED else ""
        rule = f"the clock starts again at sample {where}{more}: {len(found)} recordings one after another"
        remedy = f"make each of them a record, with slice: {slices}{more}"
        raise InputError(Problem(key, rule, remedy=remedy, source=source))
