"""What a response channel shows of a simulated motion: the observation model y = S[g h(state)] + offset."""

from collections.abc import Sequence
from math import pi

import torch
from torch import Tensor

from gear_damping.identification.output_error.records import Filter, Observed
from gear_damping.physics.record_filter import butterworth_modes, butterworth_response, filtered
from gear_damping.physics.systems.traits import Trait
from gear_damping.simulation.observed import motion_of_shaft
from gear_damping.simulation.runs import Runs

SENSOR_NOISE = "sensor_noise"
POINTS = 10  # samples of the polynomial between which an uneven stamp lies: 1e-5 at seven samples a period


def motion(runs: Runs, channel: Observed) -> Tensor:
    """The quantity that a channel shows before any sensor, (batch, time)."""
    if runs.model.system.has(Trait.SHAFTS) and channel.derivatives:
        return _shaft_motion(runs, channel)
    name = ("displacement", "velocity", "acceleration")[channel.derivatives]
    shown = runs.states[name]
    return shown + runs.inputs["base_acceleration"] if channel.absolute else shown


def _shaft_motion(runs: Runs, channel: Observed) -> Tensor:
    """Speed fluctuation of a shaft, or tangential acceleration on it."""
    if channel.derivatives == 1:
        return motion_of_shaft(runs, channel.name)
    return channel.radius * motion_of_shaft(runs, f"{channel.shaft}_acceleration")


def recorded(runs: Runs, channel: Observed, first: bool, begins: Tensor | None = None) -> Tensor:
    """A channel as its sensor records it, but for its offset and the states of its filters, (batch, time).

    Args:
        runs: The simulated motion; `acceleration` among its states where the channel needs it.
        channel: What it shows.
        first: Whether it is the record's first channel, on which the sensor effects of the model act.
        begins: Time in s from the start of the record to the first sample, (batch,).
    """
    signal = motion(runs, channel)
    seen = [runs.model.system.response] if first else []
    if channel.is_tangential:
        seen.append(f"{channel.shaft}_acceleration")
    if seen:
        signal = runs.behind_sensors(signal, torch.Generator().manual_seed(0), (SENSOR_NOISE,), begins, seen)
    for one in channel.filters:
        response = butterworth_response(one.order, one.high)
        signal = filtered(signal, runs.sampling_rate, lambda f, r=response, c=one.corner: r(f / c))
    return signal


def filter_modes(filters: Sequence[Filter], sampling_rate: float, samples: int) -> Tensor:
    """What unit states of declared filters at the start leave in the record, (modes, time)."""
    time = torch.arange(samples, dtype=torch.float64) / sampling_rate
    found = [butterworth_modes(one.order, 2 * pi * one.corner * time) for one in filters]
    return torch.cat(found) if found else torch.zeros(0, samples, dtype=torch.float64)


def interpolation(positions: Tensor, samples: int) -> tuple[Tensor, Tensor]:
    """Places and weights of a polynomial through the samples about each position.

    Args:
        positions: In sampling intervals from the first sample, (time,).
        samples: Number of samples on the grid.

    Returns:
        Indices and weights, (time, points) each.
    """
    points = min(POINTS, samples)
    first = (positions.floor().long() - points // 2 + 1).clamp(0, samples - points)
    places = first.unsqueeze(1) + torch.arange(points)
    distance = positions.unsqueeze(1) - places
    weights = torch.ones_like(distance)
    for j in range(points):
        others = [k for k in range(points) if k != j]
        weights[:, j] = torch.stack([distance[:, k] / (j - k) for k in others]).prod(0) if others else 1.0
    return places, weights
