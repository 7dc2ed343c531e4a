"""Linear filters of records by their frequency response."""

from collections.abc import Callable

import torch
from torch import Tensor


def filtered(signal: Tensor, sampling_rate: float, response: Callable[[Tensor], Tensor]) -> Tensor:
    """The record behind a linear filter.

    The record is continued at both ends by its reflection through the end point, so that value and
    slope go on smoothly: what lies outside a record is not known.

    Args:
        signal: Records, (batch, time), at least two samples.
        sampling_rate: Samples per second.
        response: Gives the complex frequency response, (batch, frequency), at frequencies in Hz.
    """
    count = signal.shape[-1]
    first, last = signal[..., :1], signal[..., -1:]
    before, after = 2 * first - signal[..., 1:].flip(-1), 2 * last - signal[..., :-1].flip(-1)
    longer = torch.cat([before, signal, after], dim=-1)
    total = longer.shape[-1]
    frequency = torch.fft.rfftfreq(total, 1 / sampling_rate, dtype=signal.dtype, device=signal.device)
    spectrum = torch.fft.rfft(longer) * response(frequency)
    return torch.fft.irfft(spectrum, n=total)[..., count - 1 : 2 * count - 1]
