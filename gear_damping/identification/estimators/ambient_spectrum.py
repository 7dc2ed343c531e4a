"""The spectrum of a motion under a random load that nobody measured."""

from dataclasses import dataclass, replace
from math import pi
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.stats import chi2, norm

from gear_damping.identification.damping_estimate import DampingEstimate, UnsuitedRecord
from gear_damping.identification.decay_rate import LEVEL
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.identification.free_vibration import at_even_instants, refuse_coarse, strongest
from gear_damping.physics.systems.traits import Trait
from gear_damping.setting import Setting

Array = NDArray[np.float64]

STARTS = (0.003, 0.02, 0.1)  # damping ratios that a fit begins with
MOST, LEAST = 0.5, 1e-6  # damping ratios: beyond, no resonance is seen; below, the line of a shaft is as narrow
BROADEST = 0.25  # damping ratio above which a resonance is as broad as the band
FEWEST_LINES = 20  # of a spectrum, to tell four figures from
FEWEST_MEMORIES = 5.0  # times in which the motion forgets itself, that a record must hold
SCATTERED = 0.5  # variance of the periodogram over its mean: 1 of a random motion, next to 0 of a ring-down
RARE = 1e-4  # probability that the largest of all lines is as large by chance: more is the line of something that turns
MOST_GROUPS, FEWEST_IN_GROUP, FIGURES = 16, 8, 4  # of lines that are averaged; lines in one; what was fitted to them
LEAKED = 2  # lines to either side of a strong one, that it is seen in
FAR, NEAR = 25.0, 0.3  # of a logarithm, that a level may be from its start, and a frequency
STEP = 1e-4  # of the logarithm of a parameter, for the slope of the spectrum


class AmbientSpectrum(RecordEstimator):
    """The resonance in the spectrum of a long record under a load that is white about it, by Whittle's likelihood.

    The expected periodogram of so many samples is worked out from the covariance of the motion, leakage and aliasing
    included (the debiased likelihood); background noise is free. A ring-down is none of its records.
    """

    name = "ambient_spectrum"
    reference = "Sykulski et al. (2019), Biometrika 106(2); covariances of the oscillator: closed form"
    of_ring_downs = False
    settings: ClassVar = (Setting("band", 1.6, "ends of the fitted lines over the frequency, and below it", 1.1, 4),)

    def estimate(self, recorded: Recorded) -> DampingEstimate:
        """One figure for the whole record."""
        record = recorded.record
        if not recorded.system.has(Trait.REST):
            raise UnsuitedRecord("it is for oscillators: what turns drives a gear pair")
        if any(float(series.max()) > float(series.min()) for series in record.inputs.values()):
            raise UnsuitedRecord("it is driven by a measured input, which output_error makes use of")
        values, rate = at_even_instants(record), record.sampling_rate
        values = values - values.mean()
        frequency = strongest(values, rate)
        refuse_coarse(frequency, rate)
        power = np.abs(np.fft.rfft(values)) ** 2 / values.size
        lines = np.fft.rfftfreq(values.size, 1 / rate)
        inside = (lines > frequency / self.values["band"]) & (lines < frequency * self.values["band"])
        spectrum = _Spectrum(power[inside], inside, values.size, rate, record.observed.derivatives)
        if spectrum.power.size < FEWEST_LINES:
            raise UnsuitedRecord(f"{spectrum.power.size} lines of its spectrum show the resonance: record longer")
        _refuse_line(spectrum, frequency)
        point = spectrum.best(frequency)
        found, natural = float(np.exp(point[1])), float(np.exp(point[2]))
        self._refuse(spectrum, point, values.size / rate)
        half = float(norm.ppf((1 + LEVEL) / 2)) * spectrum.deviation(point)
        ends = (100 * found * np.exp(-half), 100 * found * np.exp(half))
        size = float(np.abs(values).max()), float(2**0.5 * values.std())
        return DampingEstimate(100 * found, ends, natural * (1 - found**2) ** 0.5, size)

    def _refuse(self, spectrum: "_Spectrum", point: Array, seconds: float) -> None:
        """Refuse what no steady random load has made.

        Raises:
            UnsuitedRecord: it is a ring-down, too broad, or too short.
        """
        ratio = spectrum.power / spectrum.expected(point)[spectrum.inside]
        found, natural = np.exp(point[1:3])
        if ratio.var() < SCATTERED:
            raise UnsuitedRecord("its spectrum is as smooth as that of a ring-down, which the other estimators are for")
        if _is_another_shape(ratio):
            raise UnsuitedRecord(
                "its spectrum has another shape than that of one mode under a white load, as of two that are near each "
                "other: filter one out, or take a narrower band (model.band)"
            )
        if found > BROADEST:
            raise UnsuitedRecord("what swings most in it is too broad to be told from the load that makes it")
        memories = seconds * 2 * pi * natural * found
        if memories < FEWEST_MEMORIES:
            raise UnsuitedRecord(
                f"it holds {memories:.2g} of the times in which its motion forgets itself, and {FEWEST_MEMORIES:g} are "
                "needed: record longer"
            )


def _refuse_line(spectrum: "_Spectrum", frequency: float) -> None:
    """Refuse the line of something that turns: the strongest one, held against what the others say of it.

    Raises:
        UnsuitedRecord: there is one.
    """
    top = int(np.argmax(spectrum.power))
    others = spectrum.without(top)
    expected = others.expected(others.best(frequency))[spectrum.inside]
    if spectrum.power[top] > expected[top] * np.log(expected.size / RARE):
        line = np.flatnonzero(spectrum.inside)[top] * spectrum.rate / spectrum.samples
        raise UnsuitedRecord(f"a line at {line:.4g} Hz stands in its resonance, which no random load makes")


def _is_another_shape(ratio: Array) -> bool:
    """Whether lines over their expectation, (lines,), are not about one all along the band.

    Means of groups of lines scatter by one over the root of their number: a chi-squared test.
    """
    groups = np.array_split(ratio, min(MOST_GROUPS, ratio.size // FEWEST_IN_GROUP))
    if len(groups) <= FIGURES:
        return False
    statistic = sum(group.size * (group.mean() - 1) ** 2 for group in groups)
    return bool(chi2.sf(statistic, len(groups) - FIGURES) < RARE)


@dataclass(frozen=True, eq=False)
class _Spectrum:
    """Lines of a periodogram about a resonance; a point is the logarithms of variance, ratio, frequency and noise.

    Args:
        power: (lines,) inside the band.
        inside: (all lines,) which those are.
        samples: Of the record.
        rate: Hz.
        derivatives: How often the motion was differentiated: 0, 1 or 2.
    """

    power: Array
    inside: NDArray[np.bool_]
    samples: int
    rate: float
    derivatives: int

    def without(self, place: int) -> "_Spectrum":
        """The same without one of its lines and those beside it, to which it leaks."""
        kept = np.abs(np.arange(self.power.size) - place) > LEAKED
        inside = self.inside.copy()
        inside[np.flatnonzero(self.inside)[~kept]] = False
        return replace(self, power=self.power[kept], inside=inside)

    def best(self, frequency: float) -> Array:
        """The point of largest likelihood."""
        return min((self.fitted(ratio, frequency) for ratio in STARTS), key=self.cost)

    def fitted(self, ratio: float, frequency: float) -> Array:
        """The point of largest likelihood that is reached from a ratio."""
        level = float(self.power.mean())
        start = np.log([level * ratio, ratio, frequency, 1e-2 * level])
        ends = tuple(np.log([LEAST, MOST]))
        reaches = [(start[0], FAR), (start[2], NEAR), (start[3], FAR)]
        scale, place, floor = ((one - reach, one + reach) for one, reach in reaches)
        bounds = [scale, ends, place, floor]
        return minimize(self.cost, start, method="L-BFGS-B", bounds=bounds).x

    def cost(self, point: Array) -> float:
        """Minus the logarithm of Whittle's likelihood."""
        expected = self.expected(point)[self.inside]
        return float(np.sum(np.log(expected) + self.power / expected))

    def expected(self, point: Array) -> Array:
        """The mean of the periodogram of so many samples, (all lines,)."""
        variance, ratio, frequency, noise = np.exp(point)
        lags = np.arange(self.samples)
        covariance = variance * self._correlation(lags / self.rate, ratio, 2 * pi * frequency)
        triangle = covariance * (1 - lags / self.samples)
        mean = 2 * np.fft.rfft(triangle).real - covariance[0] + noise
        return np.maximum(mean, 1e-12 * noise + np.finfo(float).tiny)

    def _correlation(self, time: Array, ratio: float, omega: float) -> Array:
        """Of displacement, velocity, or what is not white of an acceleration, of an oscillator under a white force.

        Of omega^4 |H|^2 = 1 + (2 (1 - 2 zeta^2) omega_0^2 omega^2 - omega_0^4) |H|^2 the 1 is white.
        """
        skew = ratio / (1 - ratio**2) ** 0.5
        cosine, sine = {0: (1.0, skew), 1: (1.0, -skew), 2: (1 - 4 * ratio**2, -(3 - 4 * ratio**2) * skew)}[
            self.derivatives
        ]
        turn = omega * (1 - ratio**2) ** 0.5 * time
        return np.exp(-ratio * omega * time) * (cosine * np.cos(turn) + sine * np.sin(turn))

    def deviation(self, point: Array) -> float:
        """Standard deviation of the logarithm of the ratio: lines scatter independently, each by its mean."""
        steps = STEP * np.eye(point.size)
        slopes = [np.log(self.expected(point + step) / self.expected(point - step)) / (2 * STEP) for step in steps]
        columns = np.stack(slopes, axis=1)[self.inside]
        return float(np.linalg.pinv(columns.T @ columns)[1, 1] ** 0.5)
