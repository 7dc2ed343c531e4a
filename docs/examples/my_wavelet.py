"""A wavelet of one's own: the fourth derivative of a Gaussian, narrower in frequency than the Ricker."""

from math import gamma, sqrt

import torch
from torch import Tensor

from gear_damping.signals.wavelets import ContinuousWavelet


class FourthDerivative(ContinuousWavelet):
    """psi(t) = Gamma(9/2)^(-1/2) (t^4 - 6 t^2 + 3) exp(-t^2 / 2): real."""

    name = "fourth_derivative"

    def mother(self, t: Tensor) -> Tensor:
        """The wavelet at times t (in scales)."""
        return (t**4 - 6 * t**2 + 3) * torch.exp(-(t**2) / 2) / sqrt(gamma(4.5))

    @property
    def ridge_number(self) -> float:
        """sqrt(9/2): the maximum over s of s^1/2 (s w)^4 exp(-(s w)^2 / 2)."""
        return sqrt(4.5)

    @property
    def peak_number(self) -> float:
        """2: the maximum over w of (s w)^4 exp(-(s w)^2 / 2)."""
        return 2.0
