"""Offset of the sensor."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import Recording, Sensor, Values


class SensorOffset(Sensor):
    """A constant added to the record."""

    name = "sensor_offset"
    equation = "y + y0"
    reference = "Doebelin (2003), Measurement Systems"
    parameters: ClassVar = (Parameter("offset", "m", 2e-6, "y0", -1e9, 1e9),)
    position = 20  # in the chain, behind the gain
    cause: ClassVar = Cause(
        "an offset of the sensor",
        (Recipe({"offset": None}),),
    )

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The shifted record."""
        return signal + values["offset"].unsqueeze(1)
