"""Mesh stiffness as a truncated Fourier series of the rectangular wave."""

from functools import cache
from math import pi
from typing import ClassVar

import numpy as np
import torch
from torch import Tensor

from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.terms import MeshStiffness, Values

LONGEST_POLYNOMIAL = 12  # harmonics; the powers of longer series cancel too much
RESOLVED = 0.08  # share of the highest harmonic's rate that steps follow: it is small (measured by step halving)


class FourierMeshStiffness(MeshStiffness):
    """Two tooth pairs carry on the mesh angle 0 … 2 pi (contact_ratio - 1), one pair elsewhere."""

    name = "fourier_mesh_stiffness"
    equation = (
        "k = k_mean + sum_h w_h sinc(h edge) 2 (k_max - k_min) / (h pi) "
        "sin(h pi (eps - 1)) cos(h (theta_M - pi (eps - 1)))"
    )
    reference = "Kahraman & Singh (1991), J. Sound Vib. 146(1)"
    parameters: ClassVar = (
        Parameter("maximum", "N/m", 4e8, "stiffness with two tooth pairs in contact", 0, 1e14, "paper"),
        Parameter("minimum", "N/m", 2e8, "stiffness with one tooth pair in contact", 0, 1e14, "paper"),
        Parameter("contact_ratio", "1", 1.6, "contact ratio", 1.0, 2.0, "paper"),
        Parameter("edge", "1", 0.0, "share of a mesh period over which a pair takes up its load", 0, 0.5),
    )
    options: ClassVar = (
        Option("n_harmonics", tuple(range(1, 33)), 8, "harmonics of the mesh frequency"),
        Option("weighting", ("plain", "lanczos"), "plain", "lanczos: sinc(h / (H + 1)) against the Gibbs overshoot"),
    )

    def mean(self, values: Values) -> Tensor:
        """Mean over a mesh period."""
        return values["minimum"] + (values["maximum"] - values["minimum"]) * (values["contact_ratio"] - 1)

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The series about its centre of symmetry; if short, as a polynomial in the cosine there."""
        half = pi * (values["contact_ratio"] - 1)
        centre = half - base["contact_lead"]
        order = torch.arange(1, self.chosen["n_harmonics"] + 1, dtype=centre.dtype, device=centre.device)
        swing = 2 * (values["maximum"] - values["minimum"]) / pi
        series = self._weights(order) / order.unsqueeze(1) * torch.sin(order.unsqueeze(1) * half) * swing
        series = series * torch.sinc(order.unsqueeze(1) * values["edge"])
        coefficients = torch.cat([self.mean(values).unsqueeze(0), series])
        if self._is_short:
            coefficients = _chebyshev_to_powers(self.chosen["n_harmonics"]).to(coefficients) @ coefficients
        highest = self.chosen["n_harmonics"] * base["n_teeth_pinion"] * base["pinion_speed"].abs()
        return {
            "coefficients": coefficients,
            "centre_cos": torch.cos(centre),
            "centre_sin": torch.sin(centre),
            "fastest_rate": RESOLVED * highest,
        }

    def stiffness(self, at: Kinematics, p: Values) -> Tensor:
        """Horner's rule in cos(theta_M - centre), Clenshaw's recurrence for long series."""
        cosine = at.mesh.cos * p["centre_cos"] + at.mesh.sin * p["centre_sin"]
        first, *others = p["coefficients"].unbind(0)
        if self._is_short:
            total = others[-1]
            for coefficient in (*others[-2::-1], first):
                total = total * cosine + coefficient
            return total
        last, before = torch.zeros_like(cosine), torch.zeros_like(cosine)
        for coefficient in reversed(others):
            last, before = coefficient + 2 * cosine * last - before, last
        return first + cosine * last - before

    @property
    def _is_short(self) -> bool:
        return self.chosen["n_harmonics"] <= LONGEST_POLYNOMIAL

    def _weights(self, order: Tensor) -> Tensor:
        if self.chosen["weighting"] == "plain":
            return torch.ones_like(order).unsqueeze(1)
        return torch.sinc(order / (self.chosen["n_harmonics"] + 1)).unsqueeze(1)


@cache
def _chebyshev_to_powers(degree: int) -> Tensor:
    """Column h holds the power coefficients of cos(h x) as a polynomial in cos(x)."""
    columns = [np.polynomial.chebyshev.cheb2poly(np.eye(degree + 1)[h]) for h in range(degree + 1)]
    padded = [np.pad(column, (0, degree + 1 - len(column))) for column in columns]
    return torch.as_tensor(np.stack(padded, axis=1))
