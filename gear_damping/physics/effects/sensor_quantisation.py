"""Steps of the recorder."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import Recording, Sensor, Values


class SensorQuantisation(Sensor):
    """The record is rounded to whole steps."""

    name = "sensor_quantisation"
    equation = "q round(y / q)"
    reference = "Widrow & Kollár (2008), Quantization Noise, Cambridge"
    parameters: ClassVar = (Parameter("step", "m", 1e-8, "q", 1e-18, 1e9),)
    position = 90  # last in the chain: the converter

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The rounded record."""
        step = values["step"].unsqueeze(1)
        return step * torch.round(signal / step)
