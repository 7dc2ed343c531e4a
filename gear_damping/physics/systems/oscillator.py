"""A mass-normalised oscillator, x'' + F_d(x') + k x + F_el(x) = gain * u(t).

It covers any single-degree-of-freedom rig with a measured force input, or its free decay, and is
how measured records are brought in. Its displacement may be in any unit (m, rad, V): "m" in the
declarations then stands for that unit, and forces are accelerations in it.
"""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.moment import Moment
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.scales import Scales
from gear_damping.physics.systems.base import System, Values


class Oscillator(System):
    """The base of any single-degree-of-freedom rig, per unit of mass."""

    name = "oscillator"
    response = "displacement"
    parameters: ClassVar = (
        Parameter("stiffness", "N/m", 1.0, "stiffness per mass; 0 is allowed", 0, 1e18),
        Parameter("force_gain", "N", 1.0, "force per mass and unit of input", -1e18, 1e18),
        Parameter("amplitude", "m", 1.0, "a typical displacement, the unit of length of the solver", 0, 1e9),
        Parameter("initial_displacement", "m", 0.0, "displacement at the start"),
        Parameter("initial_velocity", "m/s", 0.0, "velocity at the start"),
    )
    inputs: ClassVar = {"force": "1"}
    derived_units: ClassVar = {
        "equivalent_mass": "kg",
        "mean_stiffness": "N/m",
        "natural_frequency": "1/s",
        "mean_load": "N",
        "amplitude": "m",
    }

    def derived(self, values: Values, mean_stiffness: Tensor | None) -> dict[str, Tensor]:
        """Unit mass, natural frequency and reference amplitude."""
        stiffness = values["stiffness"]
        one = torch.ones_like(stiffness)
        return {
            "equivalent_mass": one,
            "mean_stiffness": stiffness,
            "natural_frequency": torch.sqrt(stiffness),
            "mean_load": 0 * one,
            "amplitude": values["amplitude"],
        }

    def scales(self, derived: Values) -> Scales:
        """Unit mass, reference amplitude and 1/omega_n (1 s where there is no stiffness)."""
        frequency = derived["natural_frequency"]
        frequency = torch.where(frequency > 0, frequency, torch.ones_like(frequency))
        return Scales(derived["equivalent_mass"], derived["amplitude"], 1 / frequency)

    def stiffness(self, p: Values) -> Tensor:
        """The constant stiffness per mass."""
        return p["stiffness"]

    def load(self, now: Moment, p: Values) -> Tensor:
        """The measured input times its gain; free decay without one."""
        if "force" in now.inputs:
            return p["force_gain"] * now.inputs["force"]
        return torch.zeros_like(now.displacement)
