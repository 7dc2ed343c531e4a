"""What a random load leaves in residuals: an oscillator that is pushed at random, behind the noise of a sensor.

Beside its start the motion y that a white load adds obeys y_t = a_t y_(t-1) + b_t y_(t-2) + u_t, where u hangs together
over two samples; a and b vary with what holds the oscillator. The residual is y and white noise. Its innovations are
those of a Kalman filter; they are found here from the Cholesky factor of a covariance that has two bands.
"""

from dataclasses import dataclass
from math import ceil, exp, log, log2

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky_banded, expm, solve_banded
from scipy.optimize import minimize_scalar

Array = NDArray[np.float64]
MEMORY = 2  # samples that the next one follows from
LOWEST, HIGHEST = -14.0, 14.0  # logarithm of the load's part of a sample's variance over the sensor's
SINGULAR = 1e-9  # of the product of two samples' sizes: of solutions that are no longer told apart


@dataclass(frozen=True)
class Recurrence:
    """How the free motion goes on from sample to sample, and how a white load drives it.

    Args:
        first: a_t, (time - 2,).
        second: b_t, (time - 2,).
        correlation: Of u from sample to sample.
    """

    first: Array
    second: Array
    correlation: float

    def left(self, rows: Array) -> Array:
        """What does not follow from the two samples before, (time - 2, n)."""
        return rows[2:] - self.first[:, None] * rows[1:-1] - self.second[:, None] * rows[:-2]


@dataclass(frozen=True)
class LoadNoise:
    """The random part of one record's residual.

    Args:
        motion: Of the oscillator.
        ratio: Variance of u over that of the sensor's noise.
        sensor: Variance of the sensor's noise.
        deviance: Minus twice the logarithm of its likelihood, but for a constant.
    """

    motion: Recurrence
    ratio: float
    sensor: float
    deviance: float

    @property
    def samples(self) -> int:
        """Of the record."""
        return len(self.motion.first) + MEMORY

    def innovations(self, rows: Array) -> Array:
        """Rows (time, n) of residuals made white, of unit variance; the first two samples are 0."""
        found = np.zeros_like(rows)
        factor = _factor(self.motion, self.ratio)
        found[2:] = solve_banded((MEMORY, 0), factor, self.motion.left(rows)) / self.sensor**0.5
        return found


def recurrence(columns: Array) -> tuple[Array, Array]:
    """A and b from two solutions of the free motion, (time, 2): what both follow."""
    now, before, after = columns[1:-1], columns[:-2], columns[2:]
    determinant = now[:, 0] * before[:, 1] - now[:, 1] * before[:, 0]
    size = np.linalg.norm(now, axis=1) * np.linalg.norm(before, axis=1)
    told = np.abs(determinant) > SINGULAR * np.maximum(size, 1e-300)
    determinant = np.where(told, determinant, 1.0)
    first = (after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0]) / determinant
    second = (now[:, 0] * after[:, 1] - now[:, 1] * after[:, 0]) / determinant
    return np.where(told, first, 0.0), np.where(told, second, 0.0)


def drive_correlation(mass: float, damping: float, stiffness: float, interval: float, derivatives: int) -> float:
    """Correlation of u from sample to sample where a white load drives the oscillator that a model is on average.

    Args:
        mass: In kg.
        damping: In N s/m.
        stiffness: In N/m.
        interval: Between samples in s.
        derivatives: Of the displacement that the channel shows: 0, 1 or 2.
    """
    rates = np.array([[0.0, 1.0], [-stiffness / mass, -damping / mass]])
    step, noise = _step_and_noise(rates, interval)
    shown = (np.array([1.0, 0.0]), np.array([0.0, 1.0]), rates[1])[derivatives]
    late = shown @ (step - np.trace(step) * np.eye(2))
    variance = float(shown @ noise @ shown + late @ noise @ late)
    return float(late @ noise @ shown) / max(variance, 1e-300)


def _step_and_noise(rates: Array, interval: float) -> tuple[Array, Array]:
    """What becomes of a state in an interval, and the covariance that a white force adds.

    By van Loan (1978, IEEE Trans. Automatic Control 23) for a part in which nothing has died away, then doubled.
    """
    doublings = max(0, ceil(log2(max(float(np.abs(rates).sum(1).max()) * interval, 1.0))))
    block = np.zeros((4, 4))
    block[:2, :2], block[:2, 2:], block[2:, 2:] = -rates, np.diag([0.0, 1.0]), rates.T
    found = expm(block * (interval / 2**doublings))
    step = found[2:, 2:].T
    noise = step @ found[:2, 2:]
    for _ in range(doublings):
        step, noise = step @ step, noise + step @ noise @ step.T
    return step, noise


def load_noise(residual: Array, motion: Recurrence) -> LoadNoise:
    """The random part of one record's residual (time,), by the likelihood of its innovations."""
    left = motion.left(residual[:, None])

    def deviance(logarithm: float) -> float:
        return _deviance(left, motion, exp(logarithm))[0]

    found = minimize_scalar(deviance, bounds=(LOWEST, HIGHEST), method="bounded")
    ratio = exp(float(found.x))
    value, sensor = _deviance(left, motion, ratio)
    return LoadNoise(motion, ratio, sensor, value)


def _deviance(left: Array, motion: Recurrence, ratio: float) -> tuple[float, float]:
    """Minus twice the logarithm of the likelihood at the best level, and that level."""
    factor = _factor(motion, ratio)
    white = solve_banded((MEMORY, 0), factor, left)[:, 0]
    level = max(float(white @ white) / len(white), 1e-300)
    return len(white) * log(level) + 2 * float(np.log(factor[0]).sum()), level


def _factor(motion: Recurrence, ratio: float) -> Array:
    """The lower Cholesky factor of the covariance of `Recurrence.left`, by bands, at a unit sensor."""
    a, b = motion.first, motion.second
    bands = np.zeros((MEMORY + 1, len(a)))
    bands[0] = 1 + a**2 + b**2 + ratio
    bands[1, :-1] = -a[1:] + a[:-1] * b[1:] + ratio * motion.correlation
    bands[2, :-2] = -b[2:]
    return cholesky_banded(bands, lower=True, check_finite=False)
