"""Everything the truth can contain as one flat set of numbers, each with the value at which it is absent.

A member is one record's motion: one value of every knob. Members are stacked to arrays (member,) or (entry, member).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from . import pair

N_PROFILE, N_IMPACTS = 6, 12  # entries of the vector knobs
Knobs = dict[str, float | np.ndarray]

NEUTRAL: Knobs = {
    # where the shafts are: angle + speed t + wander; what the motion follows wobbles when an angle is misread
    "angle": 0.0, "speed": pair.rpm(4600.0), "wander": 0.0, "wander_rate": 1.0, "wander_phase": 0.0,
    "wobble": 0.0, "wobble_phase": 0.0, "mesh_phase": 0.0, "gear_phase": 0.0,
    # the rig: teeth, base circles / m, inertias / (kg m^2), and what follows from them
    **pair.USUAL.knobs(),
    # linear mesh: pair stiffness one_pair, two pairs two_pairs; edge, crown and lean shape it
    "mass": pair.MASS, "one_pair": 2e8, "two_pairs": 4e8, "contact_ratio": 1.6, "edge": 0.1, "crown": 0.0,
    "lean": 0.0, "viscous": 0.0, "contact_growth": 0.0, "warming": 0.0, "warmed": 0.0,
    # measured load: torque (1 + flutter cos) + swing cos; the gear's follows (balanced) or stands (held)
    "torque": 150.0, "flutter": 0.0, "flutter_rate": 1.0, "flutter_phase": 0.0,
    "swing": 0.0, "swing_rate": 1.0, "swing_phase": 0.0, "held": 0.0,
    # loads that no channel shows
    "ripple": 0.0, "ripple_share": 0.0, "ripple_order": 1.0, "ripple_phase": 0.0,
    "slow": 0.0, "slow_rate": 1.0, "slow_phase": 0.0, "ramp": 0.0, "ramp_start": 0.0, "ramp_end": 1.0,
    "windage": 0.0, "belt": 0.0, "belt_order": 0.37, "belt_phase": 0.0,
    "impact_times": np.full(N_IMPACTS, -1.0), "impact_force": 0.0, "impact_width": 2e-4,
    "load_noise": 0.0, "feedback": 0.0, "feedback_delay": 1e-4,
    # geometry
    "pinion_runout": 0.0, "pinion_runout_phase": 0.0, "gear_runout": 0.0, "gear_runout_phase": 0.0,
    "profile": np.zeros(N_PROFILE), "profile_phase": np.zeros(N_PROFILE),
    "pitch": np.zeros(pair.MOST_TEETH), "pitch_phase": 0.0, "pitch_on_gear": 0.0, "handover": 0.6,
    "pinion_modulation": 0.0, "pinion_modulation_phase": 0.0,
    "gear_modulation": 0.0, "gear_modulation_phase": 0.0,
    "relief": 0.0, "relief_pitches": 0.3, "crack": 0.0, "crack_phase": 0.0, "crack_on_gear": 0.0,
    # laws of the contact
    "gap": math.inf, "power": 0.0, "power_n": 1.0, "power_rounding": 1e-6, "dry": 0.0, "dry_width": 1.0,
    "dry_forward": 0.0, "dry_backward": 0.0, "viscous_forward": 0.0, "viscous_backward": 0.0,
    "one_way_width": 1.0, "friction": 0.0, "film": 0.0, "film_thickness": 1e-5,
    "contact_damping": 0.0, "contact_exponent": 1.0, "contact_at": 1.66e-5,
    "hysteresis": 0.0, "yield": 1e-3, "cubic": 0.0, "hertz": 0.0, "hertz_at": 1.66e-5,
    # further degrees of freedom
    "bearing": 0.0, "bearing_stiffness": 1e9, "bearing_mass": 1.0, "bearing_damping": 0.0,
    "unbalance": 0.0, "unbalance_phase": 0.0,
    "torsion": 0.0, "torsion_stiffness": 1e3, "torsion_damping": 0.0, "motor": 1e-2,
    # the sensor of the transmission error, and the one of the angle
    "gain": 1.0, "offset": 0.0, "drift": 0.0, "lowpass": math.inf, "delay": 0.0, "limit": math.inf, "step": 0.0,
    "encoder_1": 0.0, "encoder_1_phase": 0.0, "encoder_2": 0.0, "encoder_2_phase": 0.0,
    "mains": 0.0, "mains_phase": 0.0, "angle_error": 0.0, "angle_error_phase": 0.0,
}  # fmt: skip


def stack(members: Sequence[Mapping[str, float | np.ndarray]]) -> dict[str, np.ndarray]:
    """Members, each naming only what differs from NEUTRAL, as arrays with the member last."""
    unknown = {name for member in members for name in member} - set(NEUTRAL)
    if unknown:
        raise KeyError(f"no such knobs: {sorted(unknown)}")
    return {
        name: np.stack([_entries(member.get(name, value), value) for member in members], axis=-1)
        for name, value in NEUTRAL.items()
    }


def _entries(given: float | np.ndarray, neutral: float | np.ndarray) -> np.ndarray:
    """A knob with as many entries as there is room for; the rest are not used."""
    given = np.asarray(given, dtype=float)
    return given if given.shape == np.shape(neutral) else np.pad(given, (0, np.size(neutral) - given.size))


def any_on(knobs: Mapping[str, np.ndarray], *names: str) -> bool:
    """Whether any member has one of these knobs away from neutral."""
    return any(bool(np.any(knobs[name] != np.asarray(NEUTRAL[name])[..., None])) for name in names)
