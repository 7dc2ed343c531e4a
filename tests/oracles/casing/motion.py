"""The dynamic mesh force: a linear equation with a stiffness that varies, stepped by Runge-Kutta propagators.

y' = M(t) y + b(t) is linear, so a step of the classical fourth-order method is one matrix. Products of the steps'
matrices are formed in many blocks side by side, which makes a record of 300 000 steps a matter of a second.
"""

from __future__ import annotations

import numpy as np

from .mesh import Array, Gears, mean_stiffness, stiffness_and_drive


def mesh_force(gears: Gears, turn: Array, load: Array, step: float) -> Array:
    """Fluctuating mesh force / N at every second angle.

    Args:
        gears: The pair.
        turn: (2 n + 1,) pinion angles in turns at every half step.
        load: (2 n + 1,) static mesh force / N at the same places.
        step: Seconds.
    """
    stiffness, drive = stiffness_and_drive(gears, turn)
    mean = mean_stiffness(gears)
    damping = 2 * gears.damping_ratio * np.sqrt(mean * gears.mass)
    rate, push = -stiffness / gears.mass, (load + drive) / gears.mass
    steps = _propagators(rate, -damping / gears.mass, push, step)
    start = np.array([gears.load / mean, 0.0, 1.0])
    states = _scan(steps, start)
    displacement, velocity = states[:, 0], states[:, 1]
    acceleration = rate[::2] * displacement - damping / gears.mass * velocity + push[::2]
    return -gears.mass * acceleration


def _propagators(rate: Array, drag: float, push: Array, step: float) -> Array:
    """(n, 3, 3): one step of RK4 for (x, v, 1)."""
    slope = np.zeros((len(rate), 3, 3))
    slope[:, 0, 1], slope[:, 1, 0], slope[:, 1, 1], slope[:, 1, 2] = 1.0, rate, drag, push
    first, middle, last = slope[:-2:2], slope[1::2], slope[2::2]
    one = np.eye(3)
    k1 = first
    k2 = middle @ (one + step / 2 * k1)
    k3 = middle @ (one + step / 2 * k2)
    k4 = last @ (one + step * k3)
    return one + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def _scan(steps: Array, start: Array) -> Array:
    """(n + 1, 3): the states that the steps lead to."""
    count = len(steps)
    length = int(np.ceil(np.sqrt(count)))
    padded = np.concatenate([steps, np.broadcast_to(np.eye(3), (-count % length, 3, 3))])
    blocks = padded.reshape(-1, length, 3, 3)
    products = np.empty_like(blocks)
    products[:, 0] = blocks[:, 0]
    for i in range(1, length):
        products[:, i] = blocks[:, i] @ products[:, i - 1]
    states, state = [], start
    for block in products:
        own = block @ state
        states.append(own)
        state = own[-1]
    return np.concatenate([start[None], np.concatenate(states)[:count]])
