"""Analytic signal, envelope and instantaneous frequency; band-limited interpolation between samples."""

from math import pi

import torch
from torch import Tensor

from gear_damping.signals.checks import require_positive, require_records

# Half the length of the interpolating kernel (samples) and the parameter of its Kaiser window. The
# window's stop band is 154 dB down and half its main lobe is 0.08 of the sampling rate (Kaiser's
# formulas), so content below 0.42 of the sampling rate is interpolated to about 2e-8 of its amplitude.
_HALF_WIDTH = 32
_KAISER_BETA = 16.0  # of the window, whose effect is said above


def analytic_signal(signal: Tensor) -> Tensor:
    """The signal plus i times its Hilbert transform: (batch, time), complex.

    By FFT over the record, which is thereby taken as periodic. The jump A from its end to its start leaves
    an error of about A / (2 pi f d) at the distance d (s) from either: of a free decay use the first two
    time constants or so, and beyond them |W| of a `MorletCWT`, whose wavelets end. A constant part stays in
    the real part: remove it first.
    """
    require_records(signal)
    n_samples = signal.shape[1]
    gain = torch.zeros(n_samples, dtype=signal.dtype, device=signal.device)
    gain[0] = 1
    gain[1 : (n_samples + 1) // 2] = 2
    if n_samples % 2 == 0:
        gain[n_samples // 2] = 1
    return torch.fft.ifft(torch.fft.fft(signal) * gain)


def envelope(signal: Tensor) -> Tensor:
    """Magnitude of the analytic signal: (batch, time), in the unit of the signal."""
    return analytic_signal(signal).abs()


def instantaneous_frequency(signal: Tensor, sampling_rate: float) -> Tensor:
    """Rate of the phase of the analytic signal (Hz): (batch, time).

    Each value is the mean of the phase steps before and after the sample, one step at the ends. A step
    is known without unwrapping up to half the sampling rate.

    Raises:
        ValueError: the signal or the sampling rate (Hz) cannot be used.
    """
    require_positive("sampling_rate", sampling_rate)
    analytic = analytic_signal(signal)
    step = torch.angle(analytic[:, 1:] * analytic[:, :-1].conj()) * (sampling_rate / (2 * pi))
    middle = (step[:, 1:] + step[:, :-1]) / 2
    return torch.cat([step[:, :1], middle, step[:, -1:]], dim=1)


def upsample(signal: Tensor, factor: int) -> Tensor:
    """Band-limited interpolation: (batch, time) -> (batch, (time - 1) * factor + 1).

    Sample k * factor of the result is sample k of the signal, exactly; nothing is extrapolated. A
    sinc kernel under a Kaiser window, 64 samples long: an FFT over the record would take it as periodic,
    and its ends would ring through all of it. Here they reach 32 samples in, where the signal is
    continued by point reflection about its end (which keeps value and slope). Inside, content below
    0.42 of the sampling rate is interpolated to about 2e-8; what is close to half the sampling rate is
    attenuated between the samples. Records shorter than 33 samples get a shorter kernel, with larger
    errors.

    Args:
        signal: Shape (batch, time).
        factor: Samples of the result per sample of the signal, >= 1.

    Raises:
        ValueError: the signal cannot be used, or factor is not a positive whole number.
    """
    require_records(signal)
    if int(factor) != factor or factor < 1:
        raise ValueError(f"factor must be a positive whole number, got {factor!r}")
    if factor == 1:
        return signal.clone()
    half = min(_HALF_WIDTH, signal.shape[1] - 1)
    kernel = _interpolation_kernel(int(factor), half).to(signal.device, signal.dtype)
    padded = _point_reflected(signal, half)[:, None]
    between = torch.nn.functional.conv1d(padded[..., 1:-1], kernel).transpose(1, 2)
    inner = torch.cat([signal[:, :-1, None], between], dim=2).flatten(1)
    return torch.cat([inner, signal[:, -1:]], dim=1)


def _point_reflected(signal: Tensor, width: int) -> Tensor:
    """The signal with `width` samples on either side, reflected about its first and last point."""
    before = 2 * signal[:, :1] - signal[:, 1 : width + 1].flip(1)
    after = 2 * signal[:, -1:] - signal[:, -width - 1 : -1].flip(1)
    return torch.cat([before, signal, after], dim=1)


def _interpolation_kernel(factor: int, half: int) -> Tensor:
    """Weights (factor - 1, 1, 2 * half) of the samples 1 - half .. half around each place between 0 and 1."""
    place = torch.arange(1, factor, dtype=torch.float64)[:, None] / factor
    distance = place - torch.arange(1 - half, half + 1, dtype=torch.float64)
    window = torch.special.i0(_KAISER_BETA * torch.sqrt((1 - (distance / half) ** 2).clamp(min=0)))
    weights = torch.sinc(distance) * window
    return (weights / weights.sum(1, keepdim=True))[:, None]
