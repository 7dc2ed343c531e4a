"""How records are predicted to move: deflection and rate, whatever their channel shows."""

import numpy as np
from numpy.typing import NDArray

from gear_damping.explanation.model.hypothesis import Outcome
from gear_damping.identification.output_error.first_guess import participation
from gear_damping.identification.output_error.records import FitRecord

Array = NDArray[np.float64]


def motions(outcome: Outcome) -> list[tuple[Array, Array]]:
    """Deflection and its rate by record, in units of their root mean square over all: a law is one in all records.

    The deflection is counted from rest without load; a stiffness that changes acts on its mean too. Where a channel
    does not tell the mean, it is that under the mean load.
    """
    problem, found = outcome.problem, []
    weights, channels = problem.response.weights.clamp(min=1e-300), problem.response.channels
    shown = problem.response.values - outcome.fitted.prediction.residual[0] / weights
    for record, one, static in zip(problem.records, shown, problem.static, strict=True):
        first = one.unflatten(0, (len(channels), -1))[channels.index(record.observed.name), : len(record.response)]
        place, rate = _motion(first.numpy(), record)
        if record.observed.derivatives or record.observed.offset:
            share = participation(record.observed, problem.model, problem.given)
            place = place - place.mean() + float(static) * share
        found.append((place, rate))
    scales = [float(np.sqrt(np.mean([np.mean(one[part] ** 2) for one in found]))) or 1.0 for part in (0, 1)]
    return [(place / scales[0], rate / scales[1]) for place, rate in found]


def _motion(shown: Array, record: FitRecord) -> tuple[Array, Array]:
    """Displacement, but for an offset, and rate, from a derivative of the displacement."""
    order, step = record.observed.derivatives, 1 / record.sampling_rate
    if order == 0:
        return shown, np.gradient(shown) / step
    if order == 1:
        return step * _summed(shown - shown.mean()), shown - shown.mean()
    rate = step * _summed(shown - shown.mean())
    return step * _summed(rate), rate


def _summed(values: Array) -> Array:
    """The integral without the drift that an offset leaves."""
    total = np.cumsum(values)
    slope = np.polynomial.polynomial.polyfit(np.linspace(-1, 1, len(total)), total, 1)
    return total - np.polynomial.polynomial.polyval(np.linspace(-1, 1, len(total)), slope)
