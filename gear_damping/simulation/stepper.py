"""Walks a batch over one output interval: sub-steps, and the split of those that leave their branch."""

from collections.abc import Callable

import torch
from torch import Tensor

from gear_damping.simulation.kernel import Batch, Kernel
from gear_damping.simulation.layout import INTERVAL_ROW
from gear_damping.simulation.series import SharedSeries

MOST_SPLITS = 8  # of one sub-step; a member that grazes a corner more often keeps its branch to the end
REPORT_EVERY = 16  # output intervals: progress is seen, and telling it costs nothing
VELOCITY = 1  # row of the velocity among the states


class Stepper:
    """The active-branch fixed-step method for one batch; remembers the branch each member is on.

    Where `acceleration`, (batch, time), is set before a walk, the walk fills it with the rate of the velocity at
    every output, the first included, in natural units.
    """

    gathered_multiple = 4  # gathered members come in multiples of this, whole vector registers
    acceleration: Tensor | None = None

    def __init__(self, kernel: Kernel, fixed: Tensor, series: SharedSeries) -> None:
        """Prepare a batch.

        Args:
            kernel: The model's steps.
            fixed: Packed parameters, (rows, batch).
            series: Packed inputs of the batch.
        """
        self.kernel, self.fixed, self.series = kernel, fixed, series
        self.active_branch = fixed.new_zeros(len(kernel.switch_names), fixed.shape[1])
        self._index = fixed.new_zeros(())

    def batch(self, index: int) -> Batch:
        """Everything about the batch during output interval `index`."""
        self._index.fill_(index)
        rows = self.series[min(index, len(self.series) - 1)]
        return Batch(self.fixed, rows, self._index)

    def start(self, state: Tensor) -> None:
        """Put each member on the branch of its initial state."""
        if self.kernel.switch_names:
            u = self.fixed.new_zeros(self.fixed.shape[1])
            self.active_branch = (self.kernel.switches(u, state, self.batch(0)) >= 0).to(state)
        if self.acceleration is not None:
            self.acceleration[:, 0] = self._accelerated(0.0, state, self.batch(0))

    def _accelerated(self, u: float, state: Tensor, batch: Batch) -> Tensor:
        """Rate of the velocity, (batch,), at position `u` of an interval on the branch that was reached."""
        place = self.fixed.new_full((state.shape[1],), u)
        return self.kernel.rates(place, state, batch, self.active_branch)[VELOCITY] / batch.fixed[INTERVAL_ROW]

    def rates(self, time: Tensor, state: Tensor) -> Tensor:
        """Rates at any position on the branch of that very instant, for torchdiffeq's other methods."""
        index = int(time)
        batch, u = self.batch(index), (time - index).expand(state.shape[1])
        active_branch = self.active_branch
        if self.kernel.switch_names:
            active_branch = (self.kernel.switches(u, state, batch) >= 0).to(state)
        return self.kernel.rates(u, state, batch, active_branch)

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
                self.acceleration[:, index + 1] = self._accelerated(1.0, state, self.batch(index))
            if index % REPORT_EVERY == 0:
                report(index + 1)

    def walk(self, state: Tensor, index: int, substeps: int) -> Tensor:
        """The state at the end of output interval `index`, (n_state, batch)."""
        batch = self.batch(index)
        length = self.fixed.new_full((state.shape[1],), 1 / substeps)
        for number in range(substeps):
            state = self._substep(state, number * length, length, batch)
        return state

    def _substep(self, state: Tensor, start: Tensor, length: Tensor, batch: Batch) -> Tensor:
        if not self.kernel.switch_names:
            return self.kernel.advance(state, start, length, batch, self.active_branch)[0]
        end, first, last, margin = self.kernel.advance(state, start, length, batch, self.active_branch)
        left = margin < 0
        if left.any():
            indices = _padded(left.nonzero().squeeze(1), self.gathered_multiple)
            ends = tuple(part[:, indices] for part in (state, end, first, last))
            few = Batch(batch.fixed[:, indices], batch.series[:, indices], batch.index)
            end, active_branch = end.clone(), self.active_branch.clone()  # a graph may hold the old ones
            end[:, indices], active_branch[:, indices] = self._split(
                ends, start[indices], length[indices], few, active_branch[:, indices]
            )
            self.active_branch = active_branch
        return end

    def _split(
        self, ends: tuple, start: Tensor, length: Tensor, batch: Batch, active_branch: Tensor
    ) -> tuple[Tensor, Tensor]:
        """State at the end and branch there, of members that left their branch inside the step."""
        stop, crossing = start + length, torch.ones_like(start, dtype=torch.bool)
        for _ in range(MOST_SPLITS):
            state, position, branch = self.kernel.cross(ends, start, length, batch, active_branch)
            state, start, active_branch = (
                torch.where(crossing, new, old)
                for new, old in ((state, ends[0]), (position, start), (branch, active_branch))
            )
            length = stop - start
            end, first, last, margin = self.kernel.advance(state, start, length, batch, active_branch)
            ends = (state, end, first, last)
            crossing = margin < 0
            if not crossing.any():
                break
        return ends[1], active_branch


def _padded(indices: Tensor, multiple: int) -> Tensor:
    """The indices, the last one repeated until their number is such a multiple."""
    missing = -len(indices) % multiple
    return torch.cat([indices, indices[-1:].expand(missing)]) if missing else indices
