"""What an estimator says of the damping of a record: one ratio with its interval, and the ratio against amplitude."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


class UnsuitedRecord(ValueError):
    """An estimator cannot say anything of this record; the message gives the reason, and what would suit."""


AMBIENT = "of a long motion under a random load ambient_spectrum tells the damping"  # what suits, beside the force


class UndyingMotion(UnsuitedRecord):
    """What swings most in this record does not die away: no ring-down."""


@dataclass(frozen=True, eq=False)
class DampingCurve:
    """The damping ratio against the amplitude of vibration, from the largest amplitude to the smallest.

    Args:
        amplitude: (n,) of the response, in its unit.
        damping_ratio_percent: (n,) in % of critical, equivalent viscous: the amplitude falls as a linear one would.
        interval95: (n, 2) of the ratio.
        frequency_hz: (n,) of the damped vibration.
    """

    amplitude: NDArray[np.float64]
    damping_ratio_percent: NDArray[np.float64]
    interval95: NDArray[np.float64]
    frequency_hz: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DampingEstimate:
    """The damping of one record.

    Args:
        damping_ratio_percent: In % of critical.
        interval95: Of it.
        frequency_hz: Of the damped vibration.
        amplitudes: Largest and smallest amplitude that it is a mean over, in the unit of the response.
        curve: Against amplitude, of estimators that tell it.
        doubt: Why the record is not what the estimator takes it for, and what suits it; "" where nothing says so.
    """

    damping_ratio_percent: float
    interval95: tuple[float, float]
    frequency_hz: float
    amplitudes: tuple[float, float]
    curve: DampingCurve | None = None
    doubt: str = ""
