"""The width of the resonance in the spectrum of a free decay, at half its power."""

from dataclasses import replace
from functools import cache
from math import pi
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from gear_damping.identification.damping_estimate import DampingEstimate, UnsuitedRecord
from gear_damping.identification.decay_rate import LEVEL, ratio_percent
from gear_damping.identification.estimators.base import Recorded, RecordEstimator
from gear_damping.identification.free_vibration import FreeVibration
from gear_damping.measurement.spectral_floor import spectrum_of
from gear_damping.setting import Setting

Array = NDArray[np.float64]

LINES = 64  # of the refined spectrum on either side of the peak,
SPAN = 1.5  # times the width on either side, once the width is known
WIDEST = 50.0  # of the frequency: the first span, where no resolution is wider
CLOSER = 3  # times that the spectrum is refined
RESOLVED = 1.15  # times the width of a record that does not fall at all: less tells no damping
MOST = 20.0  # % of critical damping: beyond, the line at the negative frequency reaches into the width
BAND = (0.2, 0.5)  # of the frequency, on either side of it, between which the density of noise is taken
NEPERS = np.linspace(0.0, 50.0, 5001)  # over a record, for which the width is worked out; more is no vibration
SEED = 0  # of the noise that is drawn for the interval
FEWEST_TOLD = 0.9  # of the draws, in which the width must tell a damping


class HalfPower(RecordEstimator):
    """Damping from where the power is half of its peak.

    The spectrum of a record of finite length is wider than 2 zeta f: the width is compared with that of an exponential
    decay of the same length. The interval comes from decays with the noise of the record, drawn again and again.
    """

    name = "half_power"
    reference = "Inman, Engineering Vibration, section 7.4; width of a truncated decay: closed form"
    settings: ClassVar = (Setting("draws", 200, "of noise, for the interval", 20, 10000),)

    def estimate(self, recorded: Recorded) -> DampingEstimate:
        """One figure for the whole decay, which is mostly that of its beginning."""
        free = recorded.free_vibration
        free.refuse_beyond(MOST)
        found = self._of(free)
        return replace(found, doubt=self._doubt(found, free))

    def _of(self, free: FreeVibration) -> DampingEstimate:
        seconds = free.values.size / free.sampling_rate
        frequencies = _refined(free.values, free.sampling_rate, free.frequency_hz)
        tones = np.exp(-2j * pi * np.outer(frequencies, free.time))
        line = tones @ free.values
        nepers, frequency = float(_nepers(line, frequencies, seconds)), float(frequencies[np.argmax(np.abs(line))])
        if np.isnan(nepers):
            raise UnsuitedRecord(
                "the resonance is as narrow as the spectrum of so short a record is: half power needs a record over "
                "which the vibration falls to less than half"
            )
        decay = np.exp((-nepers / seconds + 2j * pi * frequency) * free.time)
        basis = np.stack([decay.real, decay.imag], axis=1)
        model = basis @ np.linalg.lstsq(basis, free.values, rcond=None)[0]
        left = free.values - model  # what is no such decay counts as noise
        deviation = max(float(np.std(left)), free.noise, _beside(left, free))
        low, high = self._quantiles(deviation * tones, tones @ model, frequencies, seconds)
        rates = np.array([nepers, nepers - (high - nepers), nepers - (low - nepers)]) / seconds  # the basic bootstrap
        value, lower, upper = (float(one) for one in ratio_percent(rates, frequency))
        size = float(np.abs(model).max())
        return DampingEstimate(value, (lower, upper), frequency, (size, size * float(np.exp(-nepers))))

    def _doubt(self, whole: DampingEstimate, free: FreeVibration) -> str:
        """Whether the later half of the decay, where it swings less, has another width: then no exponential is there.

        A frequency that moves with the amplitude widens the line as damping does.
        """
        later = replace(free, values=free.values[free.values.size // 2 :])
        try:
            found = self._of(later)
        except UnsuitedRecord:
            return ""
        apart = max(whole.interval95[0] - found.interval95[1], found.interval95[0] - whole.interval95[1])
        if apart <= 0:
            return ""
        return (
            f"the later half of the decay has a damping ratio of {found.damping_ratio_percent:.3g} % by its own "
            f"width, not {whole.damping_ratio_percent:.3g} %: frequency or damping changes with the amplitude, and "
            "widens the line by that; wavelet_ridge tells both against the amplitude"
        )

    def _quantiles(self, noise: Array, line: Array, frequencies: Array, seconds: float) -> tuple[float, float]:
        """Of the fall in nepers, over draws of white noise through the spectrum.

        Raises:
            UnsuitedRecord: noise often hides the width.
        """
        draws = np.random.default_rng(SEED).standard_normal((int(self.values["draws"]), noise.shape[1]))
        drawn = np.array([_nepers(line + noise @ draw, frequencies, seconds) for draw in draws])
        drawn = drawn[np.isfinite(drawn)]
        if drawn.size < FEWEST_TOLD * len(draws):
            raise UnsuitedRecord("noise hides where the power is half of its peak: record with less of it, or longer")
        low, high = np.quantile(drawn, [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
        return float(low), float(high)


def _beside(left: Array, free: FreeVibration) -> float:
    """Standard deviation of white noise as dense as what is left beside the resonance; 0 of too short a record.

    At the resonance itself lies what is no such decay, as of a frequency that moves.
    """
    spectrum = spectrum_of(left, free.sampling_rate)
    if spectrum is None:
        return 0.0
    apart = np.abs(spectrum.frequency / free.frequency_hz - 1)
    beside = (apart > BAND[0]) & (apart < BAND[1])
    return float((np.median(spectrum.density[beside]) * free.sampling_rate / 2) ** 0.5) if beside.any() else 0.0


def _refined(values: Array, rate: float, guess: float) -> Array:
    """Frequencies about the peak, in Hz, as close as its width asks for."""
    time = np.arange(values.size) / rate
    span = max(3 * rate / values.size, guess / WIDEST)
    for _ in range(CLOSER):
        frequencies = np.linspace(guess - span, guess + span, 2 * LINES + 1)
        power = np.abs(np.exp(-2j * pi * np.outer(frequencies, time)) @ values) ** 2
        guess, width = float(frequencies[np.argmax(power)]), _width(frequencies, power)
        span = SPAN * (width if np.isfinite(width) else span)
    return np.linspace(guess - span, guess + span, 2 * LINES + 1)


def _nepers(line: Array, frequencies: Array, seconds: float) -> float:
    """By how many nepers a vibration falls over its record; nan where its line is as narrow as the record allows."""
    width = _width(frequencies, np.abs(line) ** 2) * seconds
    widths = _truncated_widths()
    return float(np.interp(width, widths, NEPERS)) if RESOLVED * widths[0] <= width < widths[-1] else float("nan")


def _width(frequencies: Array, power: Array) -> float:
    """Distance of the places on either side of the peak where the power is half of it; inf where one is not seen."""
    top = int(np.argmax(power))
    half = power[top] / 2
    below, above = np.flatnonzero(power[:top] < half), np.flatnonzero(power[top:] < half)
    if not below.size or not above.size:
        return float("inf")
    left, right = int(below[-1]), top + int(above[0])
    first = np.interp(half, power[[left, left + 1]], frequencies[[left, left + 1]])
    return float(np.interp(half, power[[right, right - 1]], frequencies[[right, right - 1]]) - first)


@cache
def _truncated_widths() -> Array:
    """Widths at half power of decays by `NEPERS` over their length, in one over that length.

    |X|^2 is |1 - exp(-z)|^2 / |z|^2 with z = nepers + 2 pi i f. It falls from its peak on, so that halving the stretch
    in which it comes to half of that finds the width.
    """
    peak = np.where(NEPERS > 0, -np.expm1(-NEPERS) / np.where(NEPERS > 0, NEPERS, 1.0), 1.0) ** 2
    low, high = np.zeros_like(NEPERS), np.maximum(1.0, NEPERS)
    for _ in range(60):  # to rounding
        middle = (low + high) / 2
        z = NEPERS + 1j * pi * np.maximum(middle, np.finfo(float).tiny)
        is_above = np.abs(np.expm1(-z) / z) ** 2 > peak / 2
        low, high = np.where(is_above, middle, low), np.where(is_above, high, middle)
    return (low + high) / 2
