"""Small shapes that several effects share: powers without infinite slopes, a shaft's share, checks of lists."""

from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.physics.cause import SHAFTS, Rig
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import Values

# Widths within which the sign change of a friction is fitted. A mesh rings fast beside its sampling, and steps that
# follow a sharper change cost too much; what comes to rest needs one, or it creeps under its load.
WIDTH_OF_MESH, WIDTH_AT_REST = (0.02, 0.5), (0.001, 0.5)
HARMONICS_AT_ONCE = 4  # in a kernel: lists are filled up to a multiple of it
SMALLEST = 1e-100  # natural size below which a power counts as zero, so that its slope stays finite


def friction_width(rig: Rig) -> tuple[float, float]:
    """Least and largest width of the sign change of a friction that is fitted on a rig."""
    return WIDTH_OF_MESH if rig.has(Trait.TEETH) and not rig.standing else WIDTH_AT_REST


def power_of_size(value: Tensor, exponent: Tensor) -> Tensor:
    """|value|^exponent with a finite slope everywhere, also at 0."""
    return value.abs().clamp(min=SMALLEST) ** exponent


def sign_change_rate(force: Tensor, width: Tensor, mass: Tensor) -> Tensor:
    """The rate that a step must resolve where a friction force of this size turns within a velocity width.

    Natural units. The slope alone would allow steps that jump over the turn; the share of the width that
    a step may cover was measured by step halving.
    """
    return torch.maximum(force / (width * mass), 0.09 / width)


def share_of_shaft(shaft: str, base: Mapping[str, Any]) -> Any:
    """The part of the acceleration along the line of action that a mesh force gives to the gear of a shaft."""
    own, other = (
        base[f"base_radius_{one}"] ** 2 / base[f"inertia_{one}"] for one in sorted(SHAFTS, key=lambda s: s != shaft)
    )
    return own / (own + other)


def padded(parts: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Lists of harmonics, (n, batch) each, with harmonics of size 0 behind them, up to a multiple of a few.

    The compiled kernel of a model follows from the lengths of its lists: models with nearly as many harmonics then
    share one, at less than a tenth more time per step.
    """
    pad = torch.nn.functional.pad
    return {name: pad(rows, (0, 0, 0, -rows.shape[0] % HARMONICS_AT_ONCE)) for name, rows in parts.items()}


def same_length(effect: str, values: Values, first: str, second: str) -> None:
    """Raise InputError unless two lists of an effect have the same length."""
    lengths = values[first].shape[0], values[second].shape[0]
    if lengths[0] != lengths[1]:
        rule = f"has {lengths[1]} values, {first} has {lengths[0]}"
        raise InputError(Problem(f"simulator.{effect}.{second}", rule, remedy="give both equally many"))
