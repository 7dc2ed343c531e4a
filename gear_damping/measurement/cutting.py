"""Which rows a window of time takes, and values brought to a lower rate by a filter that shifts nothing.

The filter passes what lies below 0.4 of the new rate and stops, by 80 dB, what lies above half of it. It reaches 25
samples of the new rate to either side. There it meets the rows that the file holds beside a slice or a window, for what
it stops may be larger than what it passes. Beyond the ends of a file it meets what the last 50 samples of the new rate
go on as: a cubic and waves that the filter passes, fitted to them by least squares. What is smooth so keeps its ends,
where zeros, a held value or a reflection would bend it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gear_damping.errors import InputError, Problem
from gear_damping.measurement.timebase import RATE_TOLERANCE, TimeBase, cubic_spline, moved_to, refuse_uncovered

PASS, STOP = 0.4, 0.5  # of the new rate
_ATTENUATION = 80.0  # dB that the filter stops by: what is left lies below the noise of a sensor
_REACH = 25  # samples of the new rate that the filter reaches to either side; enough for 80 dB between PASS and STOP
_FITTED = 50  # samples of the new rate at an end that its continuation is fitted to
_FINE = 8  # samples of the filtered signal for one of the new rate, between which a spline is exact enough
_WAVES = 0.36  # of the new rate; waves in the continuation, well within what the filter passes
_SMALLEST_SINGULAR = 1e-3  # of the largest; smaller ones let noise grow beyond the ends
_MEANS = 10  # means of recorded samples for one of the new rate, to which the continuation is fitted
_SAME_RATE = 1e-3  # a rate this little above the recorded one is the recorded one
_ROUNDING = 1e-9  # of a rate: what its digits leave


def window_rows(
    seconds: NDArray[np.float64],
    window: tuple[float, float],
    key: str = "window",
    source: str = "",
    remedy: str = "stay within it",
) -> tuple[int, int]:
    """The first row at or after the begin of a window, and the first row at or after its end.

    Args:
        seconds: (n,) times of the rows in s, n >= 2; those outside of the window may be anything.
        window: Begin and end in s on the same clock; the end itself is not in it.
        key: What the window is called in messages.
        source: The file that declares it.
        remedy: What helps where it lies beyond the record.

    Raises:
        InputError: the window reaches beyond the record by more than one step, or no row lies in it.
    """
    begin, end = window
    step = float(np.nanmedian(np.abs(np.diff(seconds))))
    near = 1e-6 * step
    first, last = float(np.nanmin(seconds)), float(np.nanmax(seconds))
    if begin < first - step - near or end > last + step + near:
        digits = 6 + int(np.log10(max(1.0, abs(first) / (last - first)))) if last > first else 6
        rule = f"the record goes from {first:.{digits}g} to {last:.{digits}g} s"
        raise InputError(Problem(key, rule, list(window), remedy, source))
    inside = np.flatnonzero((seconds >= begin - near) & (seconds < end - near))
    if not inside.size:
        raise InputError(Problem(key, "no sample lies in it", list(window), "widen it", source))
    return int(inside[0]), int(inside[-1]) + 1


def rows_beside(base: TimeBase, rate: float) -> int:
    """How many rows the filter down to `rate` in Hz reaches to either side."""
    return int(np.ceil(_REACH * base.sampling_rate / rate))


def slower(
    base: TimeBase, rate: float, key: str = "resample", source: str = "", within: tuple[float, float] | None = None
) -> TimeBase:
    """The time base of a record at a lower rate; its `resample` filters the record's values.

    Args:
        base: The time base of the samples in the file.
        rate: The new rate in Hz.
        within: The first and the last time in s that the record is to hold; absent, those of `base`.
        key: What the rate is called in messages.
        source: The file that declares it.

    Raises:
        InputError: `rate` lies above the recorded one.
    """
    if rate > base.sampling_rate * (1 + _SAME_RATE):
        rule = f"{rate:.6g} Hz lie above the recorded {base.sampling_rate:.6g} Hz; nothing was measured in between"
        raise InputError(Problem(key, rule, rate, "give a lower rate, or leave it out", source))
    if rate >= base.sampling_rate * (1 - _ROUNDING):
        return base
    begin, end = within or (base.time[0], base.time[-1])
    n = int(np.floor((end - begin) * rate * (1 + _ROUNDING))) + 1
    note = f"resampled from {base.sampling_rate:.6g} to {rate:.6g} Hz; flat up to {PASS * rate:.6g} Hz"
    return SlowerTime(
        begin + np.arange(n) / rate, rate, notes=(*base.notes, note), findings=base.findings, recorded=base
    )


@dataclass(frozen=True, eq=False)
class SlowerTime(TimeBase):
    """A time base below the recorded one."""

    recorded: TimeBase | None = None

    def resample(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values at the recorded samples, filtered and taken at the new ones."""
        return _filtered(self, self.recorded, values)


def _filtered(base: TimeBase, own: TimeBase, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values on a faster time base at the times of `base`, without what lies above half of its rate."""
    values = own.resample(values)
    if own.uniform:
        return lowpassed_at(base.time, values, float(own.time[0]), own.sampling_rate, base.sampling_rate)
    grid = np.arange(own.time[0], own.time[-1] + 0.5 / own.sampling_rate, 1 / own.sampling_rate)
    even = cubic_spline(own.time, values)(np.minimum(grid, own.time[-1]))
    return lowpassed_at(base.time, even, float(grid[0]), own.sampling_rate, base.sampling_rate)


def is_faster(own: TimeBase, base: TimeBase) -> bool:
    """Whether a channel's rate is so much above the record's that what it holds beyond would fold into its band."""
    return own.sampling_rate > base.sampling_rate * (1 + RATE_TOLERANCE)


def moved(base: TimeBase, own: TimeBase, values: NDArray[np.float64], key: str, source: str) -> NDArray[np.float64]:
    """Values on their own time base at the times of `base`: a faster channel through a filter before it.

    Raises:
        InputError: the record lasts longer than the channel.
    """
    if is_faster(own, base):
        refuse_uncovered(base.time, own, key, source)
        return _filtered(base, own, values)
    return moved_to(base.time, own, values, key, source)


def lowpassed_at(
    time: NDArray[np.float64], values: NDArray[np.float64], start: float, recorded: float, rate: float
) -> NDArray[np.float64]:
    """(m,) values at `time` of a signal without what lies above half of `rate`.

    Args:
        time: (m,) in s, within the signal.
        values: (n,) samples of the signal; an angle unwrapped.
        start: The time of its first sample in s.
        recorded: Its rate in Hz.
        rate: The rate in Hz that it is to have, at most `recorded`.
    """
    filtering = _Filter(recorded, rate)
    n = values.size
    line = np.polynomial.Polynomial.fit(np.arange(n), values, 1)(np.arange(n)) if n > 1 else values
    padded = filtering.continued(values - line)
    fine = filtering.applied(padded)
    fine_rate = recorded * filtering.up
    grid = np.arange(fine.size) / fine_rate
    swings = cubic_spline(grid, fine)(np.clip(time - start, 0.0, grid[-1]))
    return swings + np.interp(time - start, np.arange(n) / recorded, line)


class _Filter:
    """A zero-phase low-pass, and the record's continuation that it needs at both ends."""

    def __init__(self, recorded: float, rate: float) -> None:
        self.up = max(1, int(np.ceil(_FINE * rate / recorded)))
        self.step = rate / recorded  # one recorded sample in samples of the new rate
        self.reach = int(np.ceil(_REACH / self.step))  # recorded samples
        self.fitted = int(np.ceil(_FITTED / self.step))

    @cached_property
    def taps(self) -> NDArray[np.float64]:
        """The filter at `up` times the recorded rate; each of its `up` phases sums to one."""
        from scipy.signal import firwin, kaiser_beta  # here, since few records need what takes long to import

        half = self.reach * self.up
        cutoff = (PASS + STOP) / 2 * self.step / self.up  # of the rate of the taps
        taps = firwin(2 * half + 1, 2 * cutoff, window=("kaiser", kaiser_beta(_ATTENUATION)))
        for phase in range(self.up):
            taps[phase :: self.up] /= taps[phase :: self.up].sum()
        return taps

    def continued(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """(n + 2 reach,) values that go on smoothly at both ends."""
        before = self._going_on(values[: self.fitted][::-1])[::-1]
        return np.concatenate([before, values, self._going_on(values[-self.fitted :])])

    def _going_on(self, end: NDArray[np.float64]) -> NDArray[np.float64]:
        """(reach,) samples after `end`."""
        every = max(1, int(1 / (_MEANS * self.step)))
        n_means = end.size // every
        means = end[end.size - n_means * every :].reshape(n_means, every).mean(axis=1)
        before = (np.arange(n_means) - n_means + 0.5) * every
        place = np.concatenate([before, np.arange(self.reach) + 0.5]) * self.step  # 0 is where the record ends
        basis = _smooth(place, place[-1] - 2 * place[0])
        coefficients = np.linalg.lstsq(basis[:n_means], means, rcond=_SMALLEST_SINGULAR)[0]
        return basis[n_means:] @ coefficients

    def applied(self, padded: NDArray[np.float64]) -> NDArray[np.float64]:
        """The filtered signal at `up` times the recorded rate, from the first recorded sample to the last."""
        from scipy.signal import oaconvolve

        stuffed = np.zeros((padded.size - 1) * self.up + 1)
        stuffed[:: self.up] = padded
        return oaconvolve(stuffed, self.taps, mode="valid")


def _smooth(place: NDArray[np.float64], period: float) -> NDArray[np.float64]:
    """(n, p) cubics and waves of a period and its harmonics, at `place` in samples of the new rate."""
    turns = 2 * np.pi * np.outer(place / period, np.arange(1, int(_WAVES * period) + 1))
    cubic = np.polynomial.legendre.legvander(2 * (place - place[0]) / np.ptp(place) - 1, 3)
    return np.concatenate([cubic, np.cos(turns), np.sin(turns)], axis=1)
