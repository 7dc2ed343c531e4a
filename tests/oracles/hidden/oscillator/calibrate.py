"""How much of a response a linear oscillator leaves over once it has been calibrated: the excess D of a case.

Stiffness, damping and the gain of the input are fitted to the fit records by output error, with the start and, where
the datum is arbitrary, the offset of every record; held-out records keep the first three and free the others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import cont2discrete, lfilter

from .motion import STEP

EVERY = 5  # steps from one sample that is compared to the next


@dataclass
class Seen:
    """Responses on the steps' own grid: y and force (n,) of each record, which of them are held out."""

    responses: list[np.ndarray]
    forces: list[np.ndarray]
    held_out: list[bool]
    order: int
    offset: bool
    zeta: float


def excess(seen: Seen) -> float:
    """D / %: mean square of what is left of the held-out records, over their variance."""
    if not all(np.all(np.isfinite(y)) and np.max(np.abs(y)) < 1e3 for y in seen.responses):
        return float("inf")
    fitted = [i for i, held in enumerate(seen.held_out) if not held]
    level = np.sqrt(np.mean([np.var(seen.responses[i]) for i in fitted]))

    def left(p: np.ndarray) -> np.ndarray:
        return np.concatenate(_left(seen, fitted, p, None)[0]) / level

    start = np.array([0.0, np.log(seen.zeta)])
    found = least_squares(left, start, x_scale=[1e-2, 0.3], bounds=([-1.5, -9.0], [1.5, 1.0]), max_nfev=60)
    gain = _left(seen, fitted, found.x, None)[1]
    held = [i for i, out in enumerate(seen.held_out) if out] or fitted
    rest = _left(seen, held, found.x, gain)[0]
    return float(100.0 * np.mean(np.concatenate(rest) ** 2) / np.mean([np.var(seen.responses[i]) for i in held]))


def _left(seen: Seen, records: list[int], p: np.ndarray, gain: float | None) -> tuple[list[np.ndarray], float]:
    """What is left of these records when the start, the offset and (where None) the gain are the best."""
    own, driven, y = [], [], []
    for i in records:
        free, forced = linear(np.exp(p[0]), np.exp(p[1]), seen.forces[i], seen.order)
        columns = [free, np.ones((free.shape[0], 1))] if seen.offset else [free]
        basis, _ = np.linalg.qr(np.concatenate(columns, axis=1)[::EVERY])
        for target, kept in ((seen.responses[i][::EVERY], y), (forced[::EVERY], driven)):
            kept.append(target - basis @ (basis.T @ target))
        own.append(basis)
    if gain is None:
        power = sum(d @ d for d in driven)
        gain = float(sum(d @ t for d, t in zip(driven, y, strict=True)) / power) if power > 0.0 else 0.0
    return [t - gain * d for t, d in zip(y, driven, strict=True)], gain


def linear(stiffness: float, zeta: float, force: np.ndarray, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Responses of u'' + 2 zeta u' + stiffness u = force: to unit starts (n, 2), and to the force (n,) from rest."""
    system = np.array([[0.0, 1.0], [-stiffness, -2.0 * zeta]]), np.array([[0.0], [1.0]])
    output = (np.eye(2)[:1], np.eye(2)[1:], system[0][1:])[order], np.array([[1.0 if order == 2 else 0.0]])
    a, b, c, d, _ = cont2discrete((*system, *output), STEP, method="foh")
    poles = np.poly(a)
    n = force.size
    impulse = np.zeros(n)
    impulse[0] = 1.0
    powers = [np.eye(2), a]
    free = np.empty((n, 2))
    for k in range(2):
        first = np.array([float(c[0] @ power[:, k]) for power in powers])
        free[:, k] = lfilter(np.array([first[0], first[1] + poles[1] * first[0]]), poles, impulse)
    h = np.array([d[0, 0], float(c[0] @ b[:, 0]), float(c[0] @ a @ b[:, 0])])
    numerator = np.convolve(h, poles)[:3]
    return free, lfilter(numerator, poles, force)
