"""Floquet multipliers of m x'' + c x' + k(t) x = 0 over one period: stable inside the unit circle."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from gear_case import GearCase
from gear_terms import Piece, break_times
from scipy.integrate import solve_ivp
from scipy.linalg import expm


def monodromy(
    mass: float,
    damping: float,
    stiffness: Callable[[float], float],
    period: float,
    breaks: Sequence[float] = (),
) -> np.ndarray:
    """Map (2, 2) of (x / m, v / (m/s)) over one period by DOP853, restarted at the `breaks` / s."""
    scale = np.sqrt(stiffness(0.5 * period) / mass)

    def derivative(t: float, y: np.ndarray) -> np.ndarray:
        x, u = y.reshape(2, 2)  # both columns at once; u = v / scale, so that one tolerance fits both
        return np.concatenate([scale * u, -(stiffness(t) / mass * x / scale + damping / mass * u)])

    state, edges = np.eye(2).ravel(), [0.0, *breaks, period]
    for start, stop in pairwise(edges):
        inside = start + (stop - start) * 1e-12, stop - (stop - start) * 1e-12

        def piece(t: float, y: np.ndarray, inside: tuple[float, float] = inside) -> np.ndarray:
            return derivative(min(max(t, inside[0]), inside[1]), y)

        state = solve_ivp(piece, (start, stop), state, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    units = np.diag([1.0, scale])
    return units @ state.reshape(2, 2) @ np.linalg.inv(units)


def floquet_multipliers(
    mass: float,
    damping: float,
    stiffness: Callable[[float], float],
    period: float,
    breaks: Sequence[float] = (),
) -> np.ndarray:
    """The two multipliers, complex, the larger in magnitude first."""
    values = np.linalg.eigvals(monodromy(mass, damping, stiffness, period, breaks)).astype(complex)
    return values[np.argsort(-np.abs(values), kind="stable")]


def stepwise_multipliers(mass: float, damping: float, segments: Sequence[tuple[float, float]]) -> np.ndarray:
    """Exact multipliers for a stiffness constant by segments (duration / s, N/m): matrix exponentials."""
    total = np.eye(2)
    for duration, stiffness in segments:
        total = expm(np.array([[0.0, 1.0], [-stiffness / mass, -damping / mass]]) * duration) @ total
    values = np.linalg.eigvals(total).astype(complex)
    return values[np.argsort(-np.abs(values), kind="stable")]


def mesh_multipliers(case: GearCase, damping_ratio: float) -> np.ndarray:
    """Multipliers over a mesh period of a case's k(t), its damping replaced by viscous damping of this ratio.

    The stiffness must have the mesh period: no shaft-order modulation.
    """
    if case.pinion_stiffness_modulation[0] or case.gear_stiffness_modulation[0]:
        raise ValueError("a shaft-order stiffness modulation does not repeat each mesh period")
    damping = 2.0 * damping_ratio * np.sqrt(case.mean_stiffness * case.mass)
    breaks = break_times(case, case.mesh_period) if case.stiffness_form == "rectangular" else []
    if case.stiffness_form == "fourier":
        return floquet_multipliers(case.mass, damping, Piece(case, 0.0).stiffness, case.mesh_period)
    return floquet_multipliers(case.mass, damping, lambda t: Piece(case, t).stiffness(t), case.mesh_period, breaks)
