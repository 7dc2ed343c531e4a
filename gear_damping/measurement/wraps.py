"""Series that begin again: an angle after a turn, counts after the last number of their register."""

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.encoders import WITHIN_A_TURN
from gear_damping.measurement.record import Finding

_BESIDE = 4  # steps at either side of a jump of an angle, by which it is seen whether it is a whole turn
_AS_BESIDE, _NEARLY_WHOLE = 3.0, 0.02  # times their median, and of a turn, as where it turns back or is rounded
_REGISTERS = (8, 16, 24, 32)  # bits of converters and counters
_LEVELS = 16  # different counts, with fewer of which a series switches and does not run over


def begins_again(angle: NDArray[np.float64], turn: float) -> bool:
    """Whether an angle jumps by about a turn from sample to sample and yet stays within one turn.

    Beside a whole turn a jump goes on as its neighbours do; a single wrong sample jumps by anything.
    """
    steps = np.abs(np.diff(angle))
    jumps = np.flatnonzero(steps > turn / 2)
    if not jumps.size or np.ptp(angle) > WITHIN_A_TURN * turn or np.median(steps) >= turn / 4:
        return False
    usual = [np.median(steps[max(0, k - _BESIDE) : k + _BESIDE + 1]) for k in jumps]
    return bool(np.all(np.abs(turn - steps[jumps]) <= _AS_BESIDE * np.array(usual) + _NEARLY_WHOLE * turn))


def unwrapped(angle: NDArray[np.float64], turn: float, name: str, notes: list[str]) -> NDArray[np.float64]:
    """An angle that goes on where the encoder began again at zero."""
    whole = np.unwrap(angle, period=turn)
    if not np.array_equal(whole, angle):
        notes.append(f"{name}: unwrapped")
    return whole


def run_over(counts: NDArray[np.float64], name: str, column: str | int) -> Finding | None:
    """Whole numbers that jump by a whole register: a sign that was not written, or a counter that ran over."""
    if np.any(counts != np.round(counts)) or np.unique(counts).size <= _LEVELS:
        return None
    size = next((2**bits for bits in _REGISTERS if counts.min() >= 0 and counts.max() < 2**bits), None)
    if size is None:
        return None
    steps, size = np.diff(counts), _size(counts, size)
    jumps = steps[np.abs(steps) > size / 2]
    both_ways = jumps.size > 1 and jumps.min() < 0 < jumps.max()  # a sawtooth falls again and again, and never jumps up
    if not begins_again(counts, float(size)) or not (both_ways or size in (2**bits for bits in _REGISTERS)):
        return None
    message = (
        f"column '{column}' jumps {len(jumps)} time(s) by about {size} from sample to sample, as counts below zero do "
        f"that were written without their sign, or a counter that ran over; where it is the sign, take {size} from "
        f"those above {size // 2 - 1}; where {size} counts are a turn of an encoder, write unit: rev, gain: {size}"
    )
    return Finding("run_over", message, channel=name)


def _size(counts: NDArray[np.float64], register: int) -> int:
    """How many counts there are: a power of two that the jumps agree with, else as many as were met.

    Beside a jump the counts go on by a step like its neighbours, so that it falls short of all counts by one of them.
    """
    steps = np.abs(np.diff(counts))
    far = steps > counts.max() / 2
    if not far.any() or far.all():
        return register
    short = _AS_BESIDE * np.median(steps[~far])
    powers = (register, 2 ** int(counts.max()).bit_length())
    return next((size for size in powers if size - np.median(steps[far]) <= short), int(counts.max()) + 1)
