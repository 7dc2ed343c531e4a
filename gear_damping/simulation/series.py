"""Input series between their samples: one polynomial for each output interval.

A measured series is band-limited: it is interpolated by a windowed sinc to five points of each
interval, and the quartic through them is what the solver sees, smooth inside every step. Of an angle,
which grows, that is done with what is left of it beside the straight line from its first to its last
sample; its rate is the derivative of the quartic. A drawn load is held over its interval, and so is an input that a
controller puts out in steps.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from math import lcm

import numpy as np
import torch
from torch import Tensor

from gear_damping.physics.equation import HELD_LOAD
from gear_damping.signals.envelope import upsample

ANGLE, ANGLE_RATE = "pinion_angle", "pinion_angle_rate"
_KEPT = "_gear_damping_coefficients"  # attribute of a series
POINTS = 4  # sub-intervals of an output interval at which the sinc interpolation is taken
MARGIN = 32  # samples of odd reflection beyond each end, which the sinc interpolation needs
# From values at the sub-intervals' ends to the polynomial through them, over the interval from 0 to 1.
_TO_COEFFICIENTS = torch.tensor(np.linalg.inv(np.vander(np.linspace(0, 1, POINTS + 1), increasing=True)))


@dataclass(frozen=True)
class SharedSeries:
    """Coefficients of inputs that members of a batch have in common.

    A fit simulates every record a hundred times at once, with the same inputs in units that differ by member: written
    out for every member they would fill the memory again and again.

    Args:
        coefficients: As recorded, (intervals, rows, sources).
        source: Which of them drives a member, (batch,).
        factor: One over each member's natural unit, (rows, batch).
    """

    coefficients: Tensor
    source: Tensor
    factor: Tensor

    def __len__(self) -> int:
        """Output intervals."""
        return len(self.coefficients)

    def __getitem__(self, interval: int) -> Tensor:
        """What drives every member in one interval, natural units, (rows, batch)."""
        return self.coefficients[interval][:, self.source] * self.factor

    def of(self, indices: Tensor) -> "SharedSeries":
        """That of some members."""
        return replace(self, source=self.source[indices], factor=self.factor[:, indices].contiguous())

    def to(self, device: torch.device) -> "SharedSeries":
        """On a device."""
        return SharedSeries(self.coefficients.to(device), self.source.to(device), self.factor.to(device))

    def for_each(self) -> Tensor:
        """Natural units of every member, (intervals, rows, batch)."""
        return self.coefficients[..., self.source] * self.factor

    @classmethod
    def written_out(cls, packed: Tensor) -> "SharedSeries":
        """From natural units of every member, (intervals, rows, batch)."""
        own = torch.arange(packed.shape[2], device=packed.device)
        return cls(packed.contiguous(), own, packed.new_ones(packed.shape[1:]))


class Series:
    """Coefficients of every input series, and their evaluation inside an interval.

    Written out for every member they have shape (intervals, rows, batch).
    """

    def __init__(self, names: tuple[str, ...]) -> None:
        """Order the rows of the inputs called `names`."""
        self.names = names
        self.heights = [_height(name) for name in names]

    def shared(
        self,
        inputs: Mapping[str, Tensor],
        units: Mapping[str, Tensor],
        intervals: int,
        batch: int,
        held: Collection[str] = (),
    ) -> SharedSeries:
        """Coefficients, with what members have in common written once.

        Args:
            inputs: Series of shape (rows, time), or (rows, intervals) if held; where a batch repeats them,
                each is interpolated once.
            units: Their natural units, (batch,); of a held load none.
            intervals: Output intervals.
            batch: Members, a multiple of the rows.
            held: Names of those that stay at a sample's value until the next one.
        """
        sources = lcm(*(len(inputs[name]) for name in self.names))
        parts, factors = [torch.empty(intervals, 0, sources, dtype=torch.float64)], []
        for name, height in zip(self.names, self.heights, strict=True):
            found = _kept_coefficients(name, inputs[name].to(torch.float64), name in held).permute(1, 0, 2)
            parts.append(found.repeat(1, 1, sources // found.shape[-1]))
            unit = units.get(name, torch.ones(batch, dtype=torch.float64))
            factors.append((1 / unit.to(torch.float64)).expand(height, batch))
        factor = torch.cat(factors) if factors else torch.empty(0, batch, dtype=torch.float64)
        return SharedSeries(torch.cat(parts, 1), torch.arange(batch) % sources, factor)

    def at(self, rows: Tensor, u: Tensor, interval: Tensor) -> dict[str, Tensor]:
        """Every input at position `u` (0…1) of the interval whose rows these are."""
        found, row = {}, 0
        for name, height in zip(self.names, self.heights, strict=True):
            coefficients = rows[row : row + height].unbind(0)
            found[name] = _polynomial(coefficients, u)
            if name == ANGLE:
                slopes = [k * coefficient for k, coefficient in enumerate(coefficients)][1:]
                found[ANGLE_RATE] = _polynomial(slopes, u) / interval
            row += height
        return found


def continued(values: Tensor, length: int) -> Tensor:
    """A series (time,) followed by its point reflection about its end, `length` samples in all.

    That is how the interpolation takes it beyond its end: where series of one batch differ in length, the shorter
    ones are interpolated as they would be alone. Zeros after the end would ring back into them.
    """
    while len(values) < length:
        mirrored = 2 * values[-1] - values[:-1].flip(0) if len(values) > 1 else values
        values = torch.cat([values, mirrored])
    return values[:length]


def _polynomial(coefficients: Sequence[Tensor], u: Tensor) -> Tensor:
    """Value at u; powers of u ascending."""
    value = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        value = value * u + coefficient
    return value


def _height(name: str) -> int:
    return 1 if name == HELD_LOAD else POINTS + 1


def _kept_coefficients(name: str, values: Tensor, held: bool) -> Tensor:
    """The coefficients, kept with the series: a fit hands the same one over a hundred times."""
    kept = getattr(values, _KEPT, None)
    if kept is None or values.requires_grad or kept[0] != held:
        kept = held, _coefficients(name, values, held)
        if not values.requires_grad:
            setattr(values, _KEPT, kept)
    return kept[1]


def _coefficients(name: str, values: Tensor, held: bool) -> Tensor:
    """Shape (height, intervals, batch), powers of u ascending."""
    if name == HELD_LOAD:
        return values.T.unsqueeze(0)
    if held:
        steps = values[:, :-1].T.unsqueeze(0)
        return torch.cat([steps, steps.new_zeros(POINTS, *steps.shape[1:])])
    if name != ANGLE:
        return _quartics(values)
    first, last, intervals = values[:, :1], values[:, -1:], values.shape[1] - 1
    slope = (last - first) / max(intervals, 1)
    line = first + slope * torch.arange(intervals + 1, dtype=values.dtype, device=values.device)
    beside = _quartics(values - line)
    return torch.cat([beside[:1] + line[:, :-1].T, beside[1:2] + slope.T, beside[2:]])


def _quartics(values: Tensor) -> Tensor:
    """The quartics through the band-limited interpolation of each interval, (POINTS + 1, intervals, batch)."""
    fine = _between_samples(values)
    windows = fine.unfold(-1, POINTS + 1, POINTS)  # (batch, intervals, points)
    return torch.einsum("kp,bip->kib", _TO_COEFFICIENTS.to(values), windows)


def _between_samples(values: Tensor) -> Tensor:
    """The series at POINTS positions per interval, (batch, POINTS * intervals + 1)."""
    margin = min(MARGIN, values.shape[-1] - 1)
    before = 2 * values[:, :1] - values[:, 1 : margin + 1].flip(-1)
    after = 2 * values[:, -1:] - values[:, -margin - 1 : -1].flip(-1)
    fine = upsample(torch.cat([before, values, after], dim=-1), POINTS)
    return fine[:, POINTS * margin : fine.shape[-1] - POINTS * margin]
