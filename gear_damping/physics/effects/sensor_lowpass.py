"""Limited bandwidth of the sensor."""

from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.record_filter import filtered
from gear_damping.physics.terms import Recording, Sensor, Values


class SensorLowpass(Sensor):
    """A Butterworth low-pass in the sensor or its amplifier; taken for damping, it biases the estimate."""

    name = "sensor_lowpass"
    equation = "H(f) = prod_k 1 / (i f / f_c - p_k), p_k the Butterworth poles"
    reference = "Butterworth (1930), Exp. Wirel. Wirel. Eng. 7"
    parameters: ClassVar = (Parameter("cutoff", "Hz", 1e4, "f_c, where half the power is left", 1e-6, 1e12),)
    options: ClassVar = (Option("order", (1, 2, 4), 2, "number of poles"),)
    position = 40
    cause: ClassVar = Cause(
        "the low-pass of the sensor",
        tuple(
            Recipe({"cutoff": size}, presence=True, options={"order": order})
            for order in (1, 2)
            for size in (0.5, 1.5, 4.0)
        ),
        separated_by="speed",
    )

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The filtered record."""

        def response(frequency: Tensor) -> Tensor:
            ratio = frequency / values["cutoff"].unsqueeze(1)
            total = torch.ones_like(ratio) + 0j
            for k in range(self.chosen["order"]):
                angle = torch.tensor(pi * (2 * k + 1 + self.chosen["order"]) / (2 * self.chosen["order"]))
                total = total / (1j * ratio - torch.exp(1j * angle.to(ratio)))
            return total

        return filtered(signal, recording.sampling_rate, response)
