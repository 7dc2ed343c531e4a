"""Hysteresis of the mesh."""

from collections.abc import Mapping
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.shapes import power_of_size
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import DampingForce, ExtraStates, Values

YIELDS = (0.05, 0.2, 0.6)  # amplitudes of the motion
PRELOADED = (0.2,)  # in natural units: a loaded mesh moves about its deflection
SOFTEST = 0.3  # least sharpness: half of the force is yielded already at a tenth of z_y (0.1^0.3 = 0.5)
EXPONENTS = (SOFTEST, 4.0)  # of the sharpness that is fitted
LATEST = 10.0  # amplitudes of the motion: what yields later is a spring, from wherever each stretch of a record begins
EARLY = 0.1  # of the amplitude: the loss of a cycle is within a tenth that of dry friction, 4 F (A - z_y) of 4 F A


def _as_friction(values: Mapping[str, float], stiffness: float, amplitude: float) -> tuple[str, float] | None:
    """A dry friction where it yields early in every swing."""
    if values["yield_deflection"] > EARLY * amplitude:
        return None
    share = 100 * values["yield_deflection"] / amplitude
    words = f"`hysteretic_damping` yields at {share:.2g} % of the amplitude of the motion: it acts as a dry friction"
    return words, values["share"] * stiffness * values["yield_deflection"]


def _switched_on(rig: Rig) -> tuple[Recipe, ...]:
    """From several yields, or one where flanks hold a load and hardly tell them apart.

    Motion in one direction has yielded and slides, as dry friction does.
    """
    if rig.one_way:
        return ()
    within = {"hysteretic_damping.exponent": EXPONENTS}
    return tuple(
        Recipe(
            {"share": 0.02},
            scanned={"yield_deflection": size, "exponent": 1.0},
            within=within,
            most={"yield_deflection": LATEST},
        )
        for size in (PRELOADED if rig.has(Trait.PRELOAD) else YIELDS)
    )


class HystereticDamping(ExtraStates, DampingForce):
    """An elastic force that yields: its loss per cycle does not depend on the rate.

    It stores energy, beta k z^2 / 2, and gives back less than it took. Out of contact the
    hysteretic deflection relaxes within 1/omega_n, so that every contact starts anew.
    """

    name = "hysteretic_damping"
    refinement = 1.45  # of the steps, measured by step halving: the force bends where the motion turns
    equation = "F_d = beta k z, z' = delta' - |z / z_y|^n (delta' + |delta'| sign z) / 2"
    reference = "Wen (1976), J. Eng. Mech. Div. ASCE 102(2)"
    parameters: ClassVar = (
        Parameter("share", "1", 0.02, "beta, share of the mean stiffness", 0, 1000),
        Parameter("yield_deflection", "m", 2e-6, "z_y, largest hysteretic deflection", 1e-12, 1e9),
        Parameter("exponent", "1", 1.0, "n, sharpness of the yielding", SOFTEST, 10),
    )
    states: ClassVar = {"deflection": "m"}
    dissipative = True
    cause: ClassVar = Cause(
        "a hysteretic force, whose loss does not depend on the rate",
        _switched_on,
        separated_by="speed",
        acts_as=_as_friction,
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The stiffness that yields, and a rate at which yielding is stable, if not resolved."""
        return {
            "stiffness": values["share"] * base["mean_stiffness"],
            "yield_deflection": values["yield_deflection"],
            "exponent": values["exponent"],
            "fastest_rate": values["exponent"] / values["yield_deflection"] / 3,
        }

    def damping_force(self, at: Kinematics, p: Values) -> Tensor:
        """The force at this instant."""
        return p["stiffness"] * at.extra["hysteretic_damping.deflection"]

    def state_rates(self, at: Kinematics, p: Values) -> dict[str, Tensor]:
        """Yielding in contact, relaxation out of it."""
        z, rate = at.extra["hysteretic_damping.deflection"], at.delta_rate
        yielding = power_of_size(z / p["yield_deflection"], p["exponent"]) * (rate + rate.abs() * torch.sign(z)) / 2
        return {"deflection": at.contact * (rate - yielding) - (1 - at.contact) * z}
