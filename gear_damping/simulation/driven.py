"""What drives a batch beside its parameters."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from torch import Tensor


@dataclass(frozen=True)
class Driven:
    """Measured series, states that depart from their place at the start, and the seed of what is drawn.

    Args:
        series: Measured series at the output instants, (batch, time), or fewer rows that the batch repeats:
            `force`, `base_acceleration` in m/s^2 (oscillator), `pinion_torque`, `gear_torque` in N m, `pinion_angle`
            in rad, unwrapped.
        held: Names of those that stay at a sample's value until the next one, as a controller puts them out.
        initial_perturbations: Of states of effects, from where their effect puts them at the start, (batch,) in SI by
            flat name (`shaft_torsion.twist`).
        seed: Of drawn loads.
    """

    series: Mapping[str, Tensor] = field(default_factory=dict)
    held: Collection[str] = ()
    initial_perturbations: Mapping[str, Tensor] = field(default_factory=dict)
    seed: int = 0
