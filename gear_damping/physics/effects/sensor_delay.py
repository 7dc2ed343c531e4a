"""Delay of the sensor."""

from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.record_filter import filtered
from gear_damping.physics.terms import Recording, Sensor, Values

# of the time in which a rig without a spring forgets its motion: that of the slowest low-pass that is tried there (two
# poles at a cutoff of one over it delay by 2**.5 / (2 pi)); a longer one turns drive and answer against each other
LONGEST = 0.225
MODES = 3  # powers of time by which a short beginning is free


def _switched_on(rig: Rig) -> tuple[Recipe, ...]:
    """None of a free swing: it is the same one begun earlier, and the unknown beginning would take what dies away."""
    if rig.swings_freely:
        return ()
    longest = LONGEST * (rig.values.get("characteristic_time", 0.0) or 1.0)
    return (Recipe({"delay": 0.05}, within={"sensor_delay.delay": (-longest, longest)} if rig.coasts else {}),)


class SensorDelay(Sensor):
    """The record lags behind its time stamps, by any fraction of a sample."""

    name = "sensor_delay"
    equation = "y(t - tau)"
    reference = "Laakso et al. (1996), IEEE Signal Process. Mag. 13(1)"
    parameters: ClassVar = (Parameter("delay", "s", 2e-5, "tau", -1e3, 1e3),)
    position = 50  # in the chain, behind the filter
    cause: ClassVar = Cause(
        "a delay of the sensor",
        _switched_on,
        separated_by="speed",
    )

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The record, band-limited interpolated at earlier instants."""

        def response(frequency: Tensor) -> Tensor:
            angle = -2 * pi * frequency * values["delay"].unsqueeze(1)
            return torch.complex(torch.cos(angle), torch.sin(angle))

        return filtered(signal, recording.sampling_rate, response)

    @property
    def start_modes(self) -> int:
        """What was before the record is seen in it for the time of the delay, and not known."""
        return MODES

    def left_of_start(self, values: Values, time: Tensor) -> Tensor:
        """Powers of time over the delay; of a record that runs ahead, at its end."""
        delay = values["delay"].unsqueeze(1)
        into = torch.where(delay >= 0, time, time[-1] - time) / delay.abs().clamp(min=1e-300)
        return torch.stack([torch.where(into < 1, into.clamp(max=1) ** power, 0.0) for power in range(MODES)])
