"""Named reference runs: 10 ms of the bench family, none of them chaotic, most of them losing contact.

Bench: the paper's gear pair, 4600 rpm, 150 N m, power law n = 2 at an equivalent damping ratio of 0.35 % (at
the velocity amplitude omega_n F0/k0), backlash 100 um. The starts lie near the static equilibrium where not
said otherwise. A start moved by 1e-10 of the static deflection moves no run by more than 3e-8 of it, which
test_oracle_cases.py checks.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from closed_forms import power_law_coefficient
from gear_case import GearCase, Ripple
from gear_terms import Piece

DURATION, SAMPLING_RATE = 10e-3, 40e3  # s, Hz
TIMES = np.arange(round(DURATION * SAMPLING_RATE) + 1) / SAMPLING_RATE
DAMPING_RATIO = 0.0035


def rpm(speed: float) -> float:
    """Revolutions a minute as rad/s."""
    return speed * 2.0 * math.pi / 60.0


def near_equilibrium(case: GearCase, share: float = 1.02) -> GearCase:
    """The case started at `share` of its static deflection, riding on its displacement error at t = 0."""
    e, e_rate, _ = Piece(case, 0.0).error(0.0)
    return replace(case, x0=share * case.static_deflection + e, v0=e_rate)


def bench(**changes: object) -> GearCase:
    """The bench run with some fields changed, near its equilibrium; alpha stays that of 150 N m."""
    base = GearCase()
    speed = base.natural_frequency * base.static_deflection
    alpha = power_law_coefficient(DAMPING_RATIO, 2.0, speed, base.mass, base.mean_stiffness)
    return near_equilibrium(replace(base, **{"power_alpha": alpha, "power_n": 2.0, "gap": 100e-6, **changes}))


_LIGHT = {"torque": 10.0, "profile_error": ((4, 0.3e-6, 0.3),), "weighting": "lanczos"}
_NOISE = tuple(np.random.default_rng(7).normal(0.0, 400.0, TIMES.size))

REFERENCE_CASES: dict[str, GearCase] = {
    "bench": bench(),
    "bench_lanczos": bench(weighting="lanczos"),
    "bench_rectangular": bench(stiffness_form="rectangular", mesh_phase=0.4),
    "bench_loose_start": replace(bench(weighting="lanczos"), x0=2.5 * GearCase().static_deflection),
    "bench_rest": replace(bench(weighting="lanczos"), x0=0.0),
    "rectangular_loose_start": replace(bench(stiffness_form="rectangular", mesh_phase=0.4), x0=30e-6),
    "tongue_4680": bench(pinion_speed=rpm(4680.0)),
    "resonance_third": bench(pinion_speed=rpm(5450.0)),
    "light_load": bench(**_LIGHT),
    "light_load_viscous": bench(**_LIGHT, power_alpha=0.0, viscous=184.0 * 0.35),
    "light_load_coulomb": bench(**_LIGHT, coulomb_force=20.0, coulomb_smoothing=0.01),
    "light_load_eccentric": bench(**_LIGHT, pinion_eccentricity=(20e-6, 0.4), gear_eccentricity=(15e-6, 1.0)),
    "reversal_both_flanks": bench(torque_steps=((2e-3, -300.0),), weighting="lanczos"),
    "reversal_held_gear": bench(
        torque_steps=((2e-3, -400.0),), weighting="lanczos", gear_torque=300.0, pinion_angle_0=0.7
    ),
    "load_noise": bench(held_load=_NOISE, held_load_step=1.0 / SAMPLING_RATE, weighting="lanczos"),
    "many_effects": bench(
        torque=35.0,
        weighting="lanczos",
        mesh_phase=0.7,
        pinion_angle_0=0.2,
        gear_angle_0=0.5,
        viscous=20.0,
        power_n=1.7,
        profile_error=((1, 3e-6, 0.3), (2, 1e-6, 1.1)),
        pinion_eccentricity=(10e-6, 0.4),
        gear_eccentricity=(8e-6, 1.0),
        pinion_stiffness_modulation=(0.02, 0.5),
        gear_stiffness_modulation=(0.01, 1.5),
        ripple=(Ripple(30.0, 4.0, 0.2), Ripple(0.03, 7.0, 0.1, "gear", proportional=True)),
        torque_sine=(3.0, 180.0, 0.3),
    ),
}
_IN_CONTACT = {"bench", "bench_lanczos", "bench_rectangular"}
SEPARATING = tuple(name for name in REFERENCE_CASES if name not in _IN_CONTACT)
