"""Gravity in an accelerometer that turns with a shaft."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import SHAFTS, Cause, Recipe, Rig
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import TANGENTIAL, Recording, Sensor, Values

GRAVITY = 9.80665  # m/s^2, the standard acceleration of free fall
MOST = 1.25  # of it: a sensor whose gain is off by a quarter shows so much


def _of_its_shaft(rig: Rig) -> tuple[Recipe, ...]:
    """Where a shaft carries an accelerometer."""
    return tuple(
        Recipe({"amplitude": None}, {"amplitude": "phase"}, options={"shaft": shaft}) for shaft in rig.accelerometers
    )


class AccelerometerGravity(Sensor):
    """An accelerometer across the radius of a shaft that lies feels its own weight once a turn, whatever the speed.

    Two of them opposite each other, added up, do not.
    """

    name = "accelerometer_gravity"
    equation = "a + g cos(theta + phi), theta the angle of the shaft that carries the sensor"
    reference = "Houser & Blankenship (1989), SAE Technical Paper 891869"
    parameters: ClassVar = (
        Parameter("amplitude", "m/s^2", GRAVITY, "g, times the cosine of the shaft's slope", 0, MOST * GRAVITY),
        Parameter("phase", "rad", 0.0, "phi, where the sensor sits"),
    )
    options: ClassVar = (Option("shaft", SHAFTS, "pinion", "the shaft that carries the sensor"),)
    needs: ClassVar = (Trait.SHAFTS,)
    channel = TANGENTIAL
    cause: ClassVar = Cause(
        "the weight that an accelerometer on a turning shaft feels",
        _of_its_shaft,
        separated_by="remount",
        turns_with="shaft",
    )

    @property
    def acts_on(self) -> str:
        """The acceleration of its shaft."""
        return f"{self.chosen['shaft']}_acceleration"

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The tangential acceleration with the weight in it."""
        angle = recording.pinion_angle if self.chosen["shaft"] == "pinion" else recording.gear_angle
        return signal + values["amplitude"].unsqueeze(1) * torch.cos(angle + values["phase"].unsqueeze(1))
