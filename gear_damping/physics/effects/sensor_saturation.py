"""Limited range of the sensor."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import Recording, Sensor, Values


class SensorSaturation(Sensor):
    """The record stays at the ends of the range."""

    name = "sensor_saturation"
    equation = "min(max(y, -y_max), y_max)"
    reference = "Doebelin (2003), Measurement Systems"
    parameters: ClassVar = (Parameter("limit", "m", 3e-5, "y_max", 0, 1e9),)
    position = 80  # in the chain, before the converter
    cause: ClassVar = Cause(
        "a sensor that saturates",
        tuple(Recipe({"limit": size}, non_nested=True) for size in (1.8, 1.3, 2.5)),
    )

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The clipped record."""
        limit = values["limit"].unsqueeze(1)
        return torch.minimum(torch.maximum(signal, -limit), limit)
