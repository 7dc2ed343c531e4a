"""Sliding friction of the flanks: its direction follows from where a pair is, not from the sign of x'."""

from __future__ import annotations

import math

import numpy as np

TURN_WIDTH = 0.01  # mesh periods over which the direction of sliding turns at the pitch point


def friction_factor(knobs: dict[str, np.ndarray], at, places: list[np.ndarray], shares: list[np.ndarray]):
    """Mesh force with friction over that without: 1 - mu sum_i sh_i s_i L_i.

    Each pair carries in proportion to its stiffness; s_i = 1 before the pitch point and -1 behind it, turning
    along an arc tangent; L_i = m_e (r_b1 rho_1 / I1 + r_b2 rho_2 / I2) with the radii of curvature rho.
    """
    total, arms = sum(shares), 0.0
    for w, share in zip(places, shares, strict=True):
        beyond = w - knobs["pitch_point"]
        direction = -2.0 / math.pi * np.arctan(beyond / TURN_WIDTH)
        arms = arms + share * direction * lever_arm(beyond * knobs["base_pitch"], knobs)
    return 1.0 - knobs["friction"] * np.sign(at.speed) * arms / total


def lever_arm(beyond: np.ndarray, knobs: dict[str, np.ndarray | float]) -> np.ndarray:
    """L at a contact this far beyond the pitch point along the line of action / m; tan(a) at the pitch point."""
    slope = knobs["pressure_slope"]
    rho = knobs["radius_1"] * slope + beyond, knobs["radius_2"] * slope - beyond
    shafts = ((knobs[f"radius_{i}"], arm, knobs[f"inertia_{i}"]) for i, arm in enumerate(rho, 1))
    return knobs["joint_mass"] * sum(r * arm / i for r, arm, i in shafts)
