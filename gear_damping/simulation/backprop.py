"""Backpropagation through a simulation, for what has too many parameters for forward sensitivities.

That is a network inside the equation of motion: a few hundred weights that all members share. Physical
parameters are differentiated faster by `sensitivities`. The graph is kept for one block of output intervals
at a time; those before it are walked again when the gradient comes back (checkpointing).
"""

from collections.abc import Mapping

import torch
from torch import Tensor
from torch.utils.checkpoint import checkpoint

from gear_damping.physics.model import Model
from gear_damping.simulation.integrate import groups_of, initial_states, input_units
from gear_damping.simulation.kernel import Batch, Kernel
from gear_damping.simulation.layout import Layout
from gear_damping.simulation.series import Series, SharedSeries
from gear_damping.simulation.simulate import true_inputs
from gear_damping.simulation.solver_settings import Solver
from gear_damping.simulation.stepper import Stepper


def simulate_with_gradient(
    model: Model,
    values: Mapping[str, Tensor],
    *,
    sampling_rate: float,
    n_samples: int,
    inputs: Mapping[str, Tensor] | None = None,
    solver: Solver | None = None,
) -> Tensor:
    """The system's response in SI, (batch, time), as part of the graph of all that it follows from.

    Gradients reach the tensors of `values` that ask for them and the parameters of every network that an
    effect of the model holds. They are those of the discrete solution, with the instants at which flanks
    meet and part.

    Args:
        model: Base system and effects, without drawn loads.
        values: Parameters in SI by flat name, (batch,) or (n, batch).
        sampling_rate: Output samples per second.
        n_samples: Output samples of each run.
        inputs: Measured series as for `simulate`.
        solver: Settings; the engine is always plain PyTorch. Memory grows with block + n_samples / block, so that it
            is least near the square root of n_samples; time is that of one walk more.
    """
    solver, inputs = solver or Solver(), dict(inputs or {})
    prepared = model.prepare(values)
    interval = 1 / (sampling_rate * prepared.scales.time)
    layout, series = Layout(prepared), Series(tuple(sorted(inputs)))
    fixed, start = layout.pack(prepared, interval), initial_states(model, prepared)
    driving = true_inputs(model, values, inputs, interval.shape[0])
    packed = series.shared(driving, input_units(model, inputs, prepared), n_samples - 1, interval.shape[0]).for_each()
    with torch.no_grad():
        groups = groups_of(prepared, interval, n_samples - 1, solver)
        kernel = _GraphKernel(model, layout, series, Batch(fixed, packed[0], fixed.new_zeros(())), start)
    found = [_displacement(kernel, fixed[:, k], packed[:, :, k], start[:, k], n, solver.block) for n, k in groups]
    order = torch.cat([indices for _, indices in groups]).argsort()
    return torch.cat(found)[order] * prepared.scales.length.unsqueeze(1)


class _GraphKernel(Kernel):
    """The kernel with the search for a crossing outside the graph.

    The Newton step behind the search alone carries the derivative of the crossing; the search itself, run
    down to rounding, would only multiply its noise.
    """

    def _root(self, ends: tuple, start: Tensor, length: Tensor, batch: Batch, active_branch: Tensor) -> Tensor:
        with torch.no_grad():
            return super()._root(ends, start, length, batch, active_branch)


class _GraphStepper(Stepper):
    """A stepper whose members of one interval are never overwritten by those of the next."""

    gathered_multiple = 1  # a member that stood twice would count twice in the gradient

    def batch(self, index: int) -> Batch:
        return Batch(self.fixed, self.series[index], self.fixed.new_full((), index))


def _displacement(kernel: Kernel, fixed: Tensor, series: Tensor, state: Tensor, substeps: int, block: int) -> Tensor:
    """The first state in natural units, (batch, time)."""
    stepper = _GraphStepper(kernel, fixed, SharedSeries.written_out(series))
    intervals = len(series)
    with torch.no_grad():
        stepper.start(state)

    def walked(state: Tensor, active_branch: Tensor, first: int, last: int) -> tuple[Tensor, Tensor, Tensor]:
        stepper.active_branch, rows = active_branch, []
        for index in range(first, last):
            state = stepper.walk(state, index, substeps)
            rows.append(state[0])
        return state, stepper.active_branch, torch.stack(rows)

    found, active_branch = [state[:1]], stepper.active_branch
    for first in range(0, intervals, block):
        last = min(first + block, intervals)
        state, active_branch, rows = checkpoint(walked, state, active_branch, first, last, use_reentrant=False)
        found.append(rows)
    return torch.cat(found).T
