"""What a planned sensor sees of a simulated run."""

from collections.abc import Sequence

import torch
from torch import Tensor

from gear_damping.simulation.observed import motion_of_shaft
from gear_damping.simulation.runs import Runs

RESPONSE = "response"  # stands for the response of the system
CHANNELS = {
    "gear_pair": {
        RESPONSE: "m",
        "transmission_error": "m",
        "pinion_speed": "rad/s",
        "gear_speed": "rad/s",
        "pinion_acceleration": "rad/s^2",
        "gear_acceleration": "rad/s^2",
    },
    "oscillator": {RESPONSE: "m", "displacement": "m", "velocity": "m/s", "acceleration": "m/s^2"},
}  # by system, with the SI unit of each


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
