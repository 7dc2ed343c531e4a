"""The two forms of the same linear map: a dense matrix for short windows, a spectrum for long records.

Both come from the wavelet sampled at whole lags, in float64. A spectrum taken from the formula of the
Fourier transform would leave out what sampling folds over at small scales, and so differ from the sum
that defines the transform; the spectrum of the sampled wavelet gives that sum at every scale.
"""

from collections.abc import Callable, Sequence
from math import ceil

import torch
from scipy.fft import next_fast_len
from torch import Tensor

Mother = Callable[[Tensor], Tensor]

# Where exp(-t^2/2) times a low power of t has fallen below the rounding of the type.
SUPPORT = {torch.float32: 6.0, torch.float64: 9.0}


def fast_length(minimum: int) -> int:
    """The smallest 16 * 2^a 3^b 5^c that is at least `minimum`.

    Odd lengths take three times as long as their even neighbours and twice an odd number 1.5 times:
    hence the 16.
    """
    return 16 * next_fast_len(ceil(minimum / 16), real=True)


def sampled_wavelet(mother: Mother, lags: Tensor, scales: Sequence[float]) -> Tensor:
    """s^-1/2 psi(lag / s) for lags of shape (..., lag), as (..., scale, lag), float64 or complex128."""
    scale = torch.tensor(scales, dtype=torch.float64)[:, None]
    return mother(lags[..., None, :] / scale) / scale.sqrt()


def dense_matrix(mother: Mother, scales: Sequence[float], n_samples: int) -> Tensor:
    """The transform of a window of n_samples as a matrix of shape (time, scale * time).

    Complex wavelets give (time, scale * time * 2), real and imaginary parts side by side, so that one
    real matrix product does.
    """
    sample = torch.arange(n_samples, dtype=torch.float64)
    kernel = sampled_wavelet(mother, sample[:, None] - sample, scales)
    if kernel.is_complex():
        kernel = torch.view_as_real(kernel.conj().resolve_conj())
    return kernel.reshape(n_samples, -1)


def spectrum(mother: Mother, scales: Sequence[float], n_samples: int, dtype: torch.dtype) -> tuple[Tensor, int]:
    """Spectrum of the sampled wavelets, (scale, frequency), and the padded length it belongs to.

    It is real, because psi(-t) is the conjugate of psi(t). The padding holds the longest wavelet, or
    the whole record where that is shorter, so nothing wraps around. Real wavelets have
    n_fft / 2 + 1 frequencies, complex ones n_fft.
    """
    reach = min(n_samples - 1, ceil(SUPPORT[dtype] * max(scales)))
    n_fft = fast_length(n_samples + reach)
    lags = torch.arange(-reach, reach + 1)
    kernel = sampled_wavelet(mother, lags.double(), scales)
    circular = kernel.new_zeros((len(scales), n_fft))
    circular[:, lags % n_fft] = kernel
    transform = torch.fft.fft if kernel.is_complex() else torch.fft.rfft
    return transform(circular).real.contiguous(), n_fft
