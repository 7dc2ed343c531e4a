"""The power spectral density of a channel and the noise that its floor stands for."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FEWEST = 64  # samples; with fewer there is no floor to be seen
_LONGEST = 8192  # samples of a segment: more would resolve no floor and cost time
_AVERAGED = 4  # segments, at least, where the record is long enough
_NUTTALL = (0.3635819, -0.4891775, 0.1365995, -0.0106411)  # side lobes 98 dB down: what is strong hides no floor
_SKIPPED, _TOP = 4, 0.95  # lowest lines, which hold trends; share of the band below the anti-alias corner
_CHANCE = 0.01  # that the highest line of white noise counts as one
_QUANTILE, _DEVIATE = 0.2, -0.8416  # of the lines that count as floor; the normal deviate of that quantile


@dataclass(frozen=True, eq=False)
class Spectrum:
    """A one-sided power spectral density.

    Args:
        frequency: (m,) in Hz, or in cycles a sample where no rate is known.
        density: (m,) in the unit of the values squared over that of the frequency.
        averaged: Segments that were averaged.
        strongest: The frequency of the highest line of the whole record; None where that lasts as long as the record,
            as of what coasts down or drifts, and where white noise has one as high.
    """

    frequency: NDArray[np.float64]
    density: NDArray[np.float64]
    averaged: int
    strongest: float | None

    @property
    def floor(self) -> float:
        """The density of the quietest fifth of the band as white noise has it."""
        top = int(_TOP * self.density.size)
        quiet = float(np.quantile(self.density[_SKIPPED:top], _QUANTILE))
        ninth = 1 / (9 * self.averaged)  # Wilson & Hilferty (1931): what that quantile is of the mean
        return quiet / (1 - ninth + _DEVIATE * ninth**0.5) ** 3

    @property
    def noise(self) -> float:
        """Standard deviation of white noise with that floor, in the unit of the values."""
        return float((self.floor * self.frequency[-1]) ** 0.5)

    @property
    def centroid(self) -> float:
        """The mean frequency of the power."""
        return float(self.frequency @ self.density / max(self.density.sum(), np.finfo(float).tiny))


def spectrum_of(values: NDArray[np.float64], rate: float = 1.0) -> Spectrum | None:
    """The spectrum of a channel by Welch's method, without the trend of each segment.

    Args:
        values: (n,) finite samples at a constant rate.
        rate: In Hz; 1 where it is not known.

    Returns:
        None where there are too few samples.
    """
    n = values.size
    if n < FEWEST:
        return None
    length = min(_LONGEST, max(FEWEST // 2, 2 * (n // (_AVERAGED + 1))))
    segments = np.lib.stride_tricks.sliding_window_view(values, length)[:: length // 2]
    angle = 2 * np.pi * (np.arange(length) + 0.5) / length
    window = sum(weight * np.cos(k * angle) for k, weight in enumerate(_NUTTALL))
    place = np.linspace(-1.0, 1.0, length)
    centred = segments - segments.mean(axis=1, keepdims=True)
    level = centred - np.outer(centred @ place / (place @ place), place)
    power = np.abs(np.fft.rfft(level * window, axis=1)) ** 2
    density = 2 * power.mean(axis=0) / (rate * (window @ window))
    swings = _strongest(values)
    strongest = swings * rate / n if swings > 1 else None
    return Spectrum(np.fft.rfftfreq(length, 1 / rate), density, len(segments), strongest)


def _strongest(values: NDArray[np.float64]) -> float:
    """In periods of all the values, without the line through them; 0 where noise has as high a one (Fisher 1929).

    Between the lines by the parabola through the logarithms of the three highest: to a twentieth of their distance.
    """
    place = np.linspace(-1.0, 1.0, values.size)
    centred = values - values.mean()
    level = centred - place * (centred @ place) / (place @ place)
    power = np.abs(np.fft.rfft(level * np.hanning(values.size))) ** 2
    highest = 1 + int(np.argmax(power[1:]))
    if power[highest] <= np.log(power.size / _CHANCE) * power[1:].mean():
        return 0.0
    if highest in (1, power.size - 1):
        return float(highest)
    before, at, after = np.log(np.maximum(power[highest - 1 : highest + 2], np.finfo(float).tiny))
    return highest + 0.5 * (before - after) / (before - 2 * at + after)
