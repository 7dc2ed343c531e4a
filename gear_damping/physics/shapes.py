"""Small shapes that several effects share: powers without infinite slopes, checks of lists."""

from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.physics.terms import Values

SMALLEST = 1e-100  # natural size below which a power counts as zero, so that its slope stays finite


def power_of_size(value: Tensor, exponent: Tensor) -> Tensor:
    """|value|^exponent with a finite slope everywhere, also at 0."""
    return value.abs().clamp(min=SMALLEST) ** exponent


def same_length(effect: str, values: Values, first: str, second: str) -> None:
    """Raise InputError unless two lists of an effect have the same length."""
    lengths = values[first].shape[0], values[second].shape[0]
    if lengths[0] != lengths[1]:
        rule = f"has {lengths[1]} values, {first} has {lengths[0]}"
        raise InputError(Problem(f"simulator.{effect}.{second}", rule, remedy="give both equally many"))
