"""The free vibration in a record: what dies away after a start, a stroke, or beside the lines of a mesh."""

from dataclasses import dataclass
from functools import cached_property
from math import exp, pi

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import isotonic_regression, least_squares

from gear_damping.identification.damping_estimate import AMBIENT, UndyingMotion, UnsuitedRecord
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.spectral_floor import spectrum_of
from gear_damping.signals.wavelets.morlet import MorletCWT

Array = NDArray[np.float64]

FEWEST_PERIODS, FEWEST_SAMPLES_PER_PERIOD = 5.0, 5.0  # of a free vibration, to tell its damping
OMEGA0 = 6.0  # of the wavelet that finds the stretch where it is
BAND = (0.6, 1.6)  # of its frequency, within which it may move
WAVELET_REACH = 2.0  # periods: twice the length of that wavelet
ABOVE_NOISE = 3.0  # standard deviations that an amplitude must have to count
END_PERIODS = 3.0  # of a record, whose damped sinusoid continues it beyond an end
SHAFT_ORDERS, SIDEBANDS = 6, 3  # harmonics of a shaft, and of the mesh whose sidebands are taken out
OFF = 0.01  # of the largest force: what is left of it after a stroke,
OFF_NOISE = 6.0  # or so many standard deviations of its noise
LONGEST_DRIVE = 0.9  # of the record: a force that is on for longer leaves no free vibration
FALLS, QUICKEST = (0.02, 0.1, 0.3), 3.0  # decay rates over the frequency in rad/s: where a fit begins, and the most
READ_PER_PERIOD = 20.0  # samples of a period that tell roughly how quickly it falls: more only take time
STAGES = 8  # of a record, each of which swings more than the one before where it grows: noise before a release does not
FALLING = 0.5  # of what ln(amplitude) varies by, that falls: a decay does not rise and fall as much again
GREW = 0.8  # of the largest amplitude, two wavelets before it: what is struck or let go has less there
LEAST_FALL = 0.1  # nepers over a record: what falls less is a line that goes on, or tells no damping


@dataclass(frozen=True, eq=False)
class FreeVibration:
    """A vibration that dies away by itself.

    Args:
        values: (n,) samples about their mean, without lines of the mesh.
        sampling_rate: Hz.
        frequency_hz: Of the vibration, roughly.
        noise: Standard deviation of white noise of the density that is beside it.
        ends: Sample of the record behind its last.
    """

    values: Array
    sampling_rate: float
    frequency_hz: float
    noise: float
    ends: int = 0

    @property
    def begins(self) -> int:
        """Sample of the record that is its first."""
        return self.ends - self.values.size

    @property
    def period(self) -> float:
        """Samples of a period."""
        return self.sampling_rate / self.frequency_hz

    @property
    def time(self) -> Array:
        """Seconds from its beginning, (n,)."""
        return np.arange(self.values.size) / self.sampling_rate

    @cached_property
    def roughly_percent(self) -> float:
        """The damping ratio in % of the damped sinusoid that is nearest to it: how quickly it falls, by any law."""
        some = slice(None, None, max(1, int(self.period / READ_PER_PERIOD)))
        phase, values = 2 * pi * self.frequency_hz * self.time[some], self.values[some]

        def left(point: Array) -> Array:
            fade, turn = np.exp(-point[0] * phase), point[1] * phase
            basis = np.stack([fade * np.cos(turn), fade * np.sin(turn), np.ones_like(turn)], axis=1)
            return values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0]

        ends = ([0.0, BAND[0]], [QUICKEST, BAND[1]])
        found = [least_squares(left, [share, 1.0], bounds=ends) for share in FALLS]
        rate, frequency = min(found, key=lambda one: one.cost).x
        return 100 * float(rate / (rate**2 + frequency**2) ** 0.5)

    def refuse_beyond(self, most_percent: float) -> None:
        """Refuse what falls more quickly than an estimator can follow.

        Raises:
            UnsuitedRecord: it does.
        """
        if self.roughly_percent > most_percent:
            raise UnsuitedRecord(
                f"it falls as with some {self.roughly_percent:.2g} % of critical damping, and this estimator follows "
                f"{most_percent:.2g} % at most: output_error has no such limit"
            )

    def continued(self, samples: int) -> Array:
        """The values with so many samples before and after them, as damped sinusoids go on.

        What looks across an end of a record (a wavelet, a filter) would take what is not there for damping.
        """
        count = min(self.values.size, max(8, round(END_PERIODS * self.period)))
        before = self._beyond(self.values[:count][::-1], samples)[::-1]
        return np.concatenate([before, self.values, self._beyond(self.values[-count:], samples)])

    def _beyond(self, last: Array, samples: int) -> Array:
        """What follows the last values: the damped sinusoid that they end as, its rate changing within them."""
        time, first, widest = np.arange(-last.size + 1, 1.0), 2 * pi / self.period, 1 / self.period

        def columns(at: Array, rate: float, omega: float, change: float) -> Array:
            fade = np.exp(-rate * at - change * at**2 / 2)
            return np.stack([fade * np.cos(omega * at), fade * np.sin(omega * at), np.ones_like(at)], axis=1)

        def left(point: Array) -> Array:
            basis = columns(time, *point)
            return last - basis @ np.linalg.lstsq(basis, last, rcond=None)[0]

        steepest = widest / last.size  # so that the rate changes by a damping ratio of 16 % at most
        ends = ([-widest, first * BAND[0], -steepest], [widest, first * BAND[1], steepest])
        found = least_squares(left, [0.0, first, 0.0], bounds=ends, x_scale=[widest, first / 10, steepest]).x
        sizes = np.linalg.lstsq(columns(time, *found), last, rcond=None)[0]
        return columns(np.arange(1.0, samples + 1), found[0], found[1], 0.0) @ sizes


@dataclass(frozen=True, eq=False)
class Turning:
    """What turns in a gear pair.

    Args:
        mesh_angle: (time,) in rad, at evenly spaced instants.
        teeth: Of pinion and gear.
    """

    mesh_angle: Array
    teeth: tuple[float, float]

    def orders(self) -> list[Array]:
        """Angles (time,) of every harmonic of the mesh, and of the lower ones of both shafts and their sidebands."""
        fastest = float(np.abs(np.diff(self.mesh_angle)).max())
        if fastest <= 0:
            return []
        mesh = [k * self.mesh_angle for k in range(1, int(pi / fastest) + 1)]
        shafts = [self.mesh_angle / teeth for teeth in self.teeth]
        low = [k * shaft for shaft in shafts for k in range(1, SHAFT_ORDERS + 1)]
        beside = [m + k * shaft for m in mesh[:SIDEBANDS] for shaft in shafts for k in (-2, -1, 1, 2)]
        return [*mesh, *low, *beside]


def free_vibration(record: FitRecord, turning: Turning | None = None) -> FreeVibration:
    """The free vibration of a record's first response.

    Args:
        record: Of a free decay, of one after a stroke of force, or of a gear pair.
        turning: Of a gear pair; what follows its shafts and their mesh is taken out.

    Raises:
        UnsuitedRecord: it is driven all the time, too short, too coarse, or nothing in it swings freely.
    """
    values, rate = at_even_instants(record), record.sampling_rate
    begin = _last_drive(record)
    values = values[begin:] - values[begin:].mean()
    if turning is not None:
        values = without_orders(values, turning, begin)
    spectrum = spectrum_of(values, rate)
    if spectrum is None:
        raise UnsuitedRecord(f"{values.size} samples are too few for a free vibration: record longer")
    frequency = strongest(values, rate)
    found = FreeVibration(values, rate, frequency, spectrum.noise, begin + values.size)
    refuse_coarse(frequency, rate)
    return _stretch(found)


def refuse_coarse(frequency_hz: float, sampling_rate: float) -> None:
    """Refuse what swings too fast for its samples.

    Raises:
        UnsuitedRecord: it does.
    """
    period = sampling_rate / frequency_hz
    if period < FEWEST_SAMPLES_PER_PERIOD:
        raise UnsuitedRecord(
            f"the vibration of {frequency_hz:.4g} Hz has {period:.2g} samples a period: sample "
            f"{FEWEST_SAMPLES_PER_PERIOD:g} times as fast as it swings at least"
        )


def grows(record: FitRecord) -> bool:
    """Whether a motion without an input grows all the time, by what a decay must fall by at least."""
    if record.inputs or len(record.response) < 2 * STAGES:
        return False
    sizes = torch.stack([part.std() for part in record.response.tensor_split(STAGES)])
    return bool(sizes[-1] > sizes[0] * exp(LEAST_FALL)) and bool((sizes.diff() > 0).all())


def _last_drive(record: FitRecord) -> int:
    """The first sample after the last drive.

    Raises:
        UnsuitedRecord: it is driven nearly all the time.
    """
    begin = 0
    for name in ("force", "base_acceleration"):
        series = record.inputs.get(name)
        if series is None or float(series.max()) == float(series.min()):
            continue
        force = series.numpy()
        spectrum = spectrum_of(force - np.median(force), record.sampling_rate)
        off = max(OFF * np.abs(force - np.median(force)).max(), OFF_NOISE * (spectrum.noise if spectrum else 0.0))
        on = np.flatnonzero(np.abs(force - np.median(force)) > off)
        begin = max(begin, int(on[-1]) + 1 if on.size else 0)
    if begin > LONGEST_DRIVE * len(record.response):
        raise UnsuitedRecord("it is driven by a measured input: this estimator needs a free decay (a ring-down)")
    return begin


def strongest(values: Array, rate: float) -> float:
    """The frequency of the strongest line, in Hz; a drift, which a parabola follows, is none.

    Raises:
        UnsuitedRecord: it swings too few times.
    """
    place = np.linspace(-1, 1, values.size)
    steady = values - np.polynomial.Polynomial.fit(place, values, 2)(place)
    power = np.abs(np.fft.rfft(steady * np.hanning(2 * values.size)[values.size :], 4 * values.size)) ** 2
    strongest = 4 + int(np.argmax(power[4:]))
    if strongest < 4 * FEWEST_PERIODS:
        raise UnsuitedRecord(
            f"what swings most does so {strongest / 4:.2g} times, and {FEWEST_PERIODS:g} are needed: record longer"
        )
    return strongest * rate / (4 * values.size)


def at_even_instants(record: FitRecord) -> Array:
    """The first response of a record, (n,), at even instants where its stamps are not."""
    values = record.response.numpy()
    if record.stamps is None:
        return values
    stamps = record.stamps.numpy()
    return CubicSpline(stamps, values)(np.linspace(stamps[0], stamps[-1], values.size))


def without_orders(values: Array, turning: Turning, begin: int = 0) -> Array:
    """Without what follows mesh and shafts, up to half the sampling rate, by least squares.

    Args:
        values: (n,), or several signals (n, k), from sample `begin` of the record on.
        turning: What turns, over the whole record.
        begin: The first sample.

    Raises:
        UnsuitedRecord: it holds too few turns for that.
    """
    angles = [angle[begin:] for angle in turning.orders() if np.abs(np.diff(angle)).max() < pi]
    if not angles:
        return values
    phases = np.stack(angles, axis=1)
    basis = np.concatenate([np.cos(phases), np.sin(phases), np.ones((len(values), 1))], axis=1)
    if basis.shape[1] > len(values) / 2:
        raise UnsuitedRecord("it holds fewer turns than the orders of mesh and shafts take: record longer")
    return values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0]


def _stretch(found: FreeVibration) -> FreeVibration:
    """From where it is largest to where it is lost in noise.

    Raises:
        UnsuitedRecord: that is shorter than a few periods.
    """
    amplitude, deviation = amplitude_of(found, OMEGA0)
    begin = int(np.argmax(amplitude))
    begin = begin if begin > WAVELET_REACH * found.period else 0  # there the beginning hides it
    lost = np.flatnonzero(amplitude[begin:] < ABOVE_NOISE * deviation)
    end = begin + int(lost[0]) if lost.size else amplitude.size
    if end - begin < FEWEST_PERIODS * found.period:
        raise UnsuitedRecord(
            f"nothing swings freely for {FEWEST_PERIODS:g} periods of {found.frequency_hz:.4g} Hz above the noise: "
            "record a ring-down from a larger amplitude"
        )
    log_size = np.log(amplitude[begin:end])
    fall = -np.polynomial.Polynomial.fit(np.arange(end - begin), log_size, 1).convert().coef[1]
    if fall * (end - begin) < LEAST_FALL:
        raise UndyingMotion(
            f"what swings most in it, at {found.frequency_hz:.4g} Hz, does not die away: a line, or too short a record"
        )
    before = begin - round(2 * WAVELET_REACH * found.period)
    grew = begin > 0 and amplitude[max(before, 0)] > GREW * amplitude[begin]
    if grew or _falling_share(log_size) < FALLING:
        raise UndyingMotion(
            f"what swings most in it, at {found.frequency_hz:.4g} Hz, grows by itself: something that was not measured "
            f"drives it. Give its ring-down alone (by `slice` or `window`), or the force; {AMBIENT}"
        )
    last = found.begins + end
    return FreeVibration(found.values[begin:end], found.sampling_rate, found.frequency_hz, found.noise, last)


def never_falls(record: FitRecord) -> bool:
    """Whether a record has no input and its motion does not die away: something feeds it, or it beats."""
    if record.inputs:
        return False
    try:
        free_vibration(record)
    except UnsuitedRecord as said:
        return isinstance(said, UndyingMotion)
    return False


def _falling_share(log_size: Array) -> float:
    """How much of the variance of ln(amplitude) the nearest curve that never rises takes."""
    left = log_size - isotonic_regression(log_size, increasing=False).x
    return 1 - float(left.var() / max(log_size.var(), np.finfo(float).tiny))


def amplitude_of(found: FreeVibration, omega0: float) -> tuple[Array, float]:
    """Amplitude at the vibration's frequency by a Morlet wavelet, (n,), and its standard deviation by noise."""
    wavelet = MorletCWT(found.sampling_rate, frequencies_hz=[found.frequency_hz], omega0=omega0)
    coefficients = wavelet(torch.as_tensor(found.values).unsqueeze(0))[0, 0].abs().numpy()
    size = tone_size(wavelet, wavelet.ridge_number)[0]
    return coefficients / size, found.noise / (2**0.5 * size)


def tone_size(wavelet: MorletCWT, number: float) -> Array:
    """|W| of a tone of amplitude one whose s w is `number` at each scale s, (scales,).

    The integral of psi = pi^(-1/4) exp(i w0 t) exp(-t^2/2) with the tone.
    """
    gauss = (2 * pi) ** 0.5 * pi**-0.25 / 2
    return gauss * np.exp(-((number - wavelet.omega0) ** 2) / 2) * np.asarray(wavelet.scales) ** 0.5
