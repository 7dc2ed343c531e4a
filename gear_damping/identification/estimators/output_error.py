"""The linear oscillator fitted to a record by output error."""

import numpy as np

from gear_damping.identification.damping_estimate import AMBIENT, DampingEstimate, UndyingMotion, UnsuitedRecord
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.identification.free_vibration import WAVELET_REACH, grows
from gear_damping.identification.oscillator.fit import fit_oscillator
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.output_error.segments import WHOLE, stretch
from gear_damping.physics.systems.traits import Trait

OVERDAMPED = 99.9  # % of critical, from which on nothing swings
ABOVE_NOISE = 3.0  # standard deviations of the residual that an amplitude must have to count
NOT_FOLLOWED = (
    "the nearest linear oscillator loses step with the record, and was begun anew in every segment: something that was "
    "not measured drives it, or its damping or stiffness changes much. Give its ring-down (by `slice`), or the "
    f"force; {AMBIENT}"
)


class OutputError(RecordEstimator):
    """The simulation whose response lies nearest, with stiffness, damping, start and offsets free.

    The interval is that of the fit, widened where its residuals are correlated. Records of an oscillator may be driven
    by anything that was measured; a gear pair is `task=identify` without an estimator, which fits all its records.
    """

    name = "output_error"
    reference = "Ljung, System Identification, section 3.2"

    def estimate(self, recorded: Recorded) -> DampingEstimate:
        """By a fit to this record alone."""
        if not recorded.system.has(Trait.REST):
            raise UnsuitedRecord("this fit is for oscillators: task=identify without a model fits gear pairs")
        if grows(recorded.record):
            raise UnsuitedRecord("its motion grows: something feeds it, and no damping is fitted to that")
        record, doubt = _as_long_as_it_swings(recorded)
        found = fit_oscillator([record], known=recorded.known)
        ratio, frequency = found.damping_ratio_percent, found.natural_frequency_hz
        if ratio is None or frequency is None:
            raise UnsuitedRecord("it was fitted without a spring, and then nothing is critical")
        if ratio.value >= OVERDAMPED:
            raise UnsuitedRecord("the nearest simulation does not swing: give a ring-down from its release on")
        damped = frequency.value * (1 - (ratio.value / 100) ** 2) ** 0.5
        seen = found.predictions[record.name].numpy()
        left = record.response.numpy()[: seen.size] - seen[: len(record.response)]
        period = min(seen.size, max(1, round(record.sampling_rate / damped)))
        about = np.abs(seen - np.median(seen))
        smallest = max(float(about[-period:].max()), ABOVE_NOISE * float(left.std()))
        doubt = NOT_FOLLOWED if found.segments != WHOLE else doubt
        return DampingEstimate(ratio.value, ratio.interval95, damped, (float(about.max()), smallest), doubt=doubt)


def _as_long_as_it_swings(recorded: Recorded) -> tuple[FitRecord, str]:
    """The record without what follows a ring-down, where a fit loses itself in noise, and why it may not be one.

    Without an input it begins where the ring-down does: what moved it before then was not measured. A ring-down that
    a wavelet sees begin in its own reach began with the record.
    """
    record = recorded.record
    try:
        free = recorded.free_vibration
    except UndyingMotion as found:
        return record, "" if record.inputs else str(found)
    except UnsuitedRecord:
        return record, ""
    is_late = not record.inputs and free.begins > 2 * WAVELET_REACH * free.period
    return stretch(record, slice(free.begins if is_late else 0, free.ends)), ""
