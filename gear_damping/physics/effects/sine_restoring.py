"""Restoring force of a pendulum."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import ElasticForce, SystemChange, Values

SIZES = (1.0, 1.3, 2.0)  # of the linear stiffness that swings as fast: the wider the swing, the more
FIRST_LENGTH = 3.0  # amplitudes, where the response is no angle


def _instead_of_a_spring(rig: Rig) -> tuple[Recipe, ...]:
    """It takes the place of the linear spring; its length is known where the response is an angle."""
    known = {"length": rig.radian} if rig.radian else {}
    free = {} if rig.radian else {"length": FIRST_LENGTH}
    return tuple(
        Recipe(
            {"stiffness": size},
            fixed=known,
            scanned=free,
            non_nested=True,
            in_si=rig.radian is not None,
            replaces={rig.spring: "stiffness"} if rig.spring else {},
        )
        for size in SIZES
    )


class SineRestoring(ElasticForce, SystemChange):
    """Gravity on a pendulum whose displacement is an angle; the oscillator's own stiffness may be 0.

    The natural frequency is that of small oscillations.
    """

    name = "sine_restoring"
    equation = "N + k l sin(x / l), l = 1 for an angle in rad"
    reference = "Nayfeh & Mook (1979), Nonlinear Oscillations, Wiley"
    parameters: ClassVar = (
        Parameter("stiffness", "N/m", 1.0, "k, per mass at small angles: g / length of the pendulum", 0, 1e18),
        Parameter("length", "m", 1.0, "l, one radian in the unit of the displacement", 1e-9, 1e9),
    )
    needs: ClassVar = (Trait.REST,)
    radian: ClassVar = "length"
    cause: ClassVar = Cause(
        "the restoring force of a pendulum",
        _instead_of_a_spring,
    )

    def change(self, values: Values, derived: dict[str, Tensor]) -> dict[str, Tensor]:
        """Stiffness and natural frequency of small oscillations."""
        stiffness = derived["mean_stiffness"] + values["stiffness"]
        frequency = torch.sqrt(stiffness / derived["equivalent_mass"])
        return derived | {"mean_stiffness": stiffness, "natural_frequency": frequency}

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The parameters, and the rate of small oscillations."""
        return dict(values) | {"fastest_rate": torch.sqrt(base["mean_stiffness"] / base["equivalent_mass"])}

    def elastic_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        return p["stiffness"] * p["length"] * torch.sin(at.deflection / p["length"])
