"""How right the figures are once the name is: parameters that mean the same in truth and answer, and the misfit."""

from __future__ import annotations

import statistics
from collections.abc import Iterable
from typing import Any

from .judge import Case, established, names

# effect -> its parameter in the answer and in the truth, where both have the same meaning and unit
SAME = {
    "pinion_eccentricity": ("amplitude", "amplitude"), "gear_eccentricity": ("amplitude", "amplitude"),
    "pinion_stiffness_modulation": ("amplitude", "amplitude"),
    "gear_stiffness_modulation": ("amplitude", "amplitude"), "coulomb_friction": ("force", "force"),
    "cubic_stiffness": ("coefficient", "coefficient"), "hertz_stiffness": ("exponent", "exponent"),
    "windage_drag": ("coefficient", "coefficient"), "sensor_offset": ("offset", "offset"),
    "sensor_drift": ("rate", "rate"), "sensor_delay": ("delay", "delay"), "backlash": ("gap", "gap"),
    "power_law_damping": ("exponent", "exponent"), "profile_error": ("amplitudes[0]", "amplitudes"),
}  # fmt: skip


def errors(cases: Iterable[Case]) -> list[tuple[float, bool]]:
    """Relative error of each named effect's parameter, and whether its 95 % interval holds the truth."""
    return [pair for case in cases for pair in _of(case)]


def _of(case: Case) -> list[tuple[float, bool]]:
    found = []
    for effect in case["truth"]["effects"]:
        cause = next((c for c in case["answer"]["causes"] if c["name"] == effect["name"]), None)
        if cause is None or effect["name"] not in SAME or effect["name"] not in established(case["answer"]):
            continue
        said, true = SAME[effect["name"]]
        value = effect["parameters"][true]
        value = value[0] if isinstance(value, list) else value
        if said in cause["parameters"]:
            stated = cause["parameters"][said]
            low, high = sorted(_signed(v, value, effect["name"]) for v in stated["interval95"])
            error = abs(_signed(stated["value"], value, effect["name"]) / value - 1)
            found.append((error, low <= value <= high))
    return found


def _signed(stated: float, true: float, name: str) -> float:
    """An amplitude may be negative with its phase turned by half."""
    turns = name.endswith(("eccentricity", "modulation", "profile_error"))
    return stated * (-1 if turns and stated * true < 0 else 1)


def misfits(cases: Iterable[Case]) -> dict[str, Any]:
    """Held-out misfit over the noise floor after the extension, of singles that were named, by noise level."""
    by_level: dict[str, list[float]] = {}
    for case in cases:
        if case["stratum"] == "single" and names(case)[-1] in established(case["answer"]):
            level = min((20, 30, 40), key=lambda db: abs(case["truth"]["snr_db"] - db))
            by_level.setdefault(f"{level} dB", []).append(case["answer"]["misfit"]["after"])
    return {
        level: {"n": len(values), "median": statistics.median(values), "largest": max(values)}
        for level, values in sorted(by_level.items())
    }
