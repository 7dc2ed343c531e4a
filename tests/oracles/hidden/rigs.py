"""Rigs that are not the usual one: steel discs whose teeth, size and stiffness are drawn."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from .effect import between
from .pair import USUAL, Rig

PINIONS, GEARS = (17, 20, 25, 37), (43, 53)
STEEL = 7850.0  # kg/m^3
PAIR_STIFFNESS = 6.7e9  # N/m per metre of face width
BAND = (1500.0, 8000.0)  # Hz


def rig_of(wanted: str | Rig | None, rng: np.random.Generator) -> Rig:
    """The usual rig where None; `drawn`; `usual` with faults on either shaft; or teeth such as `25/47`."""
    if wanted is None or isinstance(wanted, Rig):
        return wanted or USUAL
    if wanted == "usual":
        return replace(USUAL, either_shaft=True)
    while True:
        teeth = int(rng.choice(PINIONS)), int(rng.integers(GEARS[0], GEARS[1] + 1))
        if wanted != "drawn":
            teeth = tuple(int(count) for count in wanted.split("/"))
        rig = _drawn(teeth, rng)
        if BAND[0] < rig.natural_frequency < BAND[1]:
            samples = rng.uniform(8.0, 12.0) if rng.random() < 0.7 else rng.uniform(12.0, 20.0)
            return replace(rig, rate=float(100.0 * round(samples * rig.natural_frequency / 100.0)))


def _drawn(teeth: tuple[int, int], rng: np.random.Generator) -> Rig:
    module = 1e-3 * float(rng.choice([2.0, 2.5, 3.0, 4.0, 5.0]))
    width = module * rng.uniform(8.0, 14.0)
    discs = [disc(0.5 * module * count, width) for count in teeth]
    inertia = discs[0] * rng.uniform(0.9, 1.5), discs[1] * rng.uniform(0.6, 1.0)  # a shaft, a web
    middle = rng.uniform(1.45, 1.75)
    return Rig(
        teeth=teeth, module=module, pressure_angle=math.radians(float(rng.choice([20.0, 25.0]))),
        inertia=tuple(float(i) for i in inertia), one_pair=float(PAIR_STIFFNESS * width * rng.uniform(0.7, 1.2)),
        contact_ratio=(middle - 0.05, middle + 0.05), deflection=between(rng, 0.6, 1.6), either_shaft=True,
    )  # fmt: skip


def disc(radius: float, width: float) -> float:
    """Inertia of a steel disc / (kg m^2)."""
    return 0.5 * STEEL * math.pi * width * radius**4
