"""Profile error of the teeth."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.cause import Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.shaft_order import harmonics
from gear_damping.physics.shapes import padded, same_length
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import TransmissionErrorSource, Values

MOST_HARMONICS = 4  # beyond these a tooth's profile has little


def _visible_harmonics(rig: Rig) -> tuple[Recipe, ...]:
    """As many harmonics as the records show."""
    length = min(max(rig.mesh_harmonics, 1), MOST_HARMONICS)
    return (Recipe({"amplitudes": None}, {"amplitudes": "phases"}, length=length),)


class ProfileError(TransmissionErrorSource):
    """The same deviation on every tooth: harmonics of the mesh, whatever the load.

    A relief of the tips that every load closes is one: only where a light load leaves it open does it act otherwise.
    """

    name = "profile_error"
    equation = "e = sum_h E_h cos(h theta_M + phi_h), h = 1, 2, …"
    reference = "Kahraman & Singh (1990), J. Sound Vib. 142(1)"
    parameters: ClassVar = (
        Parameter("amplitudes", "m", (3e-6, 1e-6), "E_h by harmonic", 0, 1e-3, vector=True),
        Parameter("phases", "rad", (0.0, 0.0), "phi_h by harmonic", vector=True),
    )
    needs: ClassVar = (Trait.TEETH,)
    cause: ClassVar = Cause(
        "errors of the tooth profile, or a relief of it that every load closes",
        _visible_harmonics,
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Cosine and sine parts by harmonic."""
        same_length(self.name, values, "amplitudes", "phases")
        amplitudes, phases = values["amplitudes"], values["phases"]
        return padded({"in_phase": amplitudes * torch.cos(phases), "quadrature": -amplitudes * torch.sin(phases)})

    def error(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """The error and its rate."""
        return harmonics(at.mesh, p["in_phase"], p["quadrature"])
