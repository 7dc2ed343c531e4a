"""Damping ratios that stand for a damping law at a stated amplitude, and their other forms.

A force alpha sign(v) |v|^n dissipates per cycle of velocity amplitude V as much as a viscous one with
c_eq = alpha V^(n-1) gamma_n. The ratio belongs to that amplitude and is always stated with it.
"""

from math import pi, sqrt

import torch
from torch import Tensor

FAR = 2.0  # times an amplitude: nearer, no law of damping tells a much different ratio
DAMPING_RATIO = "damping_ratio"  # stands for the coefficient of a model's one damping law
# What helps where a ratio is given to a system or to a law of damping, which have none of their own.
MEANT = dict.fromkeys(
    (DAMPING_RATIO, "damping_ratio_percent", "zeta"),
    "a ratio is what the coefficient of a damping law comes to in a model: give that, or the ratio in "
    "gd.Model.from_config({…, 'viscous_damping': {}, 'damping_law': 'viscous_damping', 'damping_ratio_percent': 2})",
)


def gamma_factor(exponent: Tensor) -> Tensor:
    """gamma_n = (2 / sqrt(pi)) Gamma(n/2 + 1) / Gamma((n + 3)/2); 1 for n = 1, 8/(3 pi) for n = 2."""
    return 2 / sqrt(pi) * torch.exp(torch.lgamma(exponent / 2 + 1) - torch.lgamma((exponent + 3) / 2))


def equivalent_damping_coefficient(coefficient: Tensor, exponent: Tensor, velocity: Tensor) -> Tensor:
    """c_eq in N s/m of a coefficient in N (s/m)^n at a velocity amplitude in m/s."""
    return coefficient * velocity ** (exponent - 1) * gamma_factor(exponent)


def equivalent_damping_ratio(
    coefficient: Tensor, exponent: Tensor, velocity: Tensor, mass: Tensor, stiffness: Tensor
) -> Tensor:
    """Zeta = c_eq / (2 sqrt(k m)) at a velocity amplitude in m/s."""
    return equivalent_damping_coefficient(coefficient, exponent, velocity) / (2 * torch.sqrt(stiffness * mass))


def power_law_coefficient(
    damping_ratio: Tensor, exponent: Tensor, velocity: Tensor, mass: Tensor, stiffness: Tensor
) -> Tensor:
    """Alpha in N (s/m)^n that has an equivalent damping ratio at a velocity amplitude in m/s."""
    per_unit = equivalent_damping_ratio(torch.ones_like(damping_ratio), exponent, velocity, mass, stiffness)
    return damping_ratio / per_unit


def log_decrement(damping_ratio: Tensor) -> Tensor:
    """Delta = 2 pi zeta / sqrt(1 - zeta^2), natural logarithm of the ratio of successive peaks."""
    return 2 * pi * damping_ratio / torch.sqrt(1 - damping_ratio**2)


def is_far(stated: float, start: float) -> bool:
    """Whether a motion that begins at a displacement is far from the amplitude that a ratio is stated at."""
    return bool(start) and not abs(start) / FAR < stated < FAR * abs(start)


def reference_velocity(mean_load: Tensor, mean_stiffness: Tensor, mass: Tensor) -> Tensor:
    """V = omega_n F0 / k0 in m/s, the velocity amplitude that damping ratios are stated at by default."""
    return torch.sqrt(mean_stiffness / mass) * mean_load.abs() / mean_stiffness
