"""Natural units: each member is integrated with its own mass, length and time as units.

The equations are homogeneous, so the same code runs in any consistent set of units. With the
equivalent mass, the static deflection F0/k0 and 1/omega_n as units every term of a gear pair is
of order one, whatever its size: solver settings then mean the same for every member.
"""

from dataclasses import dataclass
from functools import reduce
from operator import mul

import torch
from torch import Tensor

from gear_damping.units import Dimension


@dataclass(frozen=True)
class Scales:
    """Units of one batch: mass (kg), length (m) and time (s), each of shape (batch,)."""

    mass: Tensor
    length: Tensor
    time: Tensor

    def unit_of(self, dimension: Dimension) -> Tensor:
        """The natural unit of a quantity of this dimension, in SI; shape (batch,)."""
        bases = ((self.mass, dimension.mass), (self.length, dimension.length), (self.time, dimension.time))
        powers = [base if power == 1 else base**power for base, power in bases if power]
        return reduce(mul, powers) if powers else torch.ones_like(self.mass)

    @property
    def velocity(self) -> Tensor:
        """The natural unit of velocity (m/s)."""
        return self.length / self.time

    @property
    def force(self) -> Tensor:
        """The natural unit of force (N)."""
        return self.mass * self.length / self.time**2
