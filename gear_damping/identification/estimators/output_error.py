"""The linear oscillator fitted to a record by output error."""

import numpy as np

from gear_damping.identification.damping_estimate import DampingEstimate, UnsuitedRecord
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.identification.oscillator import fit_oscillator


class OutputError(RecordEstimator):
    """The simulation whose response lies nearest, with stiffness, damping, start and offsets free.

    The interval is that of the fit, widened where its residuals are correlated. Records of an oscillator may be driven
    by anything that was measured; a gear pair is `task=identify` without an estimator, which fits all its records.
    """

    name = "output_error"
    reference = "Ljung, System Identification, section 3.2"

    def estimate(self, recorded: Recorded) -> DampingEstimate:
        """By a fit to this record alone."""
        if recorded.system != "oscillator":
            raise UnsuitedRecord("this fit is for oscillators: task=identify without a model fits gear pairs")
        found = fit_oscillator([recorded.record], known=recorded.known)
        ratio, frequency = found.damping_ratio_percent, found.natural_frequency_hz
        if ratio is None or frequency is None:
            raise UnsuitedRecord("it was fitted without a spring, and then nothing is critical")
        damped = frequency.value * max(1 - (ratio.value / 100) ** 2, 0.0) ** 0.5
        seen = found.predictions[recorded.record.name].numpy()
        period = max(1, round(recorded.record.sampling_rate / max(damped, np.finfo(float).tiny)))
        about = np.abs(seen - np.median(seen))
        ends = float(about.max()), float(about[-period:].max())
        return DampingEstimate(ratio.value, ratio.interval95, damped, ends)
