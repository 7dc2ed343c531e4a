"""Linear filters of records by their frequency response."""

from collections.abc import Callable
from math import cos, pi, sin

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


def butterworth_response(order: int, high: bool = False) -> Callable[[Tensor], Tensor]:
    """The complex response of a Butterworth filter by frequency over corner: low-pass, or high-pass.

    Butterworth (1930), Exp. Wirel. Wirel. Eng. 7.
    """

    def response(ratio: Tensor) -> Tensor:
        total = torch.ones_like(ratio) + 0j
        for pole in _poles(order):
            total = total * (1j * ratio / (1 - pole * 1j * ratio) if high else 1 / (1j * ratio - pole))
        return total

    return response


def butterworth_modes(order: int, angle: Tensor) -> Tensor:
    """What unit states of a Butterworth filter at the start leave behind, (order, ...) at angles 2 pi f_c t.

    A record says nothing of what was before it: the difference that it makes is a sum of these.
    """
    found = []
    for pole in _poles(order):
        decay = torch.exp(pole.real * angle)
        if abs(pole.imag) < 1e-9:
            found.append(decay)
        elif pole.imag > 0:
            found += [decay * torch.cos(pole.imag * angle), decay * torch.sin(pole.imag * angle)]
    return torch.stack(found)


def _poles(order: int) -> list[complex]:
    angles = (pi * (2 * k + 1 + order) / (2 * order) for k in range(order))
    return [complex(cos(angle), sin(angle)) for angle in angles]
