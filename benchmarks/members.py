"""The members that every engine simulates, in natural units and in SI, by formulas of this file's own.

    m_e x'' + alpha sign(x') |x'|^n + k(t) g(x) = F,    k(t) = k_0 (1 + sum_h c_h cos(h (theta - centre)))

Natural units: length F / k_0, time sqrt(m_e / k_0). The gear pair is the default one of the package.
"""

from dataclasses import dataclass
from math import cos, pi, radians, sqrt

import numpy as np

SAMPLING_RATE, N_SAMPLES = 40e3, 2000  # 0.05 s
TEETH, MODULE, INERTIAS = (20, 40), 3e-3, (2.6e-4, 4.5e-3)
K_MAX, K_MIN, CONTACT_RATIO, N_HARMONICS = 4e8, 2e8, 1.6, 8
GAP = 1e-4  # m


@dataclass(frozen=True)
class Batch:
    """SI values, each (batch,); `gap` is 0 for a mesh that never opens."""

    torque: np.ndarray
    speed: np.ndarray  # rad/s
    alpha: np.ndarray
    exponent: np.ndarray
    x0: np.ndarray
    gap: float

    @property
    def radii(self) -> tuple[float, float]:
        half = 0.5 * MODULE * cos(radians(20.0))
        return half * TEETH[0], half * TEETH[1]

    @property
    def mass(self) -> float:
        return 1 / sum(r * r / j for r, j in zip(self.radii, INERTIAS, strict=True))

    @property
    def stiffness(self) -> float:
        return (2 - CONTACT_RATIO) * K_MIN + (CONTACT_RATIO - 1) * K_MAX

    @property
    def rate(self) -> float:
        return sqrt(self.stiffness / self.mass)

    @property
    def load(self) -> np.ndarray:
        return self.torque / self.radii[0]  # balanced: the mean torques of both gears

    @property
    def length(self) -> np.ndarray:
        return self.load / self.stiffness

    def natural(self) -> dict[str, np.ndarray]:
        """What an engine needs: y'' + a sign(y')|y'|^n + k g(y) = 1, all arrays (batch,) but `c`."""
        h = np.arange(1, N_HARMONICS + 1)
        half = pi * (CONTACT_RATIO - 1)
        velocity = self.rate * self.length
        return {
            "a": self.alpha * velocity**self.exponent / self.load,
            "n": self.exponent,
            "w": TEETH[0] * self.speed / self.rate,
            "phase": np.full_like(self.torque, -half),
            "y0": self.x0 / self.length,
            "gap": self.gap / self.length,
            "c": 2 * (K_MAX - K_MIN) / (h * pi) * np.sin(h * half) / self.stiffness,
            "t": np.arange(N_SAMPLES) / SAMPLING_RATE * self.rate,
        }

    def first(self, count: int) -> "Batch":
        return Batch(*(getattr(self, name)[:count] for name in ARRAYS), self.gap)


ARRAYS = ("torque", "speed", "alpha", "exponent", "x0")


def draw(batch: int, backlash: bool = False, seed: int = 0) -> Batch:
    """A batch; the first members are the same in every batch.

    Smooth: damping ratio 0.2 to 3 %, exponent 1.2 to 2.8. Backlash: starts so far from equilibrium that
    every member loses contact.
    """
    shares = np.random.default_rng(seed).random((batch, 5)).T
    torque, speed = 120 + 60 * shares[0], (3000 + 3000 * shares[1]) * pi / 30
    base = Batch(torque, speed, torque * 0, torque * 0, torque * 0, GAP if backlash else 0.0)
    exponent = np.full(batch, 2.0) if backlash else 1.2 + 1.6 * shares[2]
    ratio = 0.002 + 0.028 * shares[3]
    # Linear damping of this ratio at the velocity amplitude V = rate * length: alpha V^n ~ c V.
    velocity = base.rate * base.length
    alpha = 2 * ratio * sqrt(base.mass * base.stiffness) * velocity ** (1 - exponent)
    start = 2.2 + 0.8 * shares[4] if backlash else 0.9 + 0.2 * shares[4]
    return Batch(torque, speed, alpha, exponent, start * base.length, base.gap)
