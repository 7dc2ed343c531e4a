"""Butcher's sixth-order Runge-Kutta step with seven stages (J. Austral. Math. Soc. 4, 1964)."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction as F

import numpy as np

NODES = np.array([0.0, 1 / 3, 1 / 2, 2 / 3, 1.0])  # instants within a step at which forces are asked for
AT_NODE = (0, 1, 3, 1, 2, 2, 4)  # the node of each stage
_ROWS = (
    (),
    (F(1, 3),),
    (F(0), F(2, 3)),
    (F(1, 12), F(1, 3), F(-1, 12)),
    (F(-1, 16), F(9, 8), F(-3, 16), F(-3, 8)),
    (F(0), F(9, 8), F(-3, 8), F(-3, 4), F(1, 2)),
    (F(9, 44), F(-9, 11), F(63, 44), F(18, 11), F(0), F(-16, 11)),
)
STAGES = [np.array([float(a) for a in row]) for row in _ROWS]
WEIGHTS = np.array([11 / 120, 0.0, 27 / 40, 27 / 40, -4 / 15, -4 / 15, 11 / 120])

Rates = Callable[[int, np.ndarray], np.ndarray]


def step(rates: Rates, y: np.ndarray, h: float | np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """The state one step on.

    rates(node, y): the derivative at NODES[node] of the step. h: scalar, or one for each of the last axis.
    slopes: room for (7, *y.shape); slopes[0] is left holding the derivative at the start.
    """
    flat = slopes.reshape(7, -1)
    slopes[0] = rates(0, y)
    for stage in range(1, 7):
        moved = (STAGES[stage] @ flat[:stage]).reshape(y.shape)
        moved *= h
        moved += y
        slopes[stage] = rates(AT_NODE[stage], moved)
    return y + h * (WEIGHTS @ flat).reshape(y.shape)
