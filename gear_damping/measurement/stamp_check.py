"""Whether samples were taken at their uneven stamps, asked of the values themselves.

A stamp that is off its place by e moves a sample by e times the slope of the signal, s' e, if the sample was taken
there; if the sampling was even and only the stamps are late, the values know nothing of e. The share b of s' e in
the values (1 where the stamps are right, 0 where they are not) is fitted by least squares over the frequencies, each
weighted with the inverse of its power, so that the quiet ones, where s' e shows, decide.
"""

import numpy as np
from numpy.typing import NDArray

from gear_damping.measurement.record import Finding, Record

_LOCAL = 9  # samples about which a stamp's place is judged; slower wandering of a clock is left alone
_MATTERS = 1e-4  # share of the signal's variance that s' e must have to matter
_FEWEST = 64  # samples, below which nothing is decided
_NEIGHBOURS = 33  # frequencies that give the level about a line
_SLOPE_ERROR = 0.1  # of the power of s' e; nothing is weighted higher than this error of the slope allows
_FLOOR, _OVER = 0.1, 4.0  # quantile of the power that is noise; times this, what a line must be above
_DECIDED = 0.35  # share below which the stamps are wrong
_ERRORS = 4.0  # standard errors that the share must be nearer to none by


def stamps_against_values(record: Record) -> Finding | None:
    """The data problem of a record with uneven stamps whose values were sampled evenly; None for any other."""
    if record.uniform or record.time.size < _FEWEST:
        return None
    for channel in record.channels.values():
        share, error = share_at_stamps(channel.values, record.time)
        if abs(share) + _ERRORS * error < _DECIDED:  # a share far below 0 is neither: values that wait for an event
            message = (
                f"the values of {channel.name} were sampled evenly and the stamps were not ({100 * share:.2g} % of the "
                f"jitter of the stamps shows in the values, +-{100 * error:.2g} %): a computer wrote them late; "
                "give sampling_rate instead of the time column"
            )
            return Finding("uneven_stamps", message, channel=channel.name)
    return None


def share_at_stamps(values: NDArray[np.float64], stamps: NDArray[np.float64]) -> tuple[float, float]:
    """The share of the stamps' jitter that values show, and its standard error (infinite where none can matter).

    Args:
        values: (n,) samples.
        stamps: (n,) their stamps in s.
    """
    from scipy.ndimage import median_filter, uniform_filter1d  # here, since few records need what takes long to import

    place = stamps / np.median(np.diff(stamps)) - np.arange(stamps.size)
    place -= uniform_filter1d(place, _LOCAL, mode="nearest")
    index = np.arange(values.size)
    slope, start = np.polyfit(index, values, 1)
    straight = start + slope * index
    moved = (slope + np.gradient(_quiet(values - straight))) * place
    if np.var(moved) <= _MATTERS * np.var(values):
        return 1.0, np.inf
    taper = np.hanning(values.size)
    seen, due = np.fft.rfft((values - straight) * taper), np.fft.rfft((moved - moved.mean()) * taper)
    power = np.abs(seen) ** 2
    due_power = np.abs(due) ** 2
    level = power + median_filter(power, _NEIGHBOURS, mode="nearest") + _SLOPE_ERROR * (due_power + due_power.mean())
    total = float(np.sum(due_power / level))
    share = float(np.sum((due.conj() * seen).real / level)) / total
    spread = np.sum(due_power * np.abs(seen - share * due) ** 2 / level**2)
    return share, float(np.sqrt(spread)) / total


def _quiet(values: NDArray) -> NDArray:
    """Values about their straight line without most of their noise, which would hide the slope (Wiener's filter)."""
    from scipy.ndimage import median_filter

    spectrum = np.fft.rfft(values)
    power = np.abs(spectrum) ** 2
    noise = float(np.quantile(median_filter(power, _NEIGHBOURS, mode="nearest"), _FLOOR)) / np.log(2)
    return np.fft.irfft(spectrum * np.maximum(0.0, 1 - _OVER * noise / np.maximum(power, 1e-300)), values.size)
