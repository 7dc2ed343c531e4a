"""Profile error of the teeth."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.moment import Moment
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import TransmissionErrorSource, Values


class ProfileError(TransmissionErrorSource):
    """The same deviation on every tooth: harmonics of the mesh, whatever the load."""

    name = "profile_error"
    equation = "e = sum_h E_h cos(h theta_M + phi_h), h = 1, 2, …"
    reference = "Kahraman & Singh (1990), J. Sound Vib. 142(1)"
    parameters: ClassVar = (
        Parameter("amplitudes", "m", (3e-6, 1e-6), "E_h by harmonic", 0, 1e-3, vector=True),
        Parameter("phases", "rad", (0.0, 0.0), "phi_h by harmonic", vector=True),
    )
    systems: ClassVar = ("gear_pair",)

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Cosine and sine parts by harmonic."""
        amplitudes, phases = values["amplitudes"], values["phases"]
        return {"in_phase": amplitudes * torch.cos(phases), "quadrature": -amplitudes * torch.sin(phases)}

    def error(self, now: Moment, p: Values) -> tuple[Tensor, Tensor]:
        """The error and its rate; multiples of the mesh angle by rotation."""
        cosine, sine = now.mesh.cos, now.mesh.sin
        error, slope = torch.zeros_like(cosine), torch.zeros_like(cosine)
        turned_cosine, turned_sine = torch.ones_like(cosine), torch.zeros_like(cosine)
        for h in range(p["in_phase"].shape[0]):
            turned_cosine, turned_sine = (
                turned_cosine * cosine - turned_sine * sine,
                turned_sine * cosine + turned_cosine * sine,
            )
            error = error + p["in_phase"][h] * turned_cosine + p["quadrature"][h] * turned_sine
            slope = slope + (h + 1) * (p["quadrature"][h] * turned_cosine - p["in_phase"][h] * turned_sine)
        return error, slope * now.mesh.speed
