"""What the network is fed: the raw window, or its wavelet transform, with normalisation stored inside."""

from collections.abc import Sequence
from math import ceil, pi

import torch
from torch import Tensor, nn

from gear_damping.identification.sizes import refuse_cells
from gear_damping.signals.wavelets.base import ContinuousWavelet

REACH = 4.0  # standard deviations of an envelope at which a wavelet is cut off: 3e-4 of its height
AT_ONCE = 512  # records, whose overlapping frames are held at a time
QUIET = 1e-12  # of the energy of a signal of deviation 1: below single precision


class FrontEnd(nn.Module):
    """Windows (batch, window) to features (batch, window, feature) of mean 0 and deviation 1.

    The means and deviations are buffers, so they travel with the weights; they are fitted on the training
    part only (`fit_signal`, then `fit_features`). The base class gives the window itself: one feature.
    """

    n_features = 1  # for each sample: the signal itself

    def __init__(self) -> None:
        super().__init__()
        self.register_buffer("signal_mean", torch.zeros(()))
        self.register_buffer("signal_scale", torch.ones(()))
        self.register_buffer("feature_mean", torch.zeros(self.n_features))
        self.register_buffer("feature_scale", torch.ones(self.n_features))

    def columns(self, signals: Tensor) -> Tensor:
        """Features before their normalisation of whole records or windows, (batch, time, feature).

        The mean of the training signals is taken off first: a transform sees zeros beyond the ends, and a
        constant part would put a step there.
        """
        return self._transform((signals - self.signal_mean) / self.signal_scale)

    def forward(self, inputs: Tensor) -> Tensor:
        """Normalised features of windows (batch, window), or of columns (batch, window, feature)."""
        columns = self.columns(inputs) if inputs.ndim == 2 else inputs
        return (columns - self.feature_mean) / self.feature_scale

    def fit_signal(self, windows: Tensor) -> None:
        """Take mean and deviation of the signal from training windows (batch, window)."""
        # In float64: a small oscillation about a large constant would lose its deviation to rounding.
        _set(self.signal_mean, self.signal_scale, windows.double().reshape(-1, 1))

    def fit_features(self, inputs: Tensor) -> None:
        """Take mean and deviation of each feature from training windows or columns."""
        columns = self.columns(inputs) if inputs.ndim == 2 else inputs
        _set(self.feature_mean, self.feature_scale, columns.double().reshape(-1, self.n_features))

    def _transform(self, signals: Tensor) -> Tensor:
        return signals[..., None]


class FrameFrontEnd(FrontEnd):
    """Log energies of a record in frames: how much there is of each frequency, and when.

    Each frame and frequency is one coefficient of a complex Morlet wavelet; all last equally long (Gabor 1946), so
    that every frequency is resolved alike, and frames as far apart as a wavelet is long leave nothing out.

    Args:
        sampling_rate: Samples per second (Hz).
        frequencies_hz: Of the wavelets.
        duration: Standard deviation of their envelope, s.
        hop: Between frames, s.

    Raises:
        ValueError: the wavelets would take more memory than there may be.
    """

    def __init__(self, sampling_rate: float, frequencies_hz: Sequence[float], duration: float, hop: float) -> None:
        self.n_features = len(frequencies_hz)
        super().__init__()
        self.hop = max(1, round(hop * sampling_rate))
        self.reach = ceil(REACH * duration * sampling_rate)
        refuse_cells((2 * self.reach + 1) * 2 * len(frequencies_hz), f"wavelets of {1e3 * duration:g} ms")
        time = torch.arange(-self.reach, self.reach + 1, dtype=torch.float64) / sampling_rate
        envelope = torch.exp(-((time / duration) ** 2) / 2)
        turned = 2 * pi * time[:, None] * torch.tensor(frequencies_hz, dtype=torch.float64)
        bank = torch.cat([torch.cos(turned), torch.sin(turned)], 1) * (envelope / envelope.norm())[:, None]
        self.register_buffer("bank", bank.float(), persistent=False)

    def _transform(self, signals: Tensor) -> Tensor:
        level = signals - signals.mean(1, keepdim=True)
        padded = nn.functional.pad(level, (self.reach, self.reach))
        parts = [part.unfold(1, len(self.bank), self.hop) @ self.bank for part in padded.split(AT_ONCE)]
        real, imaginary = torch.cat(parts).tensor_split(2, dim=-1)
        return torch.log(real.square() + imaginary.square() + QUIET)


class WaveletFrontEnd(FrontEnd):
    """Features that are the wavelet coefficients of the window at each of its samples.

    Given a window, the transform sees the window and nothing else. Real transforms give one feature per
    scale, complex ones two: all real parts, then all imaginary parts.

    Args:
        transform: The wavelet transform.
    """

    def __init__(self, transform: ContinuousWavelet) -> None:
        complex_result = transform.output_dtype(torch.float32).is_complex
        self.n_features = len(transform.frequencies_hz) * (2 if complex_result else 1)
        super().__init__()
        self.transform = transform

    def _transform(self, signals: Tensor) -> Tensor:
        coefficients = self.transform(signals)
        if coefficients.is_complex():
            coefficients = torch.cat([coefficients.real, coefficients.imag], dim=1)
        return coefficients.transpose(1, 2)


def _set(mean: Tensor, scale: Tensor, values: Tensor) -> None:
    deviation, average = torch.std_mean(values, dim=0, correction=0)
    mean.copy_(average.reshape(mean.shape))
    # A feature that never varies (a scale that sees nothing) is left at its size, not divided by zero.
    deviation = torch.where(deviation > 0, deviation, torch.ones_like(deviation))
    scale.copy_(deviation.reshape(scale.shape))
