"""What a sensor writes where a motion is beyond its range, although that value lies among those of the motion.

A laser writes 0 where its target is too near or too far. Such a value is leapt to and left again from far out, by more
than twice what the motion moves from sample to sample anywhere else, several times: no mass does that with its place,
though rates and forces may between blows.
"""

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.frozen import stays
from gear_damping.measurement.record import Channel, Finding

CONTINUOUS = ("displacement", "transmission_error")  # what a shock bends and does not break
_FEWEST = 2  # stretches at one value that are leapt into and out of: one may be a link that broke
_MOST = 0.5  # of the samples: a motion that is out of range longer than in it is none to look at
_LEAP = 2.0  # times the largest step elsewhere: a motion that is twice as fast shows between its leaps too
_FAR_OUT = 0.5  # of the way to the farthest value on that side: beyond its range a sensor is left near its end


def out_of_range(channel: Channel) -> Finding | None:
    """A finding where a response leaps to one value and back, from far out on the same side."""
    values = channel.values
    if channel.name not in CONTINUOUS:
        return None
    held = values[1:][np.diff(values) == 0]
    if not held.size:
        return None
    levels, counts = np.unique(held, return_counts=True)
    level = levels[np.argmax(counts)]
    found = _leapt_to(values, float(level))
    if len(found) < _FEWEST or np.mean(values == level) > _MOST:
        return None
    count = sum(last + 1 - first for first, last in found)
    message = (
        f"{channel.name} leaps to exactly {level / channel.declared_factor:.6g} {channel.declared_unit} and back over "
        f"{len(found)} stretches, {count} samples in all, the first at {found[0][0]}, each time from far out: what a "
        "sensor writes beyond its range; use slices or windows beside them"
    )
    return Finding("marked_values", message, channel=channel.name, sample=found[0][0])


def _leapt_to(values: NDArray[np.float64], level: float) -> list[tuple[int, int]]:
    """First and last sample of the stretches at a level that (n,) values leap into and out of."""
    at, steps = values == level, np.abs(np.diff(values))
    elsewhere = steps[~at[1:] & ~at[:-1]]
    if not elsewhere.size or not elsewhere.max() > 0:
        return []
    inner = [(first, last) for first, last in stays(at) if first > 0 and last + 1 < values.size]
    away = values - level
    ends = {sign: float(np.max(sign * away)) for sign in (-1.0, 1.0)}

    def is_leapt(first: int, last: int) -> bool:
        """Whether both neighbours of a stretch lie far out on one side, farther than any step elsewhere leads."""
        sign = float(np.sign(away[first - 1]))
        beside = min(sign * away[first - 1], sign * away[last + 1])
        return bool(sign and beside > max(_LEAP * elsewhere.max(), _FAR_OUT * ends[sign]))

    return [(first, last) for first, last in inner if is_leapt(first, last)]
