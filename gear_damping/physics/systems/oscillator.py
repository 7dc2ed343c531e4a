"""A mass-normalised oscillator, x'' + F_d(x') + k x + F_el(x) = gain * u(t) - a_b(t).

It covers any single-degree-of-freedom rig with a measured force input, or its free decay, and is
how measured records are brought in. Its displacement may be in any unit (m, rad, V): "m" in the
declarations then stands for that unit, and forces are accelerations in it.

On a base that moves with the acceleration a_b, x is the displacement relative to the base.
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
        Parameter(
            "characteristic_time", "s", 0.0, "unit of time of the solver; 0: 1/omega_n, without a spring 1 s", 0, 1e9
        ),
        Parameter("initial_displacement", "m", 0.0, "displacement at the start"),
        Parameter("initial_velocity", "m/s", 0.0, "velocity at the start"),
    )
    inputs: ClassVar = {"force": "1", "base_acceleration": "m/s^2"}
    derived_units: ClassVar = {
        "equivalent_mass": "kg",
        "mean_stiffness": "N/m",
        "natural_frequency": "1/s",
        "mean_load": "N",
        "amplitude": "m",
        "characteristic_time": "s",
    }

    def derived(self, values: Values, mean_stiffness: Tensor | None) -> dict[str, Tensor]:
        """Unit mass, natural frequency, reference amplitude and the characteristic time as stated, 0 for none."""
        stiffness = values["stiffness"]
        one = torch.ones_like(stiffness)
        return {
            "equivalent_mass": one,
            "mean_stiffness": stiffness,
            "natural_frequency": torch.sqrt(stiffness),
            "mean_load": 0 * one,
            "amplitude": values["amplitude"],
            "characteristic_time": values["characteristic_time"],
        }

    def scales(self, derived: Values) -> Scales:
        """Unit mass, reference amplitude and characteristic time; the unit of velocity is their quotient."""
        frequency, stated = derived["natural_frequency"], derived["characteristic_time"]
        own = 1 / torch.where(frequency > 0, frequency, torch.ones_like(frequency))
        return Scales(derived["equivalent_mass"], derived["amplitude"], torch.where(stated > 0, stated, own))

    def stiffness(self, p: Values) -> Tensor:
        """The constant stiffness per mass."""
        return p["stiffness"]

    def load(self, now: Moment, p: Values) -> Tensor:
        """The measured force times its gain, less the acceleration of the base; free decay without either."""
        load = torch.zeros_like(now.displacement)
        if "force" in now.inputs:
            load = p["force_gain"] * now.inputs["force"]
        if "base_acceleration" in now.inputs:
            load = load - p["equivalent_mass"] * now.inputs["base_acceleration"]
        return load
