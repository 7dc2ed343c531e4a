"""Samples that a recorder lost between others, while its stamps went on evenly.

A buffer that overflows leaves out what came meanwhile, and the rate of the rest is written beside it all the same. A
place that is measured then leaps ahead: always the way that it is moving, and by as much as it moves in one or several
samples. Noise, steps of a converter, counts that are lost and shocks lead to either side.
"""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from gear_damping.measurement.out_of_range import CONTINUOUS
from gear_damping.measurement.record import Channel, Finding

_ABOUT = 5  # steps on either side, whose median says how fast the motion is there
_LEAP = 12.0  # times what steps usually differ from it; the largest of a million of white noise differs by 8 times
_SAMPLE = 0.5  # of the way in a sample, above which a leap is that of a whole one
_AHEAD = 0.9  # share of the leaps that lead ahead
_FEWEST = 8  # leaps: so many to one side are chance in one record of 256
_FEWEST_SEEN = 50  # steps in fast stretches, below which nothing is decided
_MOST = 0.02  # of the samples; with more lost every frequency and every rate is wrong by as much


def lost_samples(channel: Channel, time: NDArray[np.float64]) -> Finding | None:
    """A finding where a measured place leaps ahead again and again between stamps that are even."""
    if channel.name not in CONTINUOUS or channel.values.size < _FEWEST_SEEN:
        return None
    places, leaps, fast = _leaps(channel.values)
    steps = np.diff(time)
    even = steps[places] < (1 + _SAMPLE) * np.median(steps)  # a gap in the stamps is told by these
    places, leaps = places[even], leaps[even]
    if len(places) < _FEWEST or np.mean(leaps > 0) < _AHEAD:
        return None
    usual, count = float(np.median(leaps)), len(places)
    share = count * usual / fast / channel.values.size  # leaps are seen in fast stretches alone
    message = (
        f"{channel.name} leaps ahead {count} times, the first after sample {places[0]}, always the way it moves and by "
        f"as much as it does in {usual:.2g} samples (median), while the stamps go on evenly: samples were lost there, "
        f"some {100 * share:.1g} % of all; record it anew, or use slices between them"
    )
    severity = "data_problem" if share > _MOST else "note"
    return Finding("lost_samples", message, channel=channel.name, sample=int(places[0]), severity=severity)


def _leaps(values: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float64], float]:
    """Samples in fast stretches that the next one is far off from, by how many usual steps too far ahead; and the share
    of the steps that lie in such stretches.

    Fast is a step above their root mean square, by the usual ones about it, which go on alike on both sides.
    """
    steps = np.diff(values)
    about = np.median(sliding_window_view(steps, _ABOUT), axis=1)
    places = np.arange(_ABOUT, len(steps) - _ABOUT)
    before, behind = about[places - _ABOUT], about[places + 1]
    usual = (before + behind) / 2
    is_fast = np.abs(usual) > np.sqrt(np.mean(usual**2))
    is_fast &= (before * behind > 0) & (np.abs(behind - before) < np.abs(usual))
    fast, places, usual = float(np.mean(is_fast)), places[is_fast], usual[is_fast]
    if len(places) < _FEWEST_SEEN:
        return places[:0], usual[:0], fast
    off = steps[places] - usual
    is_leap = np.abs(off) > np.maximum(_LEAP * np.median(np.abs(off)), _SAMPLE * np.abs(usual))
    return places[is_leap], off[is_leap] / usual[is_leap], fast
