"""Amplitude spectra, power spectral densities and order spectra of records."""

from math import ceil, pi

import numpy as np
import torch
from scipy import signal as scipy_signal
from scipy.interpolate import PchipInterpolator, make_interp_spline
from torch import Tensor

from gear_damping.signals.checks import require_positive, require_records
from gear_damping.signals.envelope import upsample

# Samples per original one, between which a spline of this degree resamples to equal angle, and the most
# samples per original one of the result.
_REFINEMENT = 4
_SPLINE_DEGREE = 5  # quintic: a cubic one damps the highest orders
_DENSEST = 8  # times the mean rate: where the shaft all but stands samples are not followed any closer


def amplitude_spectrum(signal: Tensor, sampling_rate: float, window: str = "hann") -> tuple[Tensor, Tensor]:
    """One-sided amplitude spectrum: a tone on a line shows its peak amplitude, whatever the window.

    Args:
        signal: Shape (batch, time).
        sampling_rate: Samples per second (Hz).
        window: A window of scipy.signal.get_window, for example hann, boxcar or flattop (the one for
            reading amplitudes between lines).

    Returns:
        Frequencies (Hz), shape (frequency,), and amplitudes in the unit of the signal (peak, not RMS),
        shape (batch, frequency). The line at 0 Hz is the absolute mean.

    Raises:
        ValueError: the signal, the sampling rate or the window cannot be used.
    """
    require_records(signal)
    require_positive("sampling_rate", sampling_rate)
    n_samples = signal.shape[1]
    weights = torch.as_tensor(scipy_signal.get_window(window, n_samples)).to(signal)
    amplitude = torch.fft.rfft(signal * weights).abs() * (2 / weights.sum())
    # 0 Hz, and half the sampling rate where it is a line, have no mirror image to make up for.
    amplitude[:, 0] /= 2
    if n_samples % 2 == 0:
        amplitude[:, -1] /= 2
    frequencies = torch.arange(n_samples // 2 + 1, device=signal.device, dtype=signal.dtype)
    return frequencies * (sampling_rate / n_samples), amplitude


def power_spectral_density(
    signal: Tensor, sampling_rate: float, segment_length: int | None = None, window: str = "hann"
) -> tuple[Tensor, Tensor]:
    """One-sided power spectral density by Welch's method (scipy): half-overlapping segments, mean removed.

    Args:
        signal: Shape (batch, time).
        sampling_rate: Samples per second (Hz).
        segment_length: Samples of a segment; by default an eighth of the record, at least 2.
        window: A window of scipy.signal.get_window.

    Returns:
        Frequencies (Hz), shape (frequency,), and density in (unit of the signal)^2 / Hz, shape
        (batch, frequency); its integral over frequency estimates the variance. No graph.

    Raises:
        ValueError: an argument cannot be used, or the segment is longer than the record.
    """
    require_records(signal)
    require_positive("sampling_rate", sampling_rate)
    length = max(2, signal.shape[1] // 8) if segment_length is None else segment_length
    if not 2 <= length <= signal.shape[1]:
        raise ValueError(f"segment_length must be 2 to {signal.shape[1]} (the record), got {length!r}")
    values = signal.detach().cpu().numpy()
    frequencies, density = scipy_signal.welch(values, sampling_rate, window, nperseg=length)
    return torch.as_tensor(frequencies).to(signal), torch.as_tensor(density).to(signal)


def order_spectrum(signal: Tensor, angle: Tensor, window: str = "hann") -> tuple[Tensor, Tensor]:
    """One-sided amplitude spectrum over orders (cycles per revolution), at changing speed.

    The signal is interpolated (`upsample`) and resampled by a spline to equal steps of angle over its whole
    revolutions, so whole orders fall on lines. Orders above half the sampling rate at the highest speed are
    left out.

    Args:
        signal: Shape (batch, time), sampled together with the angle.
        angle: Shaft angle (rad) at each sample, unwrapped, shape (time,), strictly increasing.
        window: A window of scipy.signal.get_window.

    Returns:
        Orders, shape (order,), and peak amplitudes in the unit of the signal, shape (batch, order). No graph.

    Raises:
        ValueError: the angle has another shape, does not increase, or covers less than one revolution.
    """
    require_records(signal)
    theta = angle.detach().cpu().double().numpy()
    step = np.diff(theta)
    if theta.shape != (signal.shape[1],) or not (step > 0).all():
        rule = f"angle must have shape ({signal.shape[1]},) and increase from sample to sample"
        raise ValueError(f"{rule}, got {tuple(angle.shape)}: unwrap it, and cut standstill and reversal")
    covered = (theta[-1] - theta[0]) / (2 * pi)
    revolutions = int(covered + 1e-9)
    if revolutions < 1 or len(theta) <= _SPLINE_DEGREE:
        raise ValueError(f"angle must cover a revolution in >= 6 samples, got {covered:.3g} in {len(theta)}")
    # As fine as the slowest part is sampled, so that nothing folds; bounded where the shaft starts from rest.
    finest = max(step.min(), step.mean() / _DENSEST)
    per_revolution = ceil(2 * pi / finest)
    even = theta[0] + np.arange(revolutions * per_revolution) * (2 * pi / per_revolution)
    sample = np.arange(len(theta))
    fine_angle = PchipInterpolator(sample, theta)(np.arange((len(theta) - 1) * _REFINEMENT + 1) / _REFINEMENT)
    fine_signal = upsample(signal.detach().cpu().double(), _REFINEMENT).numpy()
    spline = make_interp_spline(fine_angle, fine_signal, k=_SPLINE_DEGREE, axis=1)
    orders, amplitude = amplitude_spectrum(torch.as_tensor(spline(even)).to(signal), per_revolution, window)
    resolved = orders <= pi / step.max()
    return orders[resolved], amplitude[:, resolved]
