"""The Morlet wavelet: a tone under a Gaussian."""

from math import exp, pi, sqrt
from typing import Any, ClassVar

import torch
from torch import Tensor

from gear_damping.setting import Setting
from gear_damping.signals.wavelets.base import ContinuousWavelet


class MorletCWT(ContinuousWavelet):
    """Transform by the Morlet wavelet psi(t) = c pi^(-1/4) (exp(i w0 t) - exp(-w0^2/2)) exp(-t^2/2): complex.

    The small constant makes the mean zero, c the energy one. The band of |W|^2 around a frequency f has the
    standard deviation f / (sqrt(2) omega0): a large omega0 resolves frequencies, a small one times.

    Args:
        sampling_rate: Samples per second (Hz).
        omega0: Oscillations of the wavelet, >= 5, so that the rule from scale to frequency holds to 1e-5.
        magnitude: Give |W| (real) instead of the complex coefficients.
        frequencies: The other arguments of `ContinuousWavelet`.

    Raises:
        ValueError: as `ContinuousWavelet`, or omega0 is below 5.
    """

    name = "morlet"
    complex_mother = True
    own_settings: ClassVar = (
        Setting("omega0", 6.0, "oscillations of the wavelet", 5, 100),
        Setting("magnitude", False, "its magnitude instead of real and imaginary part"),
    )

    def __init__(
        self, sampling_rate: float, *, omega0: float = 6.0, magnitude: bool = False, **frequencies: Any
    ) -> None:
        if not omega0 >= 5:
            raise ValueError(f"omega0 must be at least 5, got {omega0!r}: use RickerCWT for shorter wavelets")
        self.omega0 = float(omega0)
        self.magnitude = bool(magnitude)
        super().__init__(sampling_rate, **frequencies)

    def mother(self, t: Tensor) -> Tensor:
        """The Morlet wavelet at times t (in scales)."""
        square = self.omega0**2
        norm = pi**-0.25 / sqrt(1 + exp(-square) - 2 * exp(-0.75 * square))
        envelope = norm * torch.exp(-(t**2) / 2)
        cosine = torch.cos(self.omega0 * t) - exp(-square / 2)
        return torch.complex(envelope * cosine, envelope * torch.sin(self.omega0 * t))

    @property
    def ridge_number(self) -> float:
        """(w0 + sqrt(w0^2 + 2)) / 2: the maximum over s of s^1/2 exp(-(s w - w0)^2 / 2)."""
        return (self.omega0 + sqrt(self.omega0**2 + 2)) / 2

    @property
    def peak_number(self) -> float:
        """w0: the maximum over w of exp(-(s w - w0)^2 / 2)."""
        return self.omega0

    @property
    def settings(self) -> dict[str, object]:
        """The constructor arguments as plain numbers, for a checkpoint or a file."""
        return super().settings | {"omega0": self.omega0, "magnitude": self.magnitude}

    def output_dtype(self, dtype: torch.dtype) -> torch.dtype:
        """The type of the coefficients of a signal of type `dtype`: complex unless `magnitude`."""
        return dtype if self.magnitude else dtype.to_complex()

    def _result(self, coefficients: Tensor) -> Tensor:
        return coefficients.abs() if self.magnitude else coefficients
