"""Errors of the single tooth pitches."""

from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.physics.cause import SHAFTS, Cause, Recipe, Rig
from gear_damping.physics.moment import Moment
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.shaft_order import harmonics
from gear_damping.physics.shapes import padded
from gear_damping.physics.terms import TransmissionErrorSource, Values

MESHES = 2  # orders are kept up to so many mesh orders
HANDOVERS = (0.05, 1.0)  # of a pitch; two pairs carry for the contact ratio less one
TYPICAL = (2, -1, 3, -4, 1, 5, -3, 0, 2, -2, 4, -5, 1, 3, -1, -3, 2, 0, -4, 2)  # um


def _by_shaft(rig: Rig) -> tuple[Recipe, ...]:
    """One error a tooth, on either shaft; a tooth takes over while two pairs carry."""
    contact_ratio, mesh_phase = rig.values.get("contact_ratio", 1.6), rig.values.get("mesh_phase", 0.0)
    alone = mesh_phase - pi * contact_ratio  # of the mesh, in the middle of what a tooth carries
    return tuple(
        Recipe(
            {"values": 3e-6},
            scanned={"phase": alone / rig.teeth(shaft), "handover": min(max(contact_ratio - 1, 0.2), 0.9)},
            in_si=True,
            sharpest=("handover",),
            options={"shaft": shaft},
            length=rig.teeth(shaft),
        )
        for shaft in SHAFTS
    )


def _window(order: Tensor, share: Tensor) -> Tensor:
    """Spectrum, by mesh order, of one tooth's part of a turn: a pitch wide, its edges smoothed over a share of it."""
    smooth = order * share
    return torch.sinc(order) * (torch.sinc(smooth - 0.5) + torch.sinc(smooth + 0.5)) * (pi / 4)


class PitchError(TransmissionErrorSource):
    """One deviation a tooth, repeated every turn.

    While a pair of teeth carries alone, its deviation counts; while two carry, the next takes over. That gives
    sidebands of the shaft's order about every mesh order. Through sensors that weigh high frequencies, these are most
    of what is seen. Orders up to two meshes are kept. The mean is no error of the pitch and the first order is
    eccentricity: both are removed.
    """

    name = "pitch_error"
    equation = "e(theta) = e_j about theta + phi = 2 pi j / z, from one to the next by a cosine over h of a pitch"
    reference = "Velex & Maatar (1996), J. Sound Vib. 191(5)"
    parameters: ClassVar = (
        Parameter("values", "m", tuple(1e-6 * v for v in TYPICAL), "e_j, one value a tooth", -1e-3, 1e-3, vector=True),
        Parameter("phase", "rad", 0.0, "phi"),
        Parameter("handover", "1", 0.6, "h, share of a pitch over which the next tooth takes over", *HANDOVERS),
    )
    options: ClassVar = (
        Option("shaft", SHAFTS, "pinion", "which of the two gears"),
        Option("form", ("handover", "interpolated"), "handover", "as stated, or trigonometric interpolation"),
    )
    systems: ClassVar = ("gear_pair",)
    cause: ClassVar = Cause(
        "errors of the pitch, tooth by tooth",
        _by_shaft,
        turns_with="tooth",
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Cosine and sine parts by shaft order."""
        teeth, count = values["values"], values["values"].shape[0]
        self._check_count(count, base[f"n_teeth_{self.chosen['shaft']}"])
        steps = self.chosen["form"] == "handover"
        order = torch.arange(1, 1 + (MESHES * count if steps else count // 2), dtype=teeth.dtype, device=teeth.device)
        angle = order.unsqueeze(1) * torch.arange(count, dtype=teeth.dtype, device=teeth.device) * (2 * pi / count)
        is_none = torch.isin(order % count, order.new_tensor([0, 1, count - 1]))  # the mean, and eccentricity
        weight = (2 / count * (~is_none).to(teeth)).unsqueeze(1)
        if steps:
            weight = weight * _window(order.unsqueeze(1) / count, values["handover"])
        elif count % 2 == 0:
            weight[-1] = 1 / count
        even, odd = (weight * (wave @ teeth) for wave in (torch.cos(angle), torch.sin(angle)))
        turned = order.unsqueeze(1) * values["phase"]
        cosine, sine = torch.cos(turned), torch.sin(turned)
        return padded({"in_phase": even * cosine + odd * sine, "quadrature": odd * cosine - even * sine})

    def error(self, now: Moment, p: Values) -> tuple[Tensor, Tensor]:
        """The error and its rate."""
        return harmonics(getattr(now, self.chosen["shaft"]), p["in_phase"], p["quadrature"])

    def _check_count(self, count: int, teeth: Tensor) -> None:
        if not bool((teeth == count).all()):
            rule = f"has {count} values, the {self.chosen['shaft']} has {teeth.max().item():g} teeth"
            raise InputError(Problem("simulator.pitch_error.values", rule, remedy="give one value for each tooth"))
