"""Walks a batch over one output interval: sub-steps, and the split of those that leave their branch."""

from collections.abc import Callable

import torch
from torch import Tensor

from gear_damping.simulation.kernel import Kernel, Members
from gear_damping.simulation.layout import INTERVAL_ROW
from gear_damping.simulation.series import SharedSeries

MOST_SPLITS = 8  # of one sub-step; a lane that grazes a corner more often keeps its branch to the end
REPORT_EVERY = 16  # output intervals: progress is seen, and telling it costs nothing
VELOCITY = 1  # row of the velocity among the states


class Stepper:
    """The region-locked fixed-step method for one batch; remembers the branch each member is on.

    Where `acceleration`, (batch, time), is set before a walk, the walk fills it with the rate of the velocity at
    every output, the first included, in natural units.
    """

    lane_multiple = 4  # gathered lanes come in multiples of this, whole vector registers
    acceleration: Tensor | None = None

    def __init__(self, kernel: Kernel, fixed: Tensor, series: SharedSeries, compiled: bool) -> None:
        """Prepare a batch.

        Args:
            kernel: The model's steps.
            fixed: Packed parameters, (rows, batch).
            series: Packed inputs of the batch.
            compiled: Whether each sub-step runs as one fused kernel.
        """
        self.kernel, self.fixed, self.series = kernel, fixed, series
        self.advance: Callable = kernel.fused_advance if compiled else kernel.advance
        self.cross: Callable = kernel.fused_cross if compiled else kernel.cross
        self.locked = fixed.new_zeros(len(kernel.switch_names), fixed.shape[1])
        self._rates: Callable = kernel.fused_rates if compiled else kernel.rates
        self._index = fixed.new_zeros(())

    def members(self, index: int) -> Members:
        """Everything about the batch during output interval `index`."""
        self._index.fill_(index)
        rows = self.series[min(index, len(self.series) - 1)]
        return Members(self.fixed, rows, self._index)

    def start(self, state: Tensor) -> None:
        """Put each member on the branch of its initial state."""
        if self.kernel.switch_names:
            u = self.fixed.new_zeros(self.fixed.shape[1])
            self.locked = (self.kernel.switches(u, state, self.members(0)) >= 0).to(state)
        if self.acceleration is not None:
            self.acceleration[:, 0] = self._accelerated(0.0, state, self.members(0))

    def _accelerated(self, u: float, state: Tensor, members: Members) -> Tensor:
        """Rate of the velocity, (batch,), at position `u` of an interval on the branch that was reached."""
        place = self.fixed.new_full((state.shape[1],), u)
        return self._rates(place, state, members, self.locked)[VELOCITY] / members.fixed[INTERVAL_ROW]

    def rates(self, time: Tensor, state: Tensor) -> Tensor:
        """Rates at any position on the branch of that very instant, for torchdiffeq's other methods."""
        index = int(time)
        members, u = self.members(index), (time - index).expand(state.shape[1])
        locked = self.locked
        if self.kernel.switch_names:
            locked = (self.kernel.switches(u, state, members) >= 0).to(state)
        return self.kernel.rates(u, state, members, locked)

    def run(self, state: Tensor, out: Tensor, substeps: int, report: Callable[[int], None]) -> None:
        """Fill `out` (intervals, n_state, batch) with the state after each interval.

        Args:
            state: State at the start, (n_state, batch).
            out: Where the states go.
            substeps: Sub-steps of each interval.
            report: Told how many intervals are done.
        """
        for index in range(out.shape[0]):
            state = self.walk(state, index, substeps)
            out[index] = state
            if self.acceleration is not None:
                self.acceleration[:, index + 1] = self._accelerated(1.0, state, self.members(index))
            if index % REPORT_EVERY == 0:
                report(index + 1)

    def walk(self, state: Tensor, index: int, substeps: int) -> Tensor:
        """The state at the end of output interval `index`, (n_state, batch)."""
        members = self.members(index)
        length = self.fixed.new_full((state.shape[1],), 1 / substeps)
        for number in range(substeps):
            state = self._substep(state, number * length, length, members)
        return state

    def _substep(self, state: Tensor, start: Tensor, length: Tensor, members: Members) -> Tensor:
        if not self.kernel.switch_names:
            return self.advance(state, start, length, members, self.locked)[0]
        end, first, last, margin = self.advance(state, start, length, members, self.locked)
        left = margin < 0
        if left.any():
            lanes = _padded(left.nonzero().squeeze(1), self.lane_multiple)
            ends = tuple(part[:, lanes] for part in (state, end, first, last))
            few = Members(members.fixed[:, lanes], members.series[:, lanes], members.index)
            end, locked = end.clone(), self.locked.clone()  # a graph may hold the old ones
            end[:, lanes], locked[:, lanes] = self._split(ends, start[lanes], length[lanes], few, locked[:, lanes])
            self.locked = locked
        return end

    def _split(
        self, ends: tuple, start: Tensor, length: Tensor, members: Members, locked: Tensor
    ) -> tuple[Tensor, Tensor]:
        """State at the end and branch there, of members that left their branch inside the step."""
        stop, crossing = start + length, torch.ones_like(start, dtype=torch.bool)
        for _ in range(MOST_SPLITS):
            state, position, branch = self.cross(ends, start, length, members, locked)
            state, start, locked = (
                torch.where(crossing, new, old) for new, old in ((state, ends[0]), (position, start), (branch, locked))
            )
            length = stop - start
            end, first, last, margin = self.advance(state, start, length, members, locked)
            ends = (state, end, first, last)
            crossing = margin < 0
            if not crossing.any():
                break
        return ends[1], locked


def _padded(lanes: Tensor, multiple: int) -> Tensor:
    """The lanes, the last one repeated until their number is such a multiple."""
    missing = -len(lanes) % multiple
    return torch.cat([lanes, lanes[-1:].expand(missing)]) if missing else lanes
