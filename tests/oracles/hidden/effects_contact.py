"""Hidden laws of the contact: damping, friction, stiffness that depends on the state."""

from __future__ import annotations

import numpy as np

from .effect import Effect, Params, between, signed
from .knobs import Knobs

TYPICAL_RATE = 0.08  # m/s, of the deflection in steady running
KNOWN_GAP = 8e-5  # m, of the cases whose backlash the user states


def reference_velocity(record: Knobs) -> float:
    """V = omega_n F0 / k0 / (m/s) of a record."""
    k = record["one_pair"] + (record["two_pairs"] - record["one_pair"]) * (record["contact_ratio"] - 1.0)
    return abs(record["torque"]) / record["radius_1"] / float(np.sqrt(k * record["mass"]))


def _power_law(rng, duration) -> Params:
    n = float(rng.uniform(0.5, 0.75) if rng.random() < 0.3 else rng.uniform(1.6, 3.0))
    return {"coefficient": 1500.0 * TYPICAL_RATE ** (1.0 - n), "exponent": n}


def _turn_power_law(p: Params, record: Knobs) -> Knobs:
    rounding = (0.1 * TYPICAL_RATE if p["exponent"] < 1.0 else 1e-4) * record["rate_scale"]
    return {"power": p["coefficient"], "power_n": p["exponent"], "power_rounding": rounding}


def _coulomb(rng, duration) -> Params:
    return {"force": 400.0, "width": float(rng.uniform(0.03, 0.1))}


def _turn_coulomb(p: Params, record: Knobs) -> Knobs:
    return {"dry": p["force"], "dry_width": p["width"] * reference_velocity(record)}


def _asymmetric(rng, duration) -> Params:
    force, damping = [400.0, 400.0 * rng.uniform(0.1, 0.5)], [800.0, 800.0 * rng.uniform(0.0, 0.5)]
    order = rng.permutation(2)
    names = ("forward", "backward")
    drawn = {f"force_{n}": float(force[i]) for n, i in zip(names, order, strict=True)}
    drawn |= {f"damping_{n}": float(damping[i]) for n, i in zip(names, order, strict=True)}
    return drawn | {"width": float(rng.uniform(0.03, 0.1))}


def _turn_asymmetric(p: Params, record: Knobs) -> Knobs:
    width = p["width"] * reference_velocity(record)
    return {
        "dry_forward": p["force_forward"], "dry_backward": p["force_backward"], "one_way_width": width,
        "viscous_forward": p["damping_forward"], "viscous_backward": p["damping_backward"],
    }  # fmt: skip


def _turn_hysteresis(p: Params, record: Knobs) -> Knobs:
    k = record["one_pair"] + (record["two_pairs"] - record["one_pair"]) * (record["contact_ratio"] - 1.0)
    return {"hysteresis": p["share"] * k, "yield": p["yield_deflection"]}


CONTACT = (
    Effect("power_law_damping", _power_law, _turn_power_law, {"coefficient": 1}),
    Effect("coulomb_friction", _coulomb, _turn_coulomb, {"force": 1}),
    Effect(
        "asymmetric_friction", _asymmetric, _turn_asymmetric,
        {"force_forward": 1, "force_backward": 1, "damping_forward": 1, "damping_backward": 1},
    ),
    Effect(
        "tooth_friction", lambda rng, T: {"friction_coefficient": 0.25, "pitch_point_shift": 0.0},
        lambda p, record: {"friction": p["friction_coefficient"]}, {"friction_coefficient": 1}, plan="reversed",
    ),
    Effect(
        "squeeze_film_damping",
        lambda rng, T: {"damping_coefficient": 2000.0, "film_thickness": between(rng, 5e-6, 2e-5)},
        lambda p, record: {"film": p["damping_coefficient"], "film_thickness": p["film_thickness"]},
        {"damping_coefficient": 1}, plan="light", given={"gap": KNOWN_GAP},
    ),
    Effect(
        "hunt_crossley_damping",
        lambda rng, T: {"damping_coefficient": 2500.0, "exponent": float(rng.uniform(0.7, 1.6)),
                        "reference_deflection": 1.66e-5},
        lambda p, record: {"contact_damping": p["damping_coefficient"], "contact_exponent": p["exponent"],
                           "contact_at": p["reference_deflection"]},
        {"damping_coefficient": 1},
    ),
    Effect(
        "hysteretic_damping",
        lambda rng, T: {"share": 0.4, "yield_deflection": between(rng, 4e-6, 8e-6), "exponent": 1.0},
        _turn_hysteresis, {"share": 1},
    ),
    Effect(
        "backlash", lambda rng, T: {"gap": between(rng, 4e-5, 2e-4)}, lambda p, record: {"gap": p["gap"]},
        plan="light",
    ),
    Effect(
        "cubic_stiffness", lambda rng, T: {"coefficient": 6e17 if rng.random() < 0.7 else -1e17},
        lambda p, record: {"cubic": p["coefficient"]}, {"coefficient": 1},
    ),
    Effect(
        "hertz_stiffness", lambda rng, T: {"exponent": 0.6, "reference_deflection": 1.66e-5},
        lambda p, record: {"hertz": p["exponent"], "hertz_at": p["reference_deflection"]}, {"exponent": 1},
    ),
    Effect(
        "load_dependent_contact", lambda rng, T: {"growth": 0.3, "reference_load": 5321.0},
        lambda p, record: {"contact_growth": p["growth"] / p["reference_load"] / record["radius_1"]}, {"growth": 1},
    ),
    Effect(
        "tip_relief", lambda rng, T: {"depth": 2e-5, "length": float(rng.uniform(0.25, 0.5))},
        lambda p, record: {"relief": p["depth"], "relief_pitches": p["length"]}, {"depth": 1},
    ),
    Effect(
        "inertia_error", lambda rng, T: {"share": signed(rng, 0.3)},
        lambda p, record: {"mass": record["mass"] * (1.0 + p["share"])}, {"share": 1},
    ),
)  # fmt: skip
