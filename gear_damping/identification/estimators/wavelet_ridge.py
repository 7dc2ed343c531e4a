"""Amplitude-dependent damping and the backbone from the ridge of the Morlet transform."""

from dataclasses import dataclass, replace
from math import log, pi
from typing import ClassVar

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.stats import norm

from gear_damping.identification.damping_estimate import DampingCurve, DampingEstimate, UnsuitedRecord
from gear_damping.identification.decay_rate import LEVEL, decay_rate, estimate_of, ratio_percent
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.identification.free_vibration import BAND, FreeVibration, tone_size
from gear_damping.setting import Setting
from gear_damping.signals.wavelets.morlet import MorletCWT

Array = NDArray[np.float64]

SCALES_PER_WIDTH = 5.0  # of the wavelet's band: the ridge is interpolated between them
STEPS_PER_SCALE = 2.0  # at which the ridge is read; what is closer tells the same
REACH = 4.0  # scales: a wavelet is nothing beyond
ABOVE_NOISE = 4.0  # standard deviations that an amplitude must have to count
MOST = 15.0  # % of critical damping: a record is continued beyond its ends with 16 % at most
CLOSER = 0.7  # of the fall, over which a slope that is right is the same
FEWEST = 8  # places on the ridge, for the cubic about one of them
POINTS = 100  # of a curve, at most


@dataclass(frozen=True, eq=False)
class Ridge:
    """Where the transform is largest at each time.

    Args:
        time: (n,) in s.
        log_amplitude: (n,).
        frequency_hz: (n,).
        deviation: (n,) standard deviation of the logarithm by noise.
        scale: Length of the wavelet in s.
    """

    time: Array
    log_amplitude: Array
    frequency_hz: Array
    deviation: Array
    scale: float

    def covariance(self, places: slice) -> Array:
        """Of the logarithms by noise: wavelets that overlap share it."""
        apart = np.subtract.outer(self.time[places], self.time[places]) / self.scale
        return np.exp(-(apart**2) / 4) * np.outer(self.deviation[places], self.deviation[places])


class WaveletRidge(RecordEstimator):
    """The decay rate of the ridge's amplitude, about every amplitude by a cubic over a part of the fall.

    A wavelet sees a mean over its length, which changes the slope of a bent fall: with ln A its decay rate is d,
    ln A_w = ln A + s^2 (d^2 - d') / 2, so d = d_w + s^2 (d d' - d'' / 2) to second order in the length s.
    """

    name = "wavelet_ridge"
    reference = "Staszewski (1997), J. Sound Vib. 203(2); the correction follows from the Gaussian"
    settings: ClassVar = (
        Setting("omega0", 6.0, "oscillations of the wavelet", 5, 100),
        Setting("fall", 0.5, "of ln(amplitude) on either side, over which a slope is fitted", 0.05, 5),
    )

    def estimate(self, recorded: Recorded) -> DampingEstimate:
        """Mean and curve over all that stands out of the noise."""
        free = recorded.free_vibration
        free.refuse_beyond(MOST)
        ridge = self._ridge(free)
        if ridge.time.size < FEWEST:
            raise UnsuitedRecord("too little of the ridge stands out of the noise: record a longer ring-down")
        inner = _within(ridge)
        rate = decay_rate(inner.time, inner.log_amplitude, inner.deviation)
        size = np.exp(ridge.log_amplitude)
        weights = 1 / inner.deviation**2
        frequency = float(weights @ inner.frequency_hz / weights.sum())
        frequency *= self._beside_fall(np.array([rate.value]), frequency)[0]
        whole = estimate_of(rate, frequency, (float(size.max()), float(size.min())))
        return replace(whole, curve=self._curve(ridge))

    def _ridge(self, free: FreeVibration) -> Ridge:
        """The ridge as far as it is the same vibration and stands out of the noise."""
        omega0 = self.values["omega0"]
        count = 1 + int(np.ceil(SCALES_PER_WIDTH * omega0 * 2**0.5 * log(BAND[1] / BAND[0])))
        frequencies = np.geomspace(*(edge * free.frequency_hz for edge in BAND), count)
        frequencies = frequencies[frequencies < free.sampling_rate / 2]
        wavelet = MorletCWT(free.sampling_rate, frequencies_hz=frequencies.tolist(), omega0=omega0)
        scales = np.asarray(wavelet.scales)
        more = int(np.ceil(REACH * scales.max()))
        values = torch.as_tensor(free.continued(more)).unsqueeze(0)
        step = max(1, round(float(np.median(scales)) / STEPS_PER_SCALE))
        places = np.arange(more, more + free.values.size, step)
        tone = tone_size(wavelet, wavelet.peak_number)  # over it, a tone is largest where s w is that number
        size = wavelet(values)[0].abs().numpy()[:, places] / tone[:, None]
        log_size, scale_place = _peaks(np.log(np.maximum(size, np.finfo(float).tiny)))
        at_peak = np.log(frequencies * wavelet.peak_number / wavelet.ridge_number)
        frequency = np.exp(np.interp(scale_place, np.arange(frequencies.size), at_peak))
        tone = np.interp(scale_place, np.arange(frequencies.size), tone)
        deviation = free.noise / (2**0.5 * tone * np.exp(log_size))
        inside = (deviation < 1 / ABOVE_NOISE) & (scale_place > 0) & (scale_place < frequencies.size - 1)
        lost = np.flatnonzero(~inside)
        inside[lost[0] if lost.size else inside.size :] = False
        length = float(np.median(wavelet.peak_number / (2 * pi * frequency[inside]))) if inside.any() else 0.0
        time = (places - more) / free.sampling_rate
        return Ridge(time[inside], log_size[inside], frequency[inside], deviation[inside], length)

    def _curve(self, ridge: Ridge) -> DampingCurve:
        """The damping ratio about every place of the ridge, the largest amplitude first."""
        places = np.unique(np.linspace(0, ridge.time.size - 1, min(POINTS, ridge.time.size)).astype(int))
        rates, errors = np.array([self._rate_at(ridge, place) for place in places]).T
        order = np.argsort(-ridge.log_amplitude[places], kind="stable")
        places, rates, errors = places[order], rates[order], errors[order]
        frequency = ridge.frequency_hz[places] * self._beside_fall(rates, ridge.frequency_hz[places])
        half = float(norm.ppf((1 + LEVEL) / 2)) * errors
        return DampingCurve(
            np.exp(ridge.log_amplitude[places]),
            ratio_percent(rates, frequency),
            np.stack([ratio_percent(rates + side * half, frequency) for side in (-1, 1)], axis=1),
            frequency,
        )

    def _beside_fall(self, rates: Array, frequency_hz: Array | float) -> Array:
        """The frequency over that of the scale where the transform is largest, of a vibration that dies away.

        Of exp((i w - d) t) the modulus is largest where x = s w obeys x - w0 = 1 / (2 x) + x d^2 / w^2; the frequency
        was read as if it did not die away.
        """
        omega0, kept = self.values["omega0"], 1 - (rates / (2 * pi * frequency_hz)) ** 2
        steady = omega0 + (omega0**2 + 2) ** 0.5
        return (omega0 + np.sqrt(omega0**2 + 2 * kept)) / (kept * steady)

    def _rate_at(self, ridge: Ridge, place: int) -> tuple[float, float]:
        """The decay rate about one place, with its standard error.

        What a slope over less of the fall differs by, beyond noise, is how far the fall is no cubic (as Hausman tests).
        """
        rate, variance = _slope(ridge, place, _window(ridge, place, self.values["fall"]))
        other, larger = _slope(ridge, place, _window(ridge, place, CLOSER * self.values["fall"]))
        bent = max((rate - other) ** 2 - max(larger - variance, 0.0), 0.0)
        return rate, (variance + bent) ** 0.5


def _within(ridge: Ridge) -> Ridge:
    """Without a scale at either end, where the transform sees how the record is continued; as it is where short."""
    kept = (ridge.time >= ridge.time[0] + ridge.scale) & (ridge.time <= ridge.time[-1] - ridge.scale)
    if kept.sum() < FEWEST:
        return ridge
    series = (ridge.time, ridge.log_amplitude, ridge.frequency_hz, ridge.deviation)
    return Ridge(*(values[kept] for values in series), ridge.scale)


def _slope(ridge: Ridge, place: int, window: slice) -> tuple[float, float]:
    """The decay rate about one place by a cubic over a window, with its variance."""
    time, value = ridge.time[window] - ridge.time[place], ridge.log_amplitude[window]
    degree = 3 if value.size >= FEWEST else 1
    basis = np.stack([time**k for k in range(degree + 1)], axis=1)
    solve = np.linalg.pinv(basis)
    found, covariance = solve @ value, ridge.covariance(window)
    left, noise = value - basis @ found, solve @ covariance
    expected = float(np.trace(covariance) - np.trace(basis @ noise))  # of squares beside the cubic, by noise alone
    excess = max(1.0, float(left @ left) / max(expected, np.finfo(float).tiny))
    rate, variance = -found[1], float(noise[1] @ solve[1]) * excess
    if degree == 3:
        bent = ridge.scale**2 * (rate * -2 * found[2] - -6 * found[3] / 2)
        rate, variance = rate + bent, variance + (bent**2 / rate) ** 2  # the next order is as its square
    return float(rate), float(variance)


def _window(ridge: Ridge, place: int, fall: float) -> slice:
    """The places about one, as far as the amplitude is within a fall (nepers), and eight at least."""
    near = np.abs(ridge.log_amplitude - ridge.log_amplitude[place]) <= fall
    far = np.flatnonzero(~near)
    first = int(far[far < place].max(initial=-1)) + 1
    last = int(far[far > place].min(initial=near.size))
    missing = FEWEST - (last - first)
    if missing > 0:
        first = max(0, min(first - missing // 2, near.size - FEWEST))
        last = min(near.size, first + FEWEST)
    return slice(first, last)


def _peaks(values: Array) -> tuple[Array, Array]:
    """Height and place of the maximum of each column, (scale, time), between scales by a parabola."""
    place = np.clip(values.argmax(0), 1, values.shape[0] - 2)
    before, middle, after = (values[place + shift, np.arange(values.shape[1])] for shift in (-1, 0, 1))
    bend = before - 2 * middle + after
    shift = np.clip(np.where(bend < 0, (before - after) / np.where(bend < 0, 2 * bend, 1.0), 0.0), -1, 1)
    return middle - (before - after) * shift / 4, place + shift
