"""Gain of the sensor."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import Recording, Sensor, Values


class SensorGain(Sensor):
    """The record in a wrong scale; with free torque it cannot be told from the load."""

    name = "sensor_gain"
    equation = "g y"
    reference = "Doebelin (2003), Measurement Systems"
    parameters: ClassVar = (Parameter("gain", "1", 1.05, "g", 0.01, 100),)
    position = 10  # first in the chain of the sensor
    cause: ClassVar = Cause(
        "a wrong gain of the sensor",
        (Recipe({"gain": None}, neutral=1.0),),
        looks_like=("inertia_error",),
        one_class=("a moment of inertia other than the stated one (`inertia_error`)", "a torque gain (`torque_gain`)"),
    )

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The scaled record."""
        return signal * values["gain"].unsqueeze(1)
