"""An estimator of one's own that takes a record by itself: the fall of the energy over a ring-down.

python -m gear_damping task=identify measurement.path=measurement.yaml \
        model.plugins=[docs/examples/my_record_estimator.py] model.names=[energy_fall,wavelet_ridge]
"""

from math import pi
from typing import ClassVar

import numpy as np

from gear_damping.identification.damping_estimate import DampingEstimate, UnsuitedRecord
from gear_damping.identification.decay_rate import decay_rate, estimate_of
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.setting import Setting


class EnergyFall(RecordEstimator):
    """The logarithm of the mean square over whole periods falls at twice the rate of the amplitude."""

    name = "energy_fall"
    reference = "one's own"
    settings: ClassVar = (Setting("periods", 2, "over which the mean square is taken", 1, 50),)

    def estimate(self, recorded: Recorded) -> DampingEstimate:
        """The mean over the whole free vibration."""
        free = recorded.free_vibration
        length = max(1, round(self.values["periods"] * free.period))
        count = free.values.size // length
        if count < 4:
            raise UnsuitedRecord("it holds fewer than four means of the energy: record longer")
        segments = free.values[: count * length].reshape(count, length)
        power = np.maximum(segments.var(axis=1) - free.noise**2, np.finfo(float).tiny)
        size = np.sqrt(2 * power)
        time = (np.arange(count) + 0.5) * length / free.sampling_rate
        rate = decay_rate(time, np.log(size), 1 / size)
        damped = (free.frequency_hz**2 - (rate.value / (2 * pi)) ** 2) ** 0.5
        return estimate_of(rate, damped, (float(size.max()), float(size.min())))
