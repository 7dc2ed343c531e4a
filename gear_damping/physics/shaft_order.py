"""What the effects that turn with a shaft have in common."""

from collections.abc import Sequence
from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.kinematics import Kinematics, Rotation
from gear_damping.physics.parameter import Option, Parameter
from gear_damping.physics.scales import Scales
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import StiffnessFactor, TransmissionErrorSource, Values


class Eccentricity(TransmissionErrorSource, StiffnessFactor):
    """The geometric centre of a gear runs on a circle about its shaft."""

    shaft: ClassVar[str]
    reference = "Velex & Maatar (1996), J. Sound Vib. 191(5); Yousfi et al. (2026) add E to K instead"
    parameters: ClassVar = (
        Parameter("amplitude", "m", 2e-5, "eccentricity along the line of action", 0, 1e-2),
        Parameter("phase", "rad", 0.0, "phase at shaft angle zero"),
    )
    options: ClassVar = (
        Option("as_printed", (False, True), False, "the bare number E is added to the stiffness in N/m"),
    )
    needs: ClassVar = (Trait.SHAFTS, Trait.TEETH)

    def to_natural(self, values: Values, scales: Scales) -> dict[str, Tensor]:
        """A length, or as printed a stiffness."""
        unit = scales.force / scales.length if self.chosen["as_printed"] else scales.length
        return {"amplitude": values["amplitude"] / unit, "phase": values["phase"]}

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Cosine and sine parts."""
        return cosine_and_sine(values)

    def error(self, at: Kinematics, p: Values) -> tuple[Tensor, Tensor]:
        """E cos(theta + phase) and its rate."""
        if self.chosen["as_printed"]:
            return torch.zeros_like(at.displacement), torch.zeros_like(at.displacement)
        turn = getattr(at, self.shaft)
        return wave(turn, p), wave_rate(turn, p)

    def factor(self, at: Kinematics, p: Values) -> Tensor:
        """1, or as printed (k + E cos(theta + phase)) / k."""
        if not self.chosen["as_printed"]:
            return torch.ones_like(at.displacement)
        return 1 + wave(getattr(at, self.shaft), p) / at.stiffness


class StiffnessModulation(StiffnessFactor):
    """The mesh stiffness varies once per turn of a shaft."""

    shaft: ClassVar[str]
    reference = "Kahraman & Singh (1991), J. Sound Vib. 146(1)"
    parameters: ClassVar = (
        Parameter("amplitude", "1", 0.01, "share of the stiffness", 0, 0.9),
        Parameter("phase", "rad", 0.0, "phase at shaft angle zero"),
    )
    needs: ClassVar = (Trait.SHAFTS, Trait.TEETH)

    def prepare(self, values: Values, base: Values) -> dict[str, Tensor]:
        """Cosine and sine parts."""
        return cosine_and_sine(values)

    def factor(self, at: Kinematics, p: Values) -> Tensor:
        """1 + amplitude cos(theta + phase)."""
        return 1 + wave(getattr(at, self.shaft), p)


def cosine_and_sine(values: Values) -> dict[str, Tensor]:
    """The parts of amplitude cos(theta + phase) that go with cos theta and sin theta."""
    amplitude, phase = values["amplitude"], values["phase"]
    return {"in_phase": amplitude * torch.cos(phase), "quadrature": -amplitude * torch.sin(phase)}


def wave(turn: Rotation, p: Values) -> Tensor:
    """Amplitude cos(theta + phase)."""
    return p["in_phase"] * turn.cos + p["quadrature"] * turn.sin


def wave_rate(turn: Rotation, p: Values) -> Tensor:
    """Its rate."""
    return turn.speed * (p["quadrature"] * turn.cos - p["in_phase"] * turn.sin)


def periodic(turn: Rotation, in_phase: Tensor, quadrature: Tensor) -> Tensor:
    """A periodic function of an angle, by Clenshaw's recurrence; lists as for `harmonics`."""
    return _periodic(turn, in_phase.unbind(0), quadrature.unbind(0))


def _periodic(turn: Rotation, in_phase: Sequence[Tensor], quadrature: Sequence[Tensor]) -> Tensor:
    even, odd = _recurrence(turn, in_phase), _recurrence(turn, quadrature)
    return turn.cos * even[0] - even[1] + turn.sin * odd[0]


def harmonics(turn: Rotation, in_phase: Tensor, quadrature: Tensor) -> tuple[Tensor, Tensor]:
    """A periodic function of an angle and its rate, by Clenshaw's recurrence.

    Args:
        turn: The angle.
        in_phase: Cosine parts by harmonic 1, 2, …, (n, batch).
        quadrature: Sine parts by harmonic.
    """
    slopes = (
        [sign * h * part for h, part in enumerate(parts.unbind(0), 1)]
        for sign, parts in ((1, quadrature), (-1, in_phase))
    )
    return periodic(turn, in_phase, quadrature), _periodic(turn, *slopes) * turn.speed


def _recurrence(turn: Rotation, parts: Sequence[Tensor]) -> tuple[Tensor, Tensor]:
    """The last two values of b_h = a_h + 2 cos(angle) b_(h+1) - b_(h+2), for h = 1 and 2.

    A step waits for one product of the step before it, not for a product and a difference.
    """
    twice, zero = 2 * turn.cos, torch.zeros_like(turn.cos)
    last, before = zero, zero
    for part in reversed(parts):
        last, before = (part - before) + twice * last, last
    return last, before
