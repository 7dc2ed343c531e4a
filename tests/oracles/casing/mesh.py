"""Tooth pairs in contact: their stiffness and their errors at every instant of a record."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Gears:
    """A gear pair as it was made, in SI.

    Args:
        teeth: Of pinion and gear.
        mass: Equivalent mass on the line of action / kg.
        damping_ratio: Of the mean mesh.
        pair_stiffness: Of one tooth pair in the middle of its contact / N/m.
        contact_ratio: Mesh periods that a pair carries.
        edge: Mesh periods over which a pair comes in or goes out.
        load: Static mesh force / N.
        pitch: Errors of the single teeth / m, one array a shaft.
        profile: Error common to all teeth / m at the first three harmonics of the contact.
        runout: Amplitude and phase of either shaft's runout, (m, rad).
        first: Gear tooth that meets pinion tooth 0 at the start.
        crack: Share of its stiffness that one tooth has lost.
        cracked: Shaft (0 pinion, 1 gear) and number of that tooth.
    """

    teeth: tuple[int, int]
    mass: float
    damping_ratio: float
    pair_stiffness: float
    contact_ratio: float
    edge: float
    load: float
    pitch: tuple[Array, Array]
    profile: Array
    runout: tuple[tuple[float, float], tuple[float, float]]
    first: int = 0
    crack: float = 0.0
    cracked: tuple[int, int] = (0, 0)


def ramp(u: Array) -> Array:
    """0 below -1/2, 1 above 1/2, a half cosine between."""
    return 0.5 - 0.5 * np.cos(np.pi * np.clip(u + 0.5, 0.0, 1.0))


def stiffness_and_drive(gears: Gears, turn: Array) -> tuple[Array, Array]:
    """Mesh stiffness / (N/m) and the force that the errors exert / N, at pinion angles in turns."""
    cycle = turn * gears.teeth[0]
    whole = np.floor(cycle).astype(int)
    stiffness, drive = np.zeros_like(cycle), np.zeros_like(cycle)
    runout = sum(
        size * np.cos(2 * np.pi * turn * gears.teeth[0] / gears.teeth[shaft] + phase)
        for shaft, (size, phase) in enumerate(gears.runout)
    )
    for behind in (-1, 0, 1, 2):
        place = cycle - whole + behind  # mesh periods since this pair met
        share = ramp(place / gears.edge) - ramp((place - gears.contact_ratio) / gears.edge)
        middle = 2 * place / gears.contact_ratio - 1
        pair = (whole - behind) % gears.teeth[0], (whole - behind + gears.first) % gears.teeth[1]
        own = gears.pair_stiffness * share * (1 - 0.15 * middle**2)
        shaft, tooth = gears.cracked
        own = own * np.where(pair[shaft] == tooth, 1 - gears.crack, 1.0)
        error = gears.pitch[0][pair[0]] + gears.pitch[1][pair[1]] + runout
        for harmonic, size in enumerate(gears.profile, start=1):
            error = error + size * np.cos(np.pi * harmonic * middle)
        stiffness += own
        drive += own * error
    return stiffness, drive


def mean_stiffness(gears: Gears) -> float:
    """N/m over a mesh period of sound teeth."""
    turn = np.arange(400) / 400 / gears.teeth[0]
    return float(stiffness_and_drive(gears, turn + 3 / gears.teeth[0])[0].mean())
