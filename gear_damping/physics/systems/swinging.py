"""What systems have in common that swing about a place of rest on a constant spring."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.scales import Scales
from gear_damping.physics.systems.base import System, Values
from gear_damping.physics.systems.traits import Trait

FORCE, BASE = "force", "base_acceleration"  # inputs
# parameters of every one of them, beside its own: the solver's units, and the motion at the start
MOTION = (
    Parameter("amplitude", "m", 1.0, "a typical displacement, the unit of length of the solver", 0, 1e9),
    Parameter(
        "characteristic_time", "s", 0.0, "unit of time of the solver; 0: 1/omega_n, without a spring 1 s", 0, 1e9
    ),
    Parameter("initial_displacement", "m", 0.0, "displacement at the start"),
    Parameter("initial_velocity", "m/s", 0.0, "velocity at the start"),
)


class Swinging(System):
    """m x'' + F_d(x') + k x + F_el(x) = gain * u(t) - m a_b(t).

    Derive from it, name the parameter that is k (`spring`) and end `parameters` with `MOTION`; `mass` is 1 unless
    said otherwise. Its records have the channels of `responses` and of `inputs`.
    """

    response = "displacement"
    responses: ClassVar = ("displacement", "velocity", "acceleration")
    traits: ClassVar = frozenset({Trait.REST})
    inputs: ClassVar = {FORCE: "1", BASE: "m/s^2"}
    derived_units: ClassVar = {
        "equivalent_mass": "kg",
        "mean_stiffness": "N/m",
        "natural_frequency": "1/s",
        "mean_load": "N",
        "amplitude": "m",
        "characteristic_time": "s",
    }
    covered_by_nuisance: ClassVar = frozenset({"sensor_offset"})

    def mass(self, values: Values) -> Tensor:
        """What moves, from the parameters in SI."""
        return torch.ones_like(values[self.spring])

    def derived(self, values: Values, mean_stiffness: Tensor | None) -> dict[str, Tensor]:
        """Mass, natural frequency, reference amplitude and the characteristic time as stated, 0 for none."""
        stiffness, mass = values[self.spring], self.mass(values)
        return {
            "equivalent_mass": mass,
            "mean_stiffness": stiffness,
            "natural_frequency": torch.sqrt(stiffness / mass),
            "mean_load": torch.zeros_like(stiffness),
            "amplitude": values["amplitude"],
            "characteristic_time": values["characteristic_time"],
        }

    def scales(self, derived: Values) -> Scales:
        """Mass, reference amplitude and characteristic time; the unit of velocity is their quotient."""
        frequency, stated = derived["natural_frequency"], derived["characteristic_time"]
        own = 1 / torch.where(frequency > 0, frequency, torch.ones_like(frequency))
        return Scales(derived["equivalent_mass"], derived["amplitude"], torch.where(stated > 0, stated, own))

    def stiffness(self, p: Values) -> Tensor:
        """The constant stiffness."""
        return p[self.spring]

    def load(self, at: Kinematics, p: Values) -> Tensor:
        """The measured force times its gain, less what the base's acceleration takes; free decay without either."""
        load = torch.zeros_like(at.displacement)
        if FORCE in at.inputs:
            load = p[self.gains[FORCE]] * at.inputs[FORCE] if FORCE in self.gains else at.inputs[FORCE]
        if BASE in at.inputs:
            load = load - p["equivalent_mass"] * at.inputs[BASE]
        return load
