"""The rig of every hidden case: teeth, inertias and what follows from them, in SI."""

from __future__ import annotations

import math

TEETH = (20, 40)
MODULE = 3e-3  # m
PRESSURE_ANGLE = math.radians(20.0)
INERTIA = (2.6e-4, 4.5e-3)  # kg m^2
RADIUS = tuple(0.5 * MODULE * z * math.cos(PRESSURE_ANGLE) for z in TEETH)  # base circles / m
MASS = 1.0 / (RADIUS[0] ** 2 / INERTIA[0] + RADIUS[1] ** 2 / INERTIA[1])  # kg, 0.2657
BASE_PITCH = 2.0 * math.pi * RADIUS[0] / TEETH[0]  # m along the line of action


def pitch_point() -> float:
    """Mesh periods from the meeting of a standard pair to the pitch point: path of approach / base pitch."""
    reference, tip = 0.5 * MODULE * TEETH[1], MODULE * (0.5 * TEETH[1] + 1.0)
    root = math.sqrt(tip**2 - RADIUS[1] ** 2) - reference * math.sin(PRESSURE_ANGLE)
    return root / BASE_PITCH


def rpm(speed: float) -> float:
    """Revolutions a minute as rad/s."""
    return speed * math.pi / 30.0
