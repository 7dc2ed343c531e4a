"""Errors of the single tooth pitches."""

from collections.abc import Mapping, Sequence
from math import pi
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.physics.cause import SHAFTS, Cause, Recipe, Rig
from gear_damping.physics.kinematics import Kinematics, Rotation
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.shaft_order import harmonics
from gear_damping.physics.shapes import padded
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import TransmissionErrorSource, Values

HANDOVERS = (0.05, 1.0)  # of a pitch; two pairs carry for the contact ratio less one
EDGES = (0.05, 1.0)  # of the handover; 1 is one ramp, and a shorter one would be missed by steps
STEP = 0.13  # of the handover, assumed: a pair takes its load within a tenth of a pitch
DISC = 2  # orders of the error of an encoder's disc: it sits eccentric, and tilted
SMOOTH = 0.9  # of the power of all orders: what an encoder's other errors are beside these two
# um, assumed: without a pattern, and a few times less than the static deflection of 17 um.
TYPICAL = (2, -1, 3, -4, 1, 5, -3, 0, 2, -2, 4, -5, 1, 3, -1, -3, 2, 0, -4, 2)


def _of_an_encoder(own: Mapping[str, Sequence[float]]) -> tuple[str, ...]:
    """What it looks like where the teeth lie on a wave of one or two periods a turn, as a disc on a shaft makes it."""
    teeth = torch.tensor(own.get("values", (0.0,)), dtype=torch.float64)
    power = torch.fft.rfft(teeth).abs().square()[1:]
    return ("encoder_error",) if len(power) > DISC and power[:DISC].sum() > SMOOTH * power.sum() else ()


def _by_shaft(rig: Rig) -> tuple[Recipe, ...]:
    """One error a tooth, on either shaft; a tooth takes over while two pairs carry, gradually or in two steps."""
    contact_ratio, mesh_phase = rig.values.get("contact_ratio", 1.6), rig.values.get("mesh_phase", 0.0)
    alone = mesh_phase - pi * contact_ratio  # of the mesh, in the middle of what a tooth carries
    both = min(max(contact_ratio - 1, 0.2), 0.9)
    stepped = min(both / (1 - STEP), 1.0)  # the steps have their middles where a pair meets and parts
    return tuple(
        Recipe(
            {"values": 3e-6},
            scanned={"phase": alone / rig.teeth(shaft), "handover": handover, "edge": edge},
            in_si=True,
            sharpest=("handover", "edge"),
            whole=("handover", "edge"),
            options={"shaft": shaft},
            length=rig.teeth(shaft),
        )
        for shaft in SHAFTS
        for handover, edge in ((both, 1.0), (stepped, STEP))
    )


class PitchError(TransmissionErrorSource):
    """One deviation a tooth, repeated every turn.

    While a pair of teeth carries alone, its deviation counts; while two carry, the next takes over: in one ramp, or
    where both are equally stiff in two steps with the mean of both between them. That gives sidebands of the shaft's
    order about every mesh order. Through sensors that weigh high frequencies, these are most of what is seen, and how
    smoothly a tooth takes over counts as much as its error. The mean is no error of the pitch and is removed.
    """

    name = "pitch_error"
    equation = "e = e_j about theta + phi = 2 pi j / z, next over h pitches by two ramps of w h, u + r sin(2 pi u)/2 pi"
    reference = "Velex & Maatar (1996), J. Sound Vib. 191(5)"
    parameters: ClassVar = (
        Parameter("values", "m", tuple(1e-6 * v for v in TYPICAL), "e_j, one value a tooth", -1e-3, 1e-3, vector=True),
        Parameter("phase", "rad", 0.0, "phi"),
        Parameter("handover", "1", 0.6, "h, share of a pitch over which the next tooth takes over", *HANDOVERS),
        Parameter("edge", "1", 1.0, "w, share of the handover that either of its two ramps takes; 1 is one", *EDGES),
        Parameter("rounding", "1", 1.0, "r, of a ramp without bends; 0 is a straight one", 0, 1),
    )
    options: ClassVar = (
        Option("shaft", SHAFTS, "pinion", "which of the two gears"),
        Option("form", ("handover", "interpolated"), "handover", "as stated, or trigonometric interpolation"),
    )
    mean_free: ClassVar = ("values",)
    needs: ClassVar = (Trait.SHAFTS, Trait.TEETH)
    cause: ClassVar = Cause(
        "errors of the pitch, tooth by tooth",
        _by_shaft,
        turns_with="tooth",
        looks_like=_of_an_encoder,
    )

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """The error of every tooth and of the next one; or cosine and sine parts by order."""
        teeth, count = values["values"], values["values"].shape[0]
        self._check_count(count, base[f"n_teeth_{self.chosen['shaft']}"])
        order = torch.arange(count // 2 + 1, dtype=teeth.dtype, device=teeth.device).unsqueeze(1)
        angle = order * torch.arange(count, dtype=teeth.dtype, device=teeth.device) * (2 * pi / count)
        twice = 1 + (2 * order < count).to(order)  # all but the highest order of an even count
        weight = twice * (order > 0) / count  # without the mean
        even, odd = (weight * (wave @ teeth) for wave in (torch.cos(angle), torch.sin(angle)))
        if self.chosen["form"] == "interpolated":
            turned = order * values["phase"]
            cosine, sine = torch.cos(turned), torch.sin(turned)
            parts = {"in_phase": even * cosine + odd * sine, "quadrature": odd * cosine - even * sine}
            return padded({name: part[1:] for name, part in parts.items()})
        own = torch.cos(angle).T @ even + torch.sin(angle).T @ odd
        phase = values["phase"]
        counted = {"teeth": torch.full_like(phase, count), "pitch": torch.full_like(phase, 2 * pi / count)}
        known = {name: values[name] for name in ("phase", "handover", "edge", "rounding")}
        return padded({"here": own, "following": own.roll(-1, 0)}) | known | counted

    def error(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """The error and its rate."""
        turn = getattr(at, self.chosen["shaft"])
        if self.chosen["form"] == "interpolated":
            return harmonics(turn, p["in_phase"], p["quadrature"])
        return _stepped(turn, p)

    def _check_count(self, count: int, teeth: Tensor) -> None:
        if not bool((teeth == count).all()):
            rule = f"has {count} values, the {self.chosen['shaft']} has {teeth.max().item():g} teeth"
            raise InputError(Problem("simulator.pitch_error.values", rule, remedy="give one value for each tooth"))


def _stepped(turn: Rotation, p: Values) -> tuple[Tensor, Tensor]:
    """From the error of the tooth in mesh to that of the next, and its rate."""
    passed = (turn.angle + p["phase"]) / p["pitch"]
    tooth = torch.floor(passed)
    share = torch.clamp((passed - tooth - 0.5) / p["handover"] + 0.5, 0.0, 1.0)
    tooth = tooth - p["teeth"] * torch.floor((tooth + 0.5) / p["teeth"])
    here = following = torch.zeros_like(passed)
    for number, (one, next_one) in enumerate(zip(p["here"].unbind(0), p["following"].unbind(0), strict=True)):
        is_it = tooth == number
        here, following = torch.where(is_it, one, here), torch.where(is_it, next_one, following)
    taken, slope = torch.zeros_like(share), torch.zeros_like(share)
    for first in (torch.zeros_like(p["edge"]), 1 - p["edge"]):
        ramp = torch.clamp((share - first) / p["edge"], 0.0, 1.0)
        around = 2 * pi * (ramp - 0.5)
        rising = (ramp > 0.0) & (ramp < 1.0)
        taken = taken + (ramp + p["rounding"] / (2 * pi) * torch.sin(around)) / 2
        slope = slope + torch.where(rising, (1 + p["rounding"] * torch.cos(around)) / 2, torch.zeros_like(ramp))
    inside = (share > 0.0) & (share < 1.0)
    taken = torch.where(inside, taken, share)
    slope = torch.where(inside, slope / (p["edge"] * p["handover"] * p["pitch"]), torch.zeros_like(slope))
    return here + (following - here) * taken, (following - here) * slope * turn.speed
