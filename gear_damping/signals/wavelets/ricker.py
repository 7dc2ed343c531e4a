"""The Ricker wavelet, the second derivative of a Gaussian: the paper's."""

from math import pi, sqrt

import torch
from torch import Tensor

from gear_damping.signals.wavelets.base import ContinuousWavelet


class RickerCWT(ContinuousWavelet):
    """Transform by the Ricker wavelet psi(t) = 2 / (sqrt(3) pi^(1/4)) (1 - t^2) exp(-t^2 / 2): real.

    The arguments are those of `ContinuousWavelet`.
    """

    name = "ricker"

    def mother(self, t: Tensor) -> Tensor:
        """The Ricker wavelet at times t (in scales)."""
        return 2 / (sqrt(3) * pi**0.25) * (1 - t**2) * torch.exp(-(t**2) / 2)

    @property
    def ridge_number(self) -> float:
        """sqrt(5/2): the maximum over s of s^1/2 (s w)^2 exp(-(s w)^2 / 2)."""
        return sqrt(5 / 2)

    @property
    def peak_number(self) -> float:
        """sqrt(2): the maximum over w of (s w)^2 exp(-(s w)^2 / 2)."""
        return sqrt(2)
