"""Mesh stiffness as the sum of its tooth pairs: trapezoids with smooth edges, a crown and a lean.

A pair at w mesh periods behind its meeting point carries on 0 < w < contact ratio; the pair behind it is at
w - 1. Two pairs therefore carry on the mesh angles [0, 2 pi (contact_ratio - 1)).
"""

from __future__ import annotations

import numpy as np

Arrays = dict[str, np.ndarray]
PLACES = (-1.0, 0.0, 1.0, 2.0)  # pairs that may carry, relative to the one that met last


def smooth_step(u: np.ndarray) -> np.ndarray:
    """0 below u = 0, 1 above u = 1, three continuous derivatives."""
    u = np.clip(u, 0.0, 1.0)
    return u**4 * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u)))


def pair_shape(knobs: Arrays, w: np.ndarray) -> np.ndarray:
    """Share of one pair's full stiffness at w mesh periods from its unloaded meeting point."""
    early = 0.5 * knobs["contact_growth"] * np.abs(knobs["torque"])  # bent teeth meet early and part late
    length = knobs["contact_ratio"] + 2.0 * early
    w = w + early
    share = smooth_step(w / knobs["edge"] + 0.5) - smooth_step((w - length) / knobs["edge"] + 0.5)
    if np.any(knobs["crown"]) or np.any(knobs["lean"]):
        place = 2.0 * w / length - 1.0  # -1 at the meeting point, 1 at the parting point
        share = share * (1.0 + knobs["crown"] * (1.0 / 3.0 - place**2) + knobs["lean"] * place)
    return share


def carrying(knobs: Arrays, mesh_angle: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Places w and shares of the pairs that may carry."""
    turn = mesh_angle / (2.0 * np.pi)
    turn = turn - np.floor(turn)
    longest = np.max(knobs["contact_ratio"] + knobs["contact_growth"] * np.abs(knobs["torque"]) + knobs["edge"])
    places = [turn + place for place in PLACES if place < longest]
    return places, [pair_shape(knobs, w) for w in places]


def of_shares(knobs: Arrays, shares: list[np.ndarray]) -> np.ndarray:
    """Stiffness / (N/m) of the pairs together."""
    return knobs["one_pair"] + (knobs["two_pairs"] - knobs["one_pair"]) * (sum(shares) - 1.0)


def mesh_stiffness(knobs: Arrays, mesh_angle: np.ndarray) -> np.ndarray:
    """k / (N/m) at mesh angles / rad whose last axis is the member."""
    return of_shares(knobs, carrying(knobs, mesh_angle)[1])


def mean_stiffness(knobs: Arrays) -> np.ndarray:
    """Mean over a mesh period / (N/m), by the trapezoidal rule that periodic functions deserve."""
    return mesh_stiffness(knobs, np.linspace(0.0, 2.0 * np.pi, 256, endpoint=False)[:, None]).mean(axis=0)
