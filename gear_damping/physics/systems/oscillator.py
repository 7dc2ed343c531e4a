"""A mass-normalised oscillator, x'' + F_d(x') + k x + F_el(x) = gain * u(t) - a_b(t).

It covers any single-degree-of-freedom rig with a measured force input, or its free decay, and is
how measured records are brought in. Its displacement may be in any unit (m, rad, V): "m" in the
declarations then stands for that unit (the option `unit`), and forces are accelerations in it.

On a base that moves with the acceleration a_b, x is the displacement relative to the base.
"""

from typing import ClassVar

from gear_damping.physics.parameter import Parameter, UnitOption
from gear_damping.physics.systems.swinging import FORCE, MOTION, Swinging
from gear_damping.units import per_mass


class Oscillator(Swinging):
    """The base of any single-degree-of-freedom rig, per unit of mass."""

    name = "oscillator"
    spring = "stiffness"
    options = (UnitOption("unit", ("m",), "m", "what its displacement is in, `mm` or `V`; null: unknown"),)
    gains: ClassVar = {FORCE: "force_gain"}
    parameters: ClassVar = (
        Parameter("stiffness", "N/m", 1.0, "stiffness per mass; 0 is allowed", 0, 1e18),
        Parameter("force_gain", "N", 1.0, "force per mass and unit of input", -1e18, 1e18),
        *MOTION,
    )
    covered_by_nuisance: ClassVar = frozenset({"sensor_offset", "sensor_gain"})

    def unit_of(self, declared: str) -> str:
        """The unit of what is declared in `declared`: per unit of mass, in metres too; its stiffness is in 1/s^2."""
        return per_mass(declared, self.chosen["unit"])
