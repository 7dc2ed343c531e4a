"""Series that begin again: an angle after a turn, counts after the last number of their register."""

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.angular_error import turn_in
from gear_damping.measurement.column_kinds import turn_of, unit_of_turn
from gear_damping.measurement.encoders import WITHIN_A_TURN
from gear_damping.measurement.overflow import FEWEST_LEAPS, leaps_over
from gear_damping.measurement.record import Finding

_BESIDE = 4  # steps at either side of a jump of an angle, by which it is seen whether it is a whole turn
_AS_BESIDE, _NEARLY_WHOLE = 3.0, 0.02  # times their median, and of a turn, as where it turns back or is rounded
_REGISTERS = (8, 16, 24, 32)  # bits of converters and counters
_MOSTLY, _SLOW = 0.8, 0.25  # of the long steps, that go over an end; of half the register, for a usual step
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


def refuse_other_turn(angle: NDArray[np.float64], unit: str, key: str, source: str) -> None:
    """Refuse an angle that falls back again and again by a turn of another unit than the one that is declared.

    Raises:
        InputError: naming the unit that it has.
    """
    height = turn_of(angle)
    found = None if height is None else unit_of_turn(height)
    if found and not np.isclose(turn_in(found), turn_in(unit)):
        rule = f"the angle falls back by {height:.4g} again and again, a turn in {found}, and none in '{unit}'"
        raise InputError(Problem(key, rule, unit, f"write unit: {found}", source))


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
    if counts.min() < 0:
        return _signed_run_over(counts, name, column)
    size = next((2**bits for bits in _REGISTERS if counts.max() < 2**bits), None)
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


def _signed_run_over(counts: NDArray[np.float64], name: str, column: str | int) -> Finding | None:
    """Whole numbers with a sign that leave their register at one end and come back at the other."""
    reach = 2 ** max(int(-counts.min() - 1).bit_length(), int(counts.max()).bit_length())
    leaps, steps = leaps_over(counts, float(reach)), np.abs(np.diff(counts))
    if leaps.size < max(FEWEST_LEAPS, _MOSTLY * np.count_nonzero(steps > reach)) or np.median(steps) > _SLOW * reach:
        return None
    first = int(leaps[0]) + 1
    message = (
        f"column '{column}' jumps {leaps.size} time(s) by about {2 * reach} from sample to sample, the first time at "
        f"sample {first}, as integers from {-reach} to {reach - 1} do that overflowed; export it as floating point or "
        f"in more bits, or add {2 * reach} to what came back at the lower end, and take it from what did at the other"
    )
    return Finding("run_over", message, channel=name, sample=first)


def _size(counts: NDArray[np.float64], register: int) -> int:
    """How many counts there are: a power of two that the jumps agree with, else as many as were met.

    A jump falls short of all counts by what the motion does over it, which the steps beside it say.
    """
    steps = np.diff(counts)
    far = np.abs(steps) > counts.max() / 2
    inner = far[1:-1] & ~far[:-2] & ~far[2:]
    at = np.flatnonzero(inner) + 1
    if not at.size:
        return register
    before, behind = (-np.sign(steps[at]) * steps[at + side] for side in (-1, 1))
    whole = float(np.median(np.abs(steps[at]) + (before + behind) / 2))
    off = float(np.median(np.abs(behind - before))) + 1
    powers = (register, 2 ** int(counts.max()).bit_length())
    return next((size for size in powers if abs(size - whole) <= off), int(counts.max()) + 1)
