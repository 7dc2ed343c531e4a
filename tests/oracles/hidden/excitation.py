"""What depends on time and angle alone: shaft angles, stiffness, geometric error, load, friction arms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .knobs import any_on
from .stiffness import Arrays, carrying, of_shares, pair_shape, smooth_step
from .tooth_friction import friction_factor

TURN = 2.0 * np.pi


@dataclass
class Turning:
    """Angles / rad and the pinion's speed / (rad/s), (instant, member)."""

    pinion: np.ndarray
    gear: np.ndarray
    mesh: np.ndarray
    speed: np.ndarray


def turning(knobs: Arrays, t: np.ndarray, wobble: bool = True) -> Turning:
    """Shafts at t / s, (instant, 1); without `wobble` as the motor drives them."""
    sway = knobs["wander_rate"] * t + knobs["wander_phase"]
    angle = knobs["angle"] + knobs["speed"] * t + knobs["wander"] * np.sin(sway)
    speed = knobs["speed"] + knobs["wander"] * knobs["wander_rate"] * np.cos(sway)
    if wobble and any_on(knobs, "wobble"):
        turn = angle + knobs["wobble_phase"]
        angle, speed = angle + knobs["wobble"] * np.cos(turn), speed * (1.0 - knobs["wobble"] * np.sin(turn))
    gear = angle * knobs["teeth_1"] / knobs["teeth_2"] + knobs["gear_phase"]
    return Turning(angle, gear, knobs["teeth_1"] * angle + knobs["mesh_phase"], speed)


def stiffness(knobs: Arrays, t: np.ndarray, at: Turning) -> tuple[np.ndarray, np.ndarray | float]:
    """k / (N/m) with everything that modulates it, and the factor of tooth friction."""
    places, shares = carrying(knobs, at.mesh)
    k = of_shares(knobs, shares)
    for shaft, angle in (("pinion", at.pinion), ("gear", at.gear)):
        if any_on(knobs, f"{shaft}_modulation"):
            k = k * (1.0 + knobs[f"{shaft}_modulation"] * np.cos(angle + knobs[f"{shaft}_modulation_phase"]))
    if any_on(knobs, "crack"):
        k = k * (1.0 - knobs["crack"] * crack_window(knobs, at))
    if any_on(knobs, "warming", "warmed"):
        k = k * (1.0 + knobs["warmed"] + knobs["warming"] * t)
    return k, friction_factor(knobs, at, places, shares) if any_on(knobs, "friction") else 1.0


def reliefs(knobs: Arrays, at: Turning) -> list[np.ndarray]:
    """Of the pair that met last and of the one before it: what its flanks are cut back / m, its stiffness / (N/m).

    A parabola at both ends of its way; a pair that is about to meet counts as met, from as far as its edge reaches.
    """
    found, early = [], 0.5 * np.max(knobs["edge"])
    met = at.mesh / TURN + early
    for place in (met - np.floor(met) - early, met - np.floor(met) - early + 1.0):
        ends = (place, knobs["contact_ratio"] - place)
        cut = sum(np.clip(1.0 - np.maximum(end, 0.0) / knobs["relief_pitches"], 0.0, 1.0) ** 2 for end in ends)
        found += [knobs["relief"] * cut, (knobs["two_pairs"] - knobs["one_pair"]) * pair_shape(knobs, place)]
    return found


def crack_window(knobs: Arrays, at: Turning) -> np.ndarray:
    """A raised cosine over the contact of one tooth, which begins at its shaft's angle -phase."""
    angle, teeth = _of_shaft(knobs, at, "crack_on_gear")
    since = np.mod(angle + knobs["crack_phase"], TURN) * teeth / TURN / knobs["contact_ratio"]
    return np.where(since < 1.0, 0.5 - 0.5 * np.cos(TURN * np.minimum(since, 1.0)), 0.0)


def error(knobs: Arrays, at: Turning) -> tuple[np.ndarray, np.ndarray]:
    """e / m and e' / (m/s)."""
    e, by_pinion = np.zeros_like(at.pinion), np.zeros_like(at.pinion)
    ratio = knobs["teeth_1"] / knobs["teeth_2"]
    for name, angle, rate in (("pinion", at.pinion, 1.0), ("gear", at.gear, ratio)):
        if any_on(knobs, f"{name}_runout"):
            size, turn = knobs[f"{name}_runout"], angle + knobs[f"{name}_runout_phase"]
            e, by_pinion = e + size * np.cos(turn), by_pinion - size * rate * np.sin(turn)
    for h, (size, phase) in enumerate(zip(knobs["profile"], knobs["profile_phase"], strict=True), 1):
        if np.any(size):
            turn = h * at.mesh + phase
            e, by_pinion = e + size * np.cos(turn), by_pinion - size * h * knobs["teeth_1"] * np.sin(turn)
    if any_on(knobs, "pitch"):
        value, slope = pitch_steps(knobs, at)
        e, by_pinion = e + value, by_pinion + slope
    return e, by_pinion * at.speed


def _of_shaft(knobs: Arrays, at: Turning, on_gear: str) -> tuple[np.ndarray, np.ndarray]:
    """Angle and teeth of the shaft that a fault sits on."""
    gear = knobs[on_gear] > 0.0
    return np.where(gear, at.gear, at.pinion), np.where(gear, knobs["teeth_2"], knobs["teeth_1"])


def pitch_steps(knobs: Arrays, at: Turning) -> tuple[np.ndarray, np.ndarray]:
    """Pitch error / m and its slope / (m per rad of the pinion): each tooth's value, handed over half way to the next.

    The pinion turns through one pitch while the gear does: the slope is the same on either shaft.
    """
    angle, teeth = _of_shaft(knobs, at, "pitch_on_gear")
    count = teeth.astype(int)
    turn = np.mod(angle + knobs["pitch_phase"], TURN) * teeth / TURN
    tooth = np.floor(turn).astype(int) % count
    member = np.broadcast_to(np.arange(angle.shape[-1]), tooth.shape)
    here, following = knobs["pitch"][tooth, member], knobs["pitch"][(tooth + 1) % count, member]
    share = np.clip((turn - np.floor(turn) - 0.5) / knobs["handover"] + 0.5, 0.0, 1.0)
    slope = 140.0 * (share * (1.0 - share)) ** 3 / knobs["handover"] * knobs["teeth_1"] / TURN
    return here + (following - here) * smooth_step(share), (following - here) * slope


def measured_torques(knobs: Arrays, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pinion torque and resisting gear torque / N m as torque sensors see them."""
    flutter = knobs["flutter"] * np.cos(knobs["flutter_rate"] * t + knobs["flutter_phase"])
    pinion = knobs["torque"] * (1.0 + flutter) + knobs["swing"] * np.cos(knobs["swing_rate"] * t + knobs["swing_phase"])
    ratio = knobs["radius_2"] / knobs["radius_1"]
    return pinion, ratio * np.where(knobs["held"] > 0.0, knobs["torque"], pinion)


def load(knobs: Arrays, t: np.ndarray, at: Turning) -> tuple[np.ndarray, np.ndarray]:
    """Load F / N on the line of action and the torque / N m that drives it, everything included.

    What the gear does about unseen torques is its brake's affair: balanced follows them, held does not.
    """
    pinion, gear = measured_torques(knobs, t)
    unseen = _unseen_torque(knobs, t, at)
    driven = gear + np.where(knobs["held"] > 0.0, 0.0, unseen * knobs["radius_2"] / knobs["radius_1"])
    torque = pinion + unseen
    arms = (knobs[f"radius_{i}"] * each / knobs[f"inertia_{i}"] for i, each in ((1, torque), (2, driven)))
    force = knobs["joint_mass"] * sum(arms)
    if any_on(knobs, "ripple_share"):
        share = knobs["ripple_share"] * np.cos(knobs["ripple_order"] * at.pinion + knobs["ripple_phase"])
        force, torque = force * (1.0 + share), torque * (1.0 + share)
    if any_on(knobs, "impact_force"):
        force = force + _impacts(knobs, t)
    return force, torque


def _unseen_torque(knobs: Arrays, t: np.ndarray, at: Turning) -> np.ndarray:
    total = -knobs["windage"] * np.abs(at.speed) * at.speed
    for name, order in (("ripple", knobs["ripple_order"]), ("belt", knobs["belt_order"])):
        if any_on(knobs, name):
            total = total + knobs[name] * np.cos(order * at.pinion + knobs[f"{name}_phase"])
    if any_on(knobs, "slow"):
        total = total + knobs["slow"] * np.sin(knobs["slow_rate"] * t + knobs["slow_phase"])
    if any_on(knobs, "ramp"):
        share = np.clip((t - knobs["ramp_start"]) / (knobs["ramp_end"] - knobs["ramp_start"]), 0.0, 1.0)
        total = total + knobs["ramp"] * (0.5 - 0.5 * np.cos(np.pi * share))
    return total


def _impacts(knobs: Arrays, t: np.ndarray) -> np.ndarray:
    """Half sines of force at the drawn times."""
    total = 0.0
    for start in knobs["impact_times"]:
        share = (t - start) / knobs["impact_width"]
        total = total + np.where((share > 0.0) & (share < 1.0), np.sin(np.pi * np.clip(share, 0.0, 1.0)), 0.0)
    return knobs["impact_force"] * total
