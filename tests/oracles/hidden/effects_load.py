"""Hidden loads, and what gives way beside the mesh."""

from __future__ import annotations

import math

from . import pair
from .effect import Effect, Params, between, phase, signed
from .knobs import Knobs

HIGH_ORDERS = (12.0, 36.0)  # per turn of the pinion, drawn on other rigs where three meshes reach so far


def _ripple(rng, duration) -> Params:
    order, angle = float(rng.choice([1.0, 2.0, 3.0, 4.0, 6.0])), phase(rng)
    if rng.random() < 0.3:
        return {"form": "proportional", "share": 0.3, "order": order, "phase": angle}
    return {"form": "torque", "amplitude": 40.0, "order": order, "phase": angle}


def _ripple_order(rng, rig: pair.Rig) -> Params:
    """Any order up to three meshes, but for the meshes themselves."""
    high = [order for order in HIGH_ORDERS if order <= 3 * rig.teeth[0] and order % rig.teeth[0]]
    return {"order": float(rng.choice([1.0, 2.0, 3.0, 4.0, 6.0, *high, *high]))}


def _turn_ripple(p: Params, record: Knobs) -> Knobs:
    size = {"ripple_share": p["share"]} if p["form"] == "proportional" else {"ripple": p["amplitude"]}
    return size | {"ripple_order": p["order"], "ripple_phase": p["phase"]}


def _torque_variation(rng, duration) -> Params:
    """A sine, or a change along half a cosine that is slow (ramp) or quick (step)."""
    form = str(rng.choice(["sine", "ramp", "step"]))
    if form == "sine":
        return {"form": form, "sine_amplitude": 45.0, "sine_frequency": rng.uniform(1.0, 3.0) / duration,
                "sine_phase": phase(rng)}  # fmt: skip
    start = float(rng.uniform(0.15, 0.45)) * duration
    length = float(rng.uniform(0.25, 0.45)) * duration if form == "ramp" else 1e-3
    return {"form": form, "ramp_start": start, "ramp_end": start + length, "ramp_change": signed(rng, 45.0)}


def _turn_variation(p: Params, record: Knobs) -> Knobs:
    if p["form"] == "sine":
        rate = 2.0 * math.pi * p["sine_frequency"]
        return {"slow": p["sine_amplitude"], "slow_rate": rate, "slow_phase": p["sine_phase"]}
    return {"ramp": p["ramp_change"], "ramp_start": p["ramp_start"], "ramp_end": p["ramp_end"]}


def _bearing(rng, duration) -> Params:
    return {"stiffness": 1e8, "mass": between(rng, 1.0, 5.0), "damping_ratio": float(rng.uniform(0.01, 0.05))}


def _turn_bearing(p: Params, record: Knobs) -> Knobs:
    damping = 2.0 * p["damping_ratio"] * math.sqrt(p["stiffness"] * p["mass"])
    return {"bearing": 1.0, "bearing_stiffness": p["stiffness"], "bearing_mass": p["mass"], "bearing_damping": damping}


def _torsion(rng, duration) -> Params:
    motor = between(rng, 2e-3, 2e-2)
    inertia = 1.0 / (1.0 / motor + 1.0 / pair.USUAL.gears)
    stiffness = (2.0 * math.pi * 2000.0) ** 2 * inertia
    return {"stiffness": stiffness, "motor_inertia": motor, "damping_ratio": float(rng.uniform(0.01, 0.04))}


def _turn_torsion(p: Params, record: Knobs) -> Knobs:
    gears = record["inertia_1"] + record["inertia_2"] * (record["radius_1"] / record["radius_2"]) ** 2
    inertia = 1.0 / (1.0 / p["motor_inertia"] + 1.0 / gears)
    damping = 2.0 * p["damping_ratio"] * math.sqrt(p["stiffness"] * inertia)
    return {"torsion": 1.0, "torsion_stiffness": p["stiffness"], "torsion_damping": damping,
            "motor": p["motor_inertia"]}  # fmt: skip


def _quieter(p: Params, size: float) -> Params:
    return {"snr_db": p["snr_db"] - 20.0 * math.log10(size)}


LOAD = (
    Effect("torque_ripple", _ripple, _turn_ripple, {"amplitude": 1, "share": 1}, on_rig=_ripple_order),
    Effect("torque_variation", _torque_variation, _turn_variation, {"sine_amplitude": 1, "ramp_change": 1}),
    Effect(
        "windage_drag", lambda rng, T: {"coefficient": 1.5e-4}, lambda p, record: {"windage": p["coefficient"]},
        {"coefficient": 1},
    ),
    Effect(
        "load_noise", lambda rng, T: {"snr_db": 6.0},
        lambda p, record: {"load_noise": abs(record["torque"]) / record["radius_1"] * 10.0 ** (-p["snr_db"] / 20.0)},
        shrink=_quieter,
    ),
    Effect("bearing_flexibility", _bearing, _turn_bearing, {"stiffness": -1}, least=1.0 / 256.0),
    Effect("shaft_torsion", _torsion, _turn_torsion, {"stiffness": 1}),
    Effect(
        "unbalance", lambda rng, T: {"unbalance": 1e-3, "phase": phase(rng)},
        lambda p, record: {"unbalance": p["unbalance"], "unbalance_phase": p["phase"]}, {"unbalance": 1},
    ),
)  # fmt: skip
