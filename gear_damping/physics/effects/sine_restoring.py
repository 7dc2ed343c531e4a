"""Restoring force of a pendulum."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause
from gear_damping.physics.moment import Moment
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import ElasticForce, Values


class SineRestoring(ElasticForce):
    """Gravity on a pendulum whose displacement is an angle; the oscillator's own stiffness may be 0."""

    name = "sine_restoring"
    equation = "N + k l sin(x / l), l = 1 for an angle in rad"
    reference = "Nayfeh & Mook (1979), Nonlinear Oscillations, Wiley"
    parameters: ClassVar = (
        Parameter("stiffness", "N/m", 1.0, "k, per mass at small angles: g / length of the pendulum", 0, 1e18),
        Parameter("length", "m", 1.0, "l, one radian in the unit of the displacement", 1e-9, 1e9),
    )
    systems: ClassVar = ("oscillator",)
    cause: ClassVar = Cause(
        "the restoring force of a pendulum",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The parameters, and the rate of small oscillations."""
        stiffness = base["mean_stiffness"] + values["stiffness"]
        return dict(values) | {"fastest_rate": torch.sqrt(stiffness / base["equivalent_mass"])}

    def elastic_force(self, now: Moment, p: Values) -> Tensor:
        """The force at this instant."""
        return p["stiffness"] * p["length"] * torch.sin(now.deflection / p["length"])
