"""Records as the instruments leave them, and what the user then states of the rig."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .draft import Draft
from .excitation import turning
from .integrate import Trajectory
from .plans import Condition
from .sensor import coloured, others
from .setup import SPEED_UNCERTAINTY, Setup
from .sizing import clean
from .stiffness import Arrays

ANGLE_NOISE = 5e-6  # rad
TORQUE_NOISE = 1e-4  # of the torque, where a torque stands as a condition: its scatter from record to record
Nominal = dict[str, dict[str, float | str]]


@dataclass(frozen=True, eq=False)
class HiddenRecord:
    """One record: channels (n,) in SI by their canonical names, and the condition that was set.

    stated: conditions in SI that the user gives instead of channels, by name.
    """

    name: str
    condition: Condition
    time: np.ndarray
    channels: dict[str, np.ndarray]
    stated: dict[str, float] = field(default_factory=dict)


def records_of(one: Draft, knobs: Arrays, path: Trajectory, sigma: float) -> tuple[HiddenRecord, ...]:
    """All records of a case; sigma: of the noise of the response, in its SI unit."""
    shape = path.x[path.time > -1e-12].shape
    setup, noise = one.setup, one.noise
    seen = clean(one, knobs, path, sigma * coloured(noise.normal(size=shape), setup.colour))
    channels = {"transmission_error": seen} | others(knobs, path)
    angle = channels["pinion_angle"]
    channels["pinion_angle"] = angle + ANGLE_NOISE * noise.normal(size=shape)
    if setup.name != "full":
        channels = _of_setup(one, knobs, path, seen, angle, channels)
    conditions = [_stated(one, knobs, member) for member in range(shape[1])]
    return tuple(
        HiddenRecord(f"run_{1 + i}", condition, np.arange(shape[0]) / one.rig.rate,
                     {name: values[:, i].copy() for name, values in channels.items()}, conditions[i])
        for i, condition in enumerate(one.conditions)
    )  # fmt: skip


def _of_setup(one: Draft, knobs: Arrays, path: Trajectory, seen, angle, channels) -> dict[str, np.ndarray]:
    """The channels of a plan of sensors, from the full ones."""
    setup, t = one.setup, path.time[path.time > -1e-12][:, None]
    kept = {"pinion_torque": (channels["pinion_torque"] - setup.torque_offset) / setup.torque_gain}
    if setup.torque == "condition":
        kept = {}
    if setup.torque_noise:
        torque = kept["pinion_torque"]
        level = setup.torque_noise * torque.std(axis=0)
        kept["pinion_torque"] = torque + level * one.noise.normal(size=torque.shape)
    if setup.angle:
        kept["pinion_angle"] = channels["pinion_angle"]
    if setup.angle_step:
        kept["pinion_angle"] = setup.angle_step * np.floor(angle / setup.angle_step)
    if setup.counts is not None:
        return kept | _counts(one, knobs, seen, angle)
    if setup.order == 1:
        turn = turning(knobs, t, wobble=False).speed
        seen = seen + turn * (1.0 if setup.response == "pinion_speed" else knobs["teeth_1"] / knobs["teeth_2"])
    if setup.datum == "arbitrary" and setup.corner is None:
        seen = seen - seen.mean(axis=0)
    return kept | {setup.response: seen}


def _counts(one: Draft, knobs: Arrays, seen: np.ndarray, angle: np.ndarray) -> dict[str, np.ndarray]:
    """Counts of both encoders from power-on: the mean rotation, and what each shaft adds to the transmission error."""
    pinion, gear = shafts(one, seen, angle)
    begun = one.noise.integers(0, one.setup.counts[0], size=(2, 1, seen.shape[1]))
    per_turn = [count / (2.0 * np.pi) for count in one.setup.counts]
    return {
        "pinion_counts": np.floor(pinion * per_turn[0] + 0.5) - begun[0],
        "gear_counts": np.floor(gear * per_turn[1] + 0.5) - begun[1],
    }


def shafts(one: Draft, seen: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles / rad whose difference along the line of action is `seen`: I1 theta_1'' = r_1 m x'' against -r_2 m x''."""
    share = [r * one.rig.mass / i for r, i in zip(one.rig.radius, one.rig.inertia, strict=True)]
    return angle + share[0] * seen, angle * one.rig.teeth[0] / one.rig.teeth[1] - share[1] * seen


def _stated(one: Draft, knobs: Arrays, member: int) -> dict[str, float]:
    found = {}
    if one.setup.speed is not None:
        scatter = 0.5 * SPEED_UNCERTAINTY * one.noise.normal() if one.setup.speed == "uncertain" else 0.0
        found["pinion_speed"] = float(knobs["speed"][member] * (1.0 + scatter))
    if one.setup.torque == "condition":
        found["pinion_torque"] = float(knobs["torque"][member] * (1.0 + TORQUE_NOISE * one.noise.normal()))
    return found


def stated(nominal: Nominal, setup: Setup) -> Nominal:
    """What the user says of the rig, with the units and the mistakes of this plan of sensors."""
    if setup.name == "full":
        return nominal
    found = {name: dict(value) for name, value in nominal.items()}
    found["inertia_pinion"]["value"] *= setup.inertia
    if setup.torque == "gain":
        found["torque_gain"] = {"value": setup.torque_gain, "unit": "1"}
        found["torque_offset"] = {"value": setup.torque_offset, "unit": "N*m"}
    if setup.units["transmission_error"] == "m":
        found["module"] = {"value": found["module"]["value"] * 1e-3, "unit": "m"}
    if setup.units["pinion_angle"] == "rad":
        found["pressure_angle"] = {"value": float(np.radians(found["pressure_angle"]["value"])), "unit": "rad"}
    return found
