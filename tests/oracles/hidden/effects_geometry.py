"""Hidden errors of the gears: what turns with a shaft or sits on a tooth."""

from __future__ import annotations

import numpy as np

from . import pair
from .effect import Effect, Params, phase
from .knobs import N_PROFILE, Knobs

SHAFTS = ("pinion", "gear")


def _runout(shaft: str) -> Effect:
    return Effect(
        f"{shaft}_eccentricity", lambda rng, T: {"amplitude": 4e-5, "phase": phase(rng)},
        lambda p, record: {f"{shaft}_runout": p["amplitude"], f"{shaft}_runout_phase": p["phase"]}, {"amplitude": 1},
    )  # fmt: skip


def _modulation(shaft: str) -> Effect:
    return Effect(
        f"{shaft}_stiffness_modulation", lambda rng, T: {"amplitude": 0.15, "phase": phase(rng)},
        lambda p, record: {f"{shaft}_modulation": p["amplitude"], f"{shaft}_modulation_phase": p["phase"]},
        {"amplitude": 1},
    )  # fmt: skip


def _profile(rng, duration) -> Params:
    sizes = 1.2e-5 * np.array([1.0, rng.uniform(0.2, 0.6), rng.uniform(0.0, 0.3)])
    return {"amplitudes": [float(size) for size in sizes], "phases": [phase(rng) for _ in sizes]}


def _turn_profile(p: Params, record: Knobs) -> Knobs:
    def padded(values):
        return np.pad(np.asarray(values, dtype=float), (0, N_PROFILE - len(values)))

    return {"profile": padded(p["amplitudes"]), "profile_phase": padded(p["phases"])}


def _pitch(rng, duration) -> Params:
    return _pitch_of(pair.TEETH[0], rng)


def _pitch_of(count: int, rng) -> Params:
    """One deviation a tooth; mean and first order are no pitch error and are taken out."""
    lines = np.fft.rfft(rng.normal(size=count))
    lines[:2] = 0.0
    values = np.fft.irfft(lines, count)
    values *= 1.5e-5 / np.std(values)
    handover = float(rng.uniform(0.4, 0.8))
    return {"values": [float(v) for v in values], "phase": 0.0, "handover": handover}


def _pitch_on(rng, rig: pair.Rig) -> Params:
    shaft = int(rng.integers(2))
    return {"shaft": SHAFTS[shaft]} | _pitch_of(rig.teeth[shaft], rng)


def _turn_pitch(p: Params, record: Knobs) -> Knobs:
    found = {"pitch": np.asarray(p["values"]), "pitch_phase": p["phase"], "handover": p["handover"]}
    return found | {"pitch_on_gear": float(p.get("shaft") == "gear")}


def crack_area(teeth: float) -> float:
    """Shaft angle / rad under the raised cosine, per contact ratio."""
    return 2.0 * np.pi / teeth * 0.5


GEOMETRY = (
    _runout("pinion"),
    _runout("gear"),
    _modulation("pinion"),
    _modulation("gear"),
    Effect("profile_error", _profile, _turn_profile, {"amplitudes": 1}),
    Effect(
        "pitch_error", _pitch, _turn_pitch, {"values": 1}, on_rig=_pitch_on,
    ),
    Effect(
        "tooth_crack", lambda rng, T: {"depth": 0.6, "phase": phase(rng)},
        lambda p, record: {"crack": p["depth"], "crack_phase": p["phase"],
                           "crack_on_gear": float(p.get("shaft") == "gear")},
        {"depth": 1}, on_rig=lambda rng, rig: {"shaft": SHAFTS[int(rng.integers(2))]},
    ),
)  # fmt: skip
