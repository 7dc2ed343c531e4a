"""What the error of a measured load leaves in residuals, where its colour and size are known.

A load that was measured with noise is known but for an error. Behind the oscillator that becomes a narrow random motion
about its natural frequency, on which the noise of the sensor lies. Its share, and the level and colour of the sensor,
are found from the spectrum of the residual (Whittle 1953); the Cholesky factor of both covariances makes it white.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from math import exp, log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.linalg import cholesky, solve_triangular, toeplitz
from scipy.optimize import minimize

from gear_damping.explanation.statistics.load_noise import MEMORY

Array = NDArray[np.float64]
LONGEST = 800  # samples of a segment whose covariance is factored at once: time goes with their square
PADDED = 8  # lengths of a record over which a motion that dies away slowly is followed
FINER = 4  # steps between two samples, from which a spline tells the covariance at any lag
SHARES = (0.1, 2.0)  # of the error that is expected: a fit takes a part of it, and its size is an estimate
SENSOR = (0.01, 100.0)  # of the variance that the spectrum of the response tells: a coloured sensor has another floor
POLES = (-0.9, 0.98)  # of the sensor's colour, from sample to sample
SIMPLEX = np.array([[0, 0, 0], [0.4, 0, 0], [0, -0.7, 0], [0, 0, 0.2]])  # about where the search begins
UNEVEN = 1e-3  # of a step between samples
TRIED, SHORT = 60, 400  # evaluations of the likelihood where samples are uneven, and samples that it is of
ROUNDING = 1e-9  # of the variance, on the diagonal


class Linear(NamedTuple):
    """The oscillator that a model is on average: kg, N s/m, N/m, and derivatives of its motion that are seen."""

    mass: float
    damping: float
    stiffness: float
    derivatives: int = 0


@dataclass(frozen=True)
class KnownError:
    """The error of a load as a residual sees it.

    Args:
        stamps: Instants of the samples in s, (time,).
        motion: Autocovariance of what it adds to them, by lags of `interval`, in the unit of the residual squared.
        interval: In s.
        sensor: Variance of the noise of the response as its spectrum tells it.
    """

    stamps: Array
    motion: Array
    interval: float
    sensor: float

    @property
    def is_uneven(self) -> bool:
        """Whether samples are not evenly spaced."""
        steps = np.diff(self.stamps)
        return bool(steps.max() - steps.min() > UNEVEN * steps.mean())

    @cached_property
    def covariances(self) -> tuple[Array, ...]:
        """Of what it adds to the samples of each segment, (n, n); the same for every residual and level."""
        lags = self.interval * np.arange(len(self.motion))
        told, found = CubicSpline(lags, self.motion), []
        for segment in _segments(len(self.stamps)):
            stamps = self.stamps[segment]
            found.append(told(np.minimum(np.abs(stamps[:, None] - stamps[None, :]), lags[-1])))
        return tuple(found)


class Levels(NamedTuple):
    """Share of the expected error, variance of the sensor's innovations, and the pole of its colour."""

    share: float
    sensor: float
    pole: float


@dataclass(frozen=True)
class LoadError:
    """The random part of one record's residual.

    Args:
        factors: Lower Cholesky factors of its covariance, segment by segment.
        level: Its variance over that.
        sensor: Variance of the sensor's part.
        deviance: Minus twice the logarithm of its likelihood without the first two samples, but for a constant.
    """

    factors: tuple[Array, ...] = field(repr=False)
    level: float
    sensor: float
    deviance: float

    @property
    def samples(self) -> int:
        """Of the record."""
        return sum(len(factor) for factor in self.factors)

    def innovations(self, rows: Array) -> Array:
        """Rows (time, n) of residuals made white, of unit variance."""
        return _white(rows, self.factors) / self.level**0.5


def load_error(residual: Array, known: KnownError) -> LoadError:
    """The random part of one record's residual (time,)."""
    levels = _levels(residual, known)
    if known.is_uneven:
        levels = _at_their_stamps(levels, residual, known)
    factors = tuple(cholesky(_both(moved, levels), lower=True) for moved in known.covariances)
    white = _white(residual[:, None], factors)[MEMORY:]
    level = max(float((white**2).mean()), 1e-300)
    log_diagonal = np.concatenate([np.log(np.diag(factor)) for factor in factors])[MEMORY:]
    sensor = level * levels.sensor / (1 - levels.pole**2)
    return LoadError(factors, level, sensor, len(white) * log(level) + 2 * float(log_diagonal.sum()))


def moved_by(error: Array, linear: Linear, interval: float) -> tuple[Array, float]:
    """Autocovariance of the motion that the error of a load adds, and the step of its lags in s.

    Args:
        error: Autocovariance (time,) of the load's error, in N^2, by lags of `interval`.
        linear: What it drives.
        interval: Between samples in s.
    """
    length = PADDED * len(error)
    both = np.concatenate([error, np.zeros(length - 2 * len(error) + 1), error[:0:-1]])
    density = np.fft.rfft(both).real.clip(min=0.0)
    rate = 2j * np.pi * np.fft.rfftfreq(length, interval)
    response = rate**linear.derivatives / (linear.mass * rate**2 + linear.damping * rate + linear.stiffness)
    seen = np.fft.irfft(np.abs(response) ** 2 * density, FINER * length) * FINER
    return seen[: FINER * len(error)], interval / FINER


def _levels(residual: Array, known: KnownError) -> Levels:
    """Where the likelihood of the residual's spectrum is largest, as if samples were even."""
    count = len(residual)
    window = np.hanning(count)
    seen = np.abs(np.fft.rfft(window * residual))[1:] ** 2 / float((window**2).sum())
    lags = known.motion[::FINER][:count]
    windowed = lags * np.correlate(window, window, "full")[count - 1 :] / float((window**2).sum())
    both = np.concatenate([windowed, windowed[:0:-1]])
    moved = np.fft.rfft(both).real[2::2].clip(min=0.0)
    turn = np.exp(-2j * np.pi * np.fft.rfftfreq(count)[1:])
    fewest = min(len(seen), len(moved))

    def of(place: Array) -> Levels:
        return Levels(exp(place[0]), exp(place[1]) * known.sensor, float(place[2]))

    def deviance(place: Array) -> float:
        levels = of(place)
        density = levels.share * moved[:fewest] + levels.sensor / np.abs(1 - levels.pole * turn[:fewest]) ** 2
        return float((np.log(density) + seen[:fewest] / density).sum())

    bounds = [tuple(map(log, SHARES)), tuple(map(log, SENSOR)), POLES]
    initial = [minimize(deviance, np.array([0.0, 0.0, pole]), bounds=bounds, method="L-BFGS-B") for pole in (0.0, 0.6)]
    return of(min(initial, key=lambda found: float(found.fun)).x)


def _at_their_stamps(levels: Levels, residual: Array, known: KnownError) -> Levels:
    """The levels where the likelihood of the first samples is largest, taken when they were taken.

    In a spectrum that takes uneven samples for even ones, what the jitter makes of the motion looks like the sensor.
    """
    moved = known.covariances[0][:SHORT, :SHORT]
    seen, largest = residual[: len(moved)], residual.var()

    def of(place: Array) -> Levels:
        share, sensor = np.clip(np.exp(place[:2]), *np.transpose((SHARES, SENSOR)))
        return Levels(float(share), float(sensor) * known.sensor, float(np.clip(place[2], *POLES)))

    def deviance(place: Array) -> float:
        factor = cholesky(_both(moved, of(place)), lower=True)
        white = solve_triangular(factor, seen, lower=True)
        return float(white @ white + 2 * np.log(np.diag(factor)).sum())

    if largest <= 0:
        return levels
    initial = np.array([log(levels.share), log(levels.sensor / known.sensor), levels.pole])
    options = {"maxfev": TRIED, "initial_simplex": initial + SIMPLEX}
    found = minimize(deviance, initial, method="Nelder-Mead", options=options)
    return of(found.x)


def _both(moved: Array, levels: Levels) -> Array:
    """Covariance of what the error of the load adds, of which that is expected, and of the sensor."""
    found = levels.share * moved + toeplitz(levels.sensor / (1 - levels.pole**2) * levels.pole ** np.arange(len(moved)))
    found[np.diag_indices(len(found))] += ROUNDING * levels.share * moved.diagonal()
    return found


def _white(rows: Array, factors: Sequence[Array]) -> Array:
    parts = zip(_segments(len(rows)), factors, strict=True)
    return np.concatenate([solve_triangular(f, rows[segment], lower=True, check_finite=False) for segment, f in parts])


def _segments(count: int) -> list[slice]:
    """Pieces of about equal lengths; that samples of two of them hang together does not count."""
    parts = max(1, -(-count // LONGEST))
    ends = [round(i * count / parts) for i in range(parts + 1)]
    return [slice(*pair) for pair in pairwise(ends)]
