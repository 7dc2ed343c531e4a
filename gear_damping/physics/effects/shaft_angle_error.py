"""Error of the recorded shaft angle."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.parameter import Parameter
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
    systems: ClassVar = ("gear_pair",)
    channel = "pinion_angle"

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The recorded angle from the true one."""
        angle = signal if recording.pinion_angle is None else recording.pinion_angle
        return signal + values["amplitude"].unsqueeze(1) * torch.cos(angle + values["phase"].unsqueeze(1))
