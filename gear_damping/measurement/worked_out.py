"""A motion of an oscillator that was worked out from another column of its file, as the slope of that.

Differences make the noise of what they are taken of large at high frequencies, and what they give tells nothing that it
did not. A sensor of its own agrees with the slope but for the noise of both; what was worked out agrees to the last
digits that were written.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.record import Finding
from gear_damping.measurement.resolution import step_of
from gear_damping.measurement.vocabulary import OSCILLATOR_CHANNELS

Array = NDArray[np.float64]
_FEWEST = 64  # samples: fewer agree by chance
_ALIKE = 0.95  # correlation with a slope, below which nothing else is looked at
_TO_ROUNDING = 2.0  # times what rounding both columns leaves, within which one is the slope of the other
_DIGITS = 1e-4  # of a column's deviation, which digits leave that show no step
_TELLING = 0.05  # of a column's deviation: coarser rounding does not tell a sensor from a slope
_NAMES = {order: name for name, order in OSCILLATOR_CHANNELS.items() if order is not None}


def worked_out(channel: str, values: Array, time: Array, others: Sequence[tuple[str, Array]]) -> Iterator[Finding]:
    """A note where a velocity or an acceleration is the slope of another column, or the slope of its slope.

    Args:
        channel: What it is declared as; nothing is said of what is no rate.
        values: (n,) as the file has them.
        time: (n,) in s.
        others: Name and (n,) values of each other column.
    """
    order = OSCILLATOR_CHANNELS.get(channel) or 0
    if values.size < _FEWEST or np.ptp(values) == 0:
        return
    for name, other in others:
        for times in range(1, order + 1):
            if np.ptp(other) > 0 and _is_slope(values, other, time, times):
                of = "slope" if times == 1 else "slope of the slope"
                message = (
                    f"{channel} is the {of} of column '{name}', to the digits that were written: it was worked out "
                    f"from that, and its noise is large at high frequencies; declare '{name}' as "
                    f"{_NAMES[order - times]} without it, unless a sensor of its own measured it"
                )
                yield Finding("worked_out", message, channel=channel, severity="note")
                return


def _is_slope(values: Array, other: Array, time: Array, times: int) -> bool:
    """Whether values are the slope of another column, taken so many times, in any unit and to the rounding of both."""
    inner = slice(2 * times, -2 * times)  # the ends are worked out in other ways
    seen, deviation = values[inner], float(np.std(values[inner]))
    for slopes, noise in _differences(other, time, times):
        slope, spread = slopes[inner], float(np.std(slopes[inner]))
        if not spread or not deviation or abs(np.corrcoef(slope, seen)[0, 1]) < _ALIKE:
            continue
        scale = float(np.cov(slope, seen, bias=True)[0, 1]) / spread**2
        left = float(np.std(seen - scale * slope))
        rounded = np.hypot(step_of(values), scale * noise * step_of(other)) / 12**0.5 + _DIGITS * deviation
        if left <= _TO_ROUNDING * rounded <= _TELLING * deviation:
            return True
    return False


def _differences(values: Array, time: Array, times: int) -> Iterator[tuple[Array, float]]:
    """(n,) slopes of (n,) values as programs take them, each with what it makes of the deviation of white noise."""
    step = float(np.median(np.diff(time)))
    central, backward = values, values
    for _ in range(times):
        central = np.gradient(central, time)
        backward = np.diff(backward, prepend=np.nan) / np.diff(time, prepend=np.nan)
    backward = np.nan_to_num(backward)
    yield central, (0.5**0.5 / step, 0.375**0.5 / step**2)[times - 1]
    yield backward, (2**0.5 / step, 6**0.5 / step**2)[times - 1]
    yield np.r_[backward[times:], np.zeros(times)], (2**0.5 / step, 6**0.5 / step**2)[times - 1]
    if times > 1:
        yield np.r_[backward[1:], 0.0], 6**0.5 / step**2
