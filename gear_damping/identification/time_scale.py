"""The characteristic time of a motion: what segments, blocks, friction widths and natural units are measured in."""

from collections.abc import Sequence
from math import inf, pi

import numpy as np

from gear_damping.identification.output_error.records import FitRecord

MOST = 0.1  # of the longest record
DECORRELATED = 1 / np.e  # of the autocorrelation of the rate


def characteristic_time(records: Sequence[FitRecord], natural_frequency: float = 0.0, damping: float = 0.0) -> float:
    """Seconds: the natural period where a spring dominates, else a time constant, else the decorrelation of the rate.

    A spring that creeps back behind a strong damper does so in damping over stiffness; without a spring the rate dies
    away in one over the damping.

    Args:
        records: The records, of which a tenth of the longest is the limit.
        natural_frequency: Undamped, in rad/s; 0 without a spring.
        damping: Damping coefficient over mass, in 1/s.
    """
    limit = MOST * max(record.duration for record in records)
    if natural_frequency > damping / 2 and natural_frequency > 0:
        return min(2 * pi / natural_frequency, limit)
    if natural_frequency > 0:
        return min(damping / natural_frequency**2, limit)
    found = 1 / damping if damping > 0 else inf
    if found >= limit:
        found = max(decorrelation_time(record) for record in records)
    return min(found, limit)


def decorrelation_time(record: FitRecord) -> float:
    """Seconds after which the measured rate has forgotten itself."""
    values = record.response.numpy()
    rate = np.gradient(values) if record.observed.derivatives == 0 else values
    rate = rate - rate.mean()
    size = 1 << (2 * len(rate) - 1).bit_length()
    power = np.abs(np.fft.rfft(rate, size)) ** 2
    correlation = np.fft.irfft(power, size)[: len(rate)]
    below = np.flatnonzero(correlation < DECORRELATED * correlation[0])
    return float(below[0] if below.size else len(rate)) / record.sampling_rate
