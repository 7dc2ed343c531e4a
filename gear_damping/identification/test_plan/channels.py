"""What a planned sensor sees of a simulated run."""

from collections.abc import Sequence

import torch
from torch import Tensor

from gear_damping.physics.systems.base import System
from gear_damping.physics.systems.traits import Trait
from gear_damping.simulation.observed import motion_of_shaft
from gear_damping.simulation.runs import Runs

RESPONSE = "response"  # stands for the response of the system
OF_MOTION = ("m", "m/s", "m/s^2")  # SI units of a motion and its rates
OF_SHAFTS = {
    "pinion_speed": "rad/s",
    "gear_speed": "rad/s",
    "pinion_acceleration": "rad/s^2",
    "gear_acceleration": "rad/s^2",
}


def channels_of(system: System) -> dict[str, str]:
    """What may be seen of a system, with the unit of each: SI, or the rig's own."""
    if system.has(Trait.SHAFTS):
        return {RESPONSE: OF_MOTION[0], system.response: OF_MOTION[0], **OF_SHAFTS}
    units = [system.unit_of(unit) for unit in OF_MOTION]
    return {RESPONSE: units[0], **dict(zip(system.responses, units, strict=True))}


def needs_acceleration(channels: Sequence[str]) -> bool:
    """Whether a run must keep its acceleration for these channels."""
    return any(channel.endswith("acceleration") for channel in channels)


def seen(runs: Runs, channels: Sequence[str]) -> Tensor:
    """The channels behind the sensor effects of the model, (channels, batch, time)."""
    return torch.stack([_seen(runs, channel) for channel in channels])


def _seen(runs: Runs, channel: str) -> Tensor:
    if channel in (RESPONSE, runs.model.system.response):
        signal = runs.response
    elif channel in runs.states:
        signal = runs.states[channel]
    else:
        signal = motion_of_shaft(runs, channel)
    return runs.behind_sensors(signal, torch.Generator())  # those that draw are refused beforehand
