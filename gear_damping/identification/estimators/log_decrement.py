"""The logarithmic decrement of successive half swings."""

from typing import ClassVar

import numpy as np

from gear_damping.identification.damping_estimate import DampingEstimate, UnsuitedRecord
from gear_damping.identification.decay_rate import decay_rate, estimate_of
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.identification.free_vibration import FreeVibration
from gear_damping.setting import Setting

ABOVE_NOISE = 3.0  # standard deviations that a half swing must have to count


class LogDecrement(RecordEstimator):
    """Half the distance from each peak to the next trough, which no offset moves, and the slope of its logarithm.

    The samples are smoothed by parabolas over a part of a period, so that noise makes no peaks of its own.
    """

    name = "log_decrement"
    reference = "Inman, Engineering Vibration, section 1.6"
    settings: ClassVar = (Setting("smoothing", 0.3, "part of a period over which parabolas are fitted", 0.05, 0.5),)

    def estimate(self, recorded: Recorded) -> DampingEstimate:
        """The mean over all half swings that stand out of the noise."""
        free = recorded.free_vibration
        place, value = self._turning_points(free)
        half_swings = np.abs(np.diff(value)) / 2
        middle = (place[1:] + place[:-1]) / 2 / free.sampling_rate
        kept = half_swings > ABOVE_NOISE * free.noise
        if kept.sum() < 2 * 4:  # four periods
            raise UnsuitedRecord("fewer than eight half swings stand out of the noise: record a longer ring-down")
        size = half_swings[kept]
        rate = decay_rate(middle[kept], np.log(size), 1 / size)
        frequency = free.sampling_rate / (2 * float(np.median(np.diff(place))))
        return estimate_of(rate, frequency, (float(size.max()), float(size.min())))

    def _turning_points(self, free: FreeVibration) -> tuple[np.ndarray, np.ndarray]:
        """Places in samples and values of the peaks and troughs, one after another."""
        half = max(1, round(self.values["smoothing"] * free.period / 2))
        offsets = np.arange(-half, half + 1.0)
        fit = np.linalg.pinv(np.stack([np.ones_like(offsets), offsets, offsets**2], axis=1))
        windows = np.lib.stride_tricks.sliding_window_view(free.values, offsets.size)
        height, slope, bend = (windows @ row for row in fit)
        turns = np.flatnonzero(np.sign(slope[1:]) != np.sign(slope[:-1]))
        turns = turns[np.abs(bend[turns]) > 0]
        shift = np.clip(-slope[turns] / (2 * bend[turns]), -half, half)
        value = height[turns] + slope[turns] * shift + bend[turns] * shift**2
        return _alternating(turns + half + shift, value)


def _alternating(place: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of turning points of one sign in a row, the outermost: above and below the mean by turns."""
    groups = np.flatnonzero(np.diff(np.sign(value)) != 0) + 1
    best = [group[np.argmax(np.abs(value[group]))] for group in np.split(np.arange(value.size), groups) if group.size]
    return place[best], value[best]
