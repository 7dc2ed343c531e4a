"""Errors of the encoders that the transmission error is taken from."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Recording, Sensor, Values


class EncoderError(Sensor):
    """Each encoder sits eccentric on its shaft, and its lines are unevenly divided.

    In the transmission error the first is the same as eccentricity of the gear.
    """

    name = "encoder_error"
    equation = (
        "x + r_b1 (A1 cos(theta_1 + phi1) + B1 cos(n theta_1)) - r_b2 (A2 cos(theta_2 + phi2) + B2 cos(n theta_2))"
    )
    reference = "Rémond (1998), Meas. Sci. Technol. 9(3)"
    parameters: ClassVar = (
        Parameter("pinion_amplitude", "rad", 8.7e-4, "A1; the default is 0.05 deg, 25 um", 0, 0.1),
        Parameter("pinion_phase", "rad", 0.0, "phi1"),
        Parameter("gear_amplitude", "rad", 0.0, "A2", 0, 0.1),
        Parameter("gear_phase", "rad", 0.0, "phi2"),
        Parameter("lines", "1", 1024.0, "n, lines per turn of either encoder", 1, 1e6),
        Parameter("pinion_line_amplitude", "rad", 0.0, "B1", 0, 0.1),
        Parameter("gear_line_amplitude", "rad", 0.0, "B2", 0, 0.1),
    )
    needs: ClassVar = (Trait.SHAFTS, Trait.TEETH)
    cause: ClassVar = Cause(
        "an error of the encoders",
        separated_by="remount",
    )

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The response as the encoders see it."""
        pinion = self._angle_error("pinion", values, recording.pinion_angle)
        gear = self._angle_error("gear", values, recording.gear_angle)
        radii = recording.derived["base_radius_pinion"], recording.derived["base_radius_gear"]
        return signal + radii[0].unsqueeze(1) * pinion - radii[1].unsqueeze(1) * gear

    def _angle_error(self, shaft: str, values: Values, angle: Tensor) -> Tensor:
        size, phase = values[f"{shaft}_amplitude"].unsqueeze(1), values[f"{shaft}_phase"].unsqueeze(1)
        division = values[f"{shaft}_line_amplitude"].unsqueeze(1)
        return size * torch.cos(angle + phase) + division * torch.cos(values["lines"].unsqueeze(1) * angle)
