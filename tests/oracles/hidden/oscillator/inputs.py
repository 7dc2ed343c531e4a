"""Excitations of an oscillator as functions of natural time, known at every instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

KINDS = ("multisine", "random", "sweep")
RESPONSE = 0.4  # rms of the linear response at level 1


@dataclass(frozen=True)
class Input:
    """sum of `size` cos(`rate` t + `phase`), or a sweep from `rate[0]` to `rate[1]` in `length`, faded in and out."""

    kind: str
    size: np.ndarray
    rate: np.ndarray
    phase: np.ndarray
    length: float

    def __call__(self, t: np.ndarray) -> np.ndarray:
        """The force at natural times."""
        t = np.asarray(t, dtype=float)
        if self.kind == "none":
            return np.zeros_like(t)
        if self.kind == "sweep":
            turn = self.rate[0] * t + 0.5 * (self.rate[1] - self.rate[0]) * t**2 / self.length
            edge = np.clip(np.minimum(t, self.length - t) / (0.05 * self.length), 0.0, 1.0)
            return self.size[0] * np.sin(turn + self.phase[0]) * (0.5 - 0.5 * np.cos(np.pi * edge))
        return sum(s * np.cos(w * t + p) for s, w, p in zip(self.size, self.rate, self.phase, strict=True))


NONE = Input("none", np.zeros(0), np.zeros(0), np.zeros(0), 1.0)


def drawn(kind: str, level: float, zeta: float, length: float, rng: np.random.Generator) -> Input:
    """An excitation whose linear response has an rms of about `level` times RESPONSE."""
    if kind == "sweep":
        rate = np.array([0.4, 1.7])
        mean = np.mean(gain(np.linspace(*rate, 2001), zeta) ** 2)
        size = level * RESPONSE / np.sqrt(0.5 * mean)
        return Input(kind, np.array([size]), rate, rng.uniform(0, 2 * np.pi, 1), length)
    lines = 15 if kind == "multisine" else 80
    band = (0.3, 1.8) if kind == "multisine" else (0.1, 2.4)
    rate = np.linspace(*band, lines) + rng.uniform(-0.4, 0.4, lines) * (band[1] - band[0]) / lines
    raw = np.ones(lines) if kind == "multisine" else rng.rayleigh(1.0, lines)
    scale = level * RESPONSE / np.sqrt(0.5 * np.sum((raw * gain(rate, zeta)) ** 2))
    return Input(kind, raw * scale, rate, rng.uniform(0, 2 * np.pi, lines), length)


def gain(rate: np.ndarray, zeta: float) -> np.ndarray:
    """Of the linear oscillator, displacement over force."""
    return 1.0 / np.abs(1.0 - rate**2 + 2j * zeta * rate)
