"""Values that left the range of a converter at one end and came back at the other, as integers do that overflow."""

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.record import Channel, Finding
from gear_damping.measurement.vocabulary import INPUTS

FEWEST_LEAPS = 2  # leaps: out of the range, and back into it
_STEADY = 0.5  # of the range: the step before or behind a leap; a motion near half of the rate makes both as long
_SMOOTHER = 0.25  # of a leap's bend, that is left of it where the whole span is taken back


def overflowed(channel: Channel) -> Finding | None:
    """A finding where a response with a known range leaps by more than half of its span, and would run on without.

    A fast motion may step as far; taken back by the span it would bend there as much as before.
    """
    if channel.range is None or channel.name in INPUTS or channel.values.size < 4:
        return None
    leaps = leaps_over(channel.values, channel.range)
    if leaps.size < FEWEST_LEAPS:
        return None
    where = int(leaps[0]) + 1
    reach = f"{channel.range / channel.declared_factor:.4g} {channel.declared_unit}"
    message = (
        f"{channel.name} leaps {leaps.size} times from one end of its range of {reach} to the other, the first time at "
        f"sample {where}: integers that overflowed; export it as floating point, or use slices beside it"
    )
    return Finding("overflow", message, channel=channel.name, sample=where)


def leaps_over(values: NDArray[np.float64], reach: float) -> NDArray[np.intp]:
    """The steps of (n,) values by more than `reach` that run on smoothly where twice that is taken back from them."""
    span, steps = 2 * reach, np.diff(values)
    at = np.flatnonzero(np.abs(steps[1:-1]) > reach) + 1
    at = at[np.minimum(np.abs(steps[at - 1]), np.abs(steps[at + 1])) < _STEADY * reach]
    taken_back = steps - span * np.round(steps / span)
    bends = [np.maximum(np.abs(d[at] - d[at - 1]), np.abs(d[at + 1] - d[at])) for d in (steps, taken_back)]
    return at[bends[1] < _SMOOTHER * bends[0]]
