"""Drift of the sensor."""

from typing import ClassVar

from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, where_there_is_a_spring
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import Recording, Sensor, Values


class SensorDrift(Sensor):
    """The zero of the record wanders steadily."""

    name = "sensor_drift"
    equation = "y + d t"
    reference = "Doebelin (2003), Measurement Systems"
    parameters: ClassVar = (Parameter("rate", "m/s", 2e-5, "d", -1e9, 1e9),)
    position = 30  # in the chain, beside the offset
    cause: ClassVar = Cause(
        "a drift of the sensor",
        # What coasts is slowed by a constant force as it would seem to be by a drift of its rate.
        where_there_is_a_spring(Recipe({"rate": 0.001})),
    )

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The drifting record."""
        return signal + values["rate"].unsqueeze(1) * recording.times(signal)
