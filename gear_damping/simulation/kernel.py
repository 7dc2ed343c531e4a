"""The two functions that all time is spent in, written so that each can be traced into one native kernel.

Both are pure: everything about the members comes in as packed tensors (see `Layout`, `Series`).
Position is counted in output intervals, index + u with u in 0…1.
"""

from dataclasses import dataclass

import torch
from torch import Tensor

from gear_damping.physics.equation import EquationOfMotion
from gear_damping.physics.kinematics import Kinematics
from gear_damping.physics.model import Model
from gear_damping.simulation import tsit5
from gear_damping.simulation.layout import Layout
from gear_damping.simulation.series import Series

WATCHED = (1 / 3, 2 / 3)  # positions inside a step at which a branch that was left is noticed
SAME_INSTANT = 1e-5  # of the change over REACH: crossings nearer than that are one
REACH = 1e-4  # of a step, over which a switch is seen to change: long beside rounding, short beside a curve
MOST_SHIFT = 1e-2  # of a step, that the last Newton step may move a crossing: the search has come nearer than that
ROOT_STEPS = 6  # of the bracketed search on the interpolant; one Newton step on the true state follows


@dataclass(frozen=True)
class Batch:
    """What the kernel knows about a batch during one output interval.

    Args:
        fixed: Packed parameters, (rows, batch).
        series: Packed inputs of this interval, (rows, batch).
        index: Number of the output interval, a 0-dimensional tensor.
    """

    fixed: Tensor
    series: Tensor
    index: Tensor


class Kernel:
    """Steps of one model; holds no member's data, so that it is compiled once for any batch."""

    def __init__(self, model: Model, layout: Layout, series: Series, batch: Batch, state: Tensor) -> None:
        """Learn the names of the switches from some members and their state."""
        self.parts = (model.system, *model.effects)
        self.equation = EquationOfMotion(model)
        self.layout = layout
        self.series = series
        at, _, _, terms = self.kinematics(torch.zeros_like(state[0]), state, batch)
        self.switch_names = tuple(self.equation.switches(at, terms))

    def kinematics(self, u: Tensor, state: Tensor, batch: Batch) -> tuple[Kinematics, Tensor, dict, dict]:
        """The kinematics at position u of the interval, with interval, base and term values."""
        interval, base, terms = self.layout.unpack(batch.fixed)
        time = (batch.index + u) * interval
        inputs = self.series.at(batch.series, u, interval)
        return self.equation.kinematics(time, state.unbind(0), inputs, base), interval, base, terms

    def rates(self, u: Tensor, state: Tensor, batch: Batch, active_branch: Tensor) -> Tensor:
        """Rates of the states per output interval, (n_state, batch), on the active branch."""
        at, interval, base, terms = self.kinematics(u, state, batch)
        at.active_branch = dict(zip(self.switch_names, active_branch.unbind(0), strict=True))
        return torch.stack(self.equation.rates(at, base, terms)) * interval

    def switches(self, u: Tensor, state: Tensor, batch: Batch) -> Tensor:
        """Every switching function, (n_switch, batch)."""
        at, _, _, terms = self.kinematics(u, state, batch)
        return torch.stack(list(self.equation.switches(at, terms).values()))

    def advance(self, state: Tensor, start: Tensor, length: Tensor, batch: Batch, active_branch: Tensor) -> tuple:
        """One step on the active branch.

        Returns:
            State at the end, rates at the start and at the end, and the smallest margin to the edge
            of the branch that was met at the watched positions: negative where the branch was left.
            For a model without switches only the state.
        """

        def rates(u: Tensor, inner: Tensor) -> Tensor:
            return self.rates(u, inner, batch, active_branch)

        end, first = tsit5.step(rates, state, start, length)
        if not self.switch_names:
            return (end,)
        last = rates(start + length, end)
        margin = self._margin(start + length, end, batch, active_branch)
        for part in WATCHED:
            inner = _interpolate(part, length, state, end, first, last)
            margin = torch.minimum(margin, self._margin(start + part * length, inner, batch, active_branch))
        return end, first, last, margin

    def cross(self, ends: tuple, start: Tensor, length: Tensor, batch: Batch, active_branch: Tensor) -> tuple:
        """The first crossing inside a step that left its branch.

        Args:
            ends: State at start and end of that step, rates at start and end.
            start: Position of its start.
            length: Its length.
            batch: The members that crossed.
            active_branch: The branch they were on.

        Returns:
            State and position of the crossing, and the branch behind it.
        """
        part = self._root(ends, start, length, batch, active_branch)

        def rates(u: Tensor, inner: Tensor) -> Tensor:
            return self.rates(u, inner, batch, active_branch)

        state, _ = tsit5.step(rates, ends[0], start, part * length)
        position = start + part * length
        slope = rates(position, state)
        reach = REACH * length
        here = self._signed(position, state, batch, active_branch)
        there = self._signed(position + reach, state + reach * slope, batch, active_branch)
        smallest = here.argmin(0, keepdim=True)
        changes = there - here
        value, change = here.gather(0, smallest)[0], changes.gather(0, smallest)[0]
        shift = torch.where(change.abs() > 0, -value / torch.where(change == 0, 1.0, change) * reach, 0.0)
        shift = torch.minimum(torch.maximum(shift, -MOST_SHIFT * part * length), MOST_SHIFT * (1 - part) * length)
        # Several switches may turn at one instant; one that comes back from rounding does not turn.
        turning = (changes < 0) & ((here <= value) | (here < SAME_INSTANT * changes.abs()))
        return state + shift * slope, position + shift, (active_branch - turning.to(active_branch)).abs()

    def _root(self, ends: tuple, start: Tensor, length: Tensor, batch: Batch, active_branch: Tensor) -> Tensor:
        """Share of the step at which the margin on the interpolant first falls to zero (Illinois)."""

        def margin(part: Tensor) -> Tensor:
            inner = _interpolate(part, length, *ends)
            return self._margin(start + part * length, inner, batch, active_branch)

        low, high = torch.zeros_like(start), torch.ones_like(start)
        at_low, at_high = margin(low).clamp(min=0), margin(high)
        for part in reversed(WATCHED):
            inside = torch.full_like(start, part)
            value = margin(inside)
            left = value < 0
            high, at_high = torch.where(left, inside, high), torch.where(left, value, at_high)
        for part in WATCHED:
            inside = torch.full_like(start, part)
            kept = inside < high
            low = torch.where(kept, inside, low)
            at_low = torch.where(kept, margin(inside).clamp(min=0), at_low)
        for _ in range(ROOT_STEPS):
            middle = _secant(low, high, at_low, at_high)
            value = margin(middle)
            left = value < 0
            at_low, at_high = torch.where(left, at_low / 2, value), torch.where(left, value, at_high / 2)
            low, high = torch.where(left, low, middle), torch.where(left, middle, high)
        return _secant(low, high, at_low, at_high)

    def _signed(self, u: Tensor, state: Tensor, batch: Batch, active_branch: Tensor) -> Tensor:
        return self.switches(u, state, batch) * (2 * active_branch - 1)

    def _margin(self, u: Tensor, state: Tensor, batch: Batch, active_branch: Tensor) -> Tensor:
        return self._signed(u, state, batch, active_branch).amin(0)


def holds_weights(part: object) -> bool:
    """Whether a part keeps tensors or networks of its own; they may change, so no compiled kernel may hold them."""
    kept = {**vars(type(part)), **vars(part)}
    return any(isinstance(value, Tensor | torch.nn.Module) for value in kept.values())


def _secant(low: Tensor, high: Tensor, at_low: Tensor, at_high: Tensor) -> Tensor:
    """Where the line through a value >= 0 and a value <= 0 meets zero."""
    width = at_low - at_high
    return low + (high - low) * at_low / torch.where(width > 0, width, 1.0)


def _interpolate(
    part: Tensor | float, length: Tensor, start: Tensor, end: Tensor, first: Tensor, last: Tensor
) -> Tensor:
    """Cubic Hermite interpolation at a share of the step."""
    s, r = part, 1 - part
    ends = (1 + 2 * s) * r * r * start + s * s * (3 - 2 * s) * end
    return ends + length * (s * r * r * first - s * s * r * last)
