"""Error of the recorded shaft angle."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Recording, Sensor, Values


class ShaftAngleError(Sensor):
    """The tacho or encoder of the pinion sits eccentric: what is sorted by its angle gets false sidebands."""

    name = "shaft_angle_error"
    equation = "theta_1 + A cos(theta_1 + phi) in the channel pinion_angle"
    reference = "Rémond (1998), Meas. Sci. Technol. 9(3)"
    parameters: ClassVar = (
        Parameter("amplitude", "rad", 4.4e-3, "A; the default is 0.25 deg", 0, 0.5),
        Parameter("phase", "rad", 0.0, "phi"),
    )
    needs: ClassVar = (Trait.SHAFTS,)
    channel = "pinion_angle"
    cause: ClassVar = Cause(
        "an error of the shaft angle",
        (Recipe({"amplitude": None}, {"amplitude": "phase"}),),
    )

    def undo(self, signal: Tensor, values: Values) -> Tensor:
        """The true angle from the recorded one; the error is small, so two rounds settle it."""
        amplitude, phase = (values[name].unsqueeze(1) for name in ("amplitude", "phase"))
        true = signal - amplitude * torch.cos(signal + phase)
        return signal - amplitude * torch.cos(true + phase)

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The recorded angle from the true one."""
        angle = signal if recording.pinion_angle is None else recording.pinion_angle
        return signal + values["amplitude"].unsqueeze(1) * torch.cos(angle + values["phase"].unsqueeze(1))
