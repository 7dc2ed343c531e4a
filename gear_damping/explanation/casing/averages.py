"""The classical quantities of gear diagnostics: synchronous averages, FM4, kurtosis and envelope by revolution.

Stewart (1977) for FM4; Zakrajsek, Townsend & Decker (1993), NASA TM-105950, for NA4; McFadden (1986), J. Vib.
Acoust. 108, for the demodulation about a mesh harmonic. Their limits come from sound gears with the same spectrum.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gear_damping.explanation.casing.cycles import Patterns, series
from gear_damping.explanation.casing.localised import RUNOUT
from gear_damping.explanation.statistics.bursts import kurtosis

Array = NDArray[np.float64]
FM4_DRAWS = 300  # surrogates of random phases: the 99 % quantile of them then rests on three
LIMIT = 0.99  # quantile of these, 1 in 100 by chance


@dataclass(frozen=True, eq=False)
class Average:
    """The synchronous average of a shaft over one turn.

    Args:
        turn: (n,) turns of the shaft.
        values: (n,) average with the mesh in it, in the unit of the acceleration.
        residual: (n,) the same without the mesh.
        fm4: Kurtosis of the residual without runout.
        fm4_limit: Its 99 % point in sound gears with the same spectrum.
    """

    turn: Array
    values: Array
    residual: Array
    fm4: float
    fm4_limit: float


@dataclass(frozen=True, eq=False)
class Modulation:
    """What the strongest mesh harmonic does over a turn of a shaft.

    Args:
        harmonic: Of the mesh.
        amplitude: (teeth,) relative deviation of its amplitude, tooth by tooth.
        phase: (teeth,) deviation of its phase in rad.
    """

    harmonic: int
    amplitude: Array
    phase: Array


def average(found: Patterns, shaft: str) -> Average:
    """The synchronous average of a shaft."""
    teeth = found.teeth[0] if shaft == "pinion" else found.teeth[1]
    pattern = found.shaft(shaft)
    residual = series(pattern, teeth)
    rng = np.random.default_rng(3)
    drawn = []
    for _ in range(FM4_DRAWS):
        phase = np.exp(2j * np.pi * rng.random(len(pattern)))
        phase[-1] = phase[-1] if teeth % 2 else np.sign(phase[-1].real)
        drawn.append(kurtosis(series(pattern * phase[:, None], teeth, RUNOUT + 1).ravel()))
    turn = np.arange(residual.size) / residual.size
    fm4 = kurtosis(series(pattern, teeth, RUNOUT + 1).ravel())
    return Average(turn, (residual + found.mesh).ravel(), residual.ravel(), fm4, float(np.quantile(drawn, LIMIT)))


def by_revolution(found: Patterns) -> tuple[Array, float]:
    """Kurtosis of each turn of the pinion without the mesh, and the 99 % point for noise of that length."""
    values, z1 = found.without_mesh(), found.teeth[0]
    turns = found.cycles // z1
    whole = values[: turns * z1].reshape(turns, -1)
    return np.array([kurtosis(turn) for turn in whole]), 3 + 2.33 * float(np.sqrt(24 / whole.shape[1]))


def modulation(cut: Array, teeth: tuple[int, int], shaft: str) -> Modulation:
    """Amplitude and phase of the strongest mesh harmonic, averaged over the turns of a shaft."""
    lines = np.fft.rfft(cut, axis=1)
    harmonic = int(np.argmax(np.abs(lines.mean(0))[1:])) + 1
    line = lines[:, harmonic]
    count = teeth[0] if shaft == "pinion" else teeth[1]
    turns = len(line) // count
    own = line[: turns * count].reshape(turns, count)
    relative = own / np.abs(own).mean(1, keepdims=True)
    amplitude = np.abs(relative).mean(0)
    carrier = own.mean(1, keepdims=True)
    phase = np.angle((own * carrier.conj()).mean(0))
    return Modulation(harmonic, amplitude - amplitude.mean(), phase - phase.mean())


def envelope_orders(found: Patterns, shafts: dict[str, float]) -> dict[str, float]:
    """Relative amplitude of the squared envelope of all that is not mesh, at the first order of each shaft."""
    number = np.arange(found.cycles)
    energy = (found.without_mesh() ** 2).mean(1)
    window = np.hanning(len(energy))
    mean = float((energy * window).sum())
    return {
        name: 2 * float(np.abs(np.sum(energy * window * np.exp(-2j * np.pi * order / found.teeth[0] * number)))) / mean
        for name, order in shafts.items()
    }
