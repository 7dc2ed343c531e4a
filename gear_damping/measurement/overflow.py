"""Values that left the range of a converter at one end and came back at the other, as integers do that overflow."""

import numpy as np

from gear_damping.measurement.record import Channel, Finding
from gear_damping.measurement.vocabulary import INPUTS

_FEWEST = 2  # leaps: out of the range, and back into it
_STEADY = 0.5  # of the range: steps before and behind a leap; a motion near half of the rate makes all of them as long
_SMOOTHER = 0.25  # of a leap's bend, that is left of it where the whole span is taken back


def overflowed(channel: Channel) -> Finding | None:
    """A finding where a response with a known range leaps by more than half of its span, and would run on without.

    A fast motion may step as far; taken back by the span it would bend there as much as before.
    """
    if channel.range is None or channel.name in INPUTS or channel.values.size < 4:
        return None
    span, steps = 2 * channel.range, np.diff(channel.values)
    at = np.flatnonzero(np.abs(steps[1:-1]) > channel.range) + 1
    at = at[np.maximum(np.abs(steps[at - 1]), np.abs(steps[at + 1])) < _STEADY * channel.range]
    taken_back = steps - span * np.round(steps / span)
    bends = [np.maximum(np.abs(d[at] - d[at - 1]), np.abs(d[at + 1] - d[at])) for d in (steps, taken_back)]
    leaps = at[bends[1] < _SMOOTHER * bends[0]]
    if leaps.size < _FEWEST:
        return None
    where = int(leaps[0]) + 1
    reach = f"{channel.range / channel.declared_factor:.4g} {channel.declared_unit}"
    message = (
        f"{channel.name} leaps {leaps.size} times from one end of its range of {reach} to the other, the first time at "
        f"sample {where}: integers that overflowed; export it as floating point, or use slices beside it"
    )
    return Finding("overflow", message, channel=channel.name, sample=where)
