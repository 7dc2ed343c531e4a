"""Compiles the kernels of several models at once, before any of them is simulated."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from os import cpu_count

import torch
from torch import Tensor

from gear_damping.physics.equation import HELD_LOAD
from gear_damping.physics.model import Model
from gear_damping.physics.terms import HeldLoad
from gear_damping.simulation.compilation import choose
from gear_damping.simulation.integrate import initial_states, kernel_of
from gear_damping.simulation.kernel import Batch, Kernel
from gear_damping.simulation.layout import Layout
from gear_damping.simulation.series import Series
from gear_damping.simulation.solver_settings import Solver


@dataclass(frozen=True)
class Planned:
    """A simulation that will be asked for.

    Args:
        model: Base system and effects.
        values: Parameters in SI by flat name, (batch,) or (n, batch), as for `simulate`; of any batch.
        inputs: Names of the measured series that will drive it.
    """

    model: Model
    values: dict[str, Tensor]
    inputs: tuple[str, ...] = ()


def prepare_kernels(planned: Sequence[Planned], solver: Solver | None = None) -> None:
    """Compile what these simulations need and does not exist yet, on every core; then `simulate` finds it.

    A model whose kernel cannot be built is left to `simulate`, which says so.
    """
    if (solver or Solver()).engine not in ("auto", "native"):
        return
    wanted = {id(kernel): (kernel, batch, state) for kernel, batch, state in map(_kernel, planned)}
    with ThreadPoolExecutor(cpu_count() or 1) as pool:
        list(pool.map(lambda one: choose("auto", *one), wanted.values()))


def _kernel(planned: Planned) -> tuple[Kernel, Batch, Tensor]:
    """The kernel of a model, with members and states of the right shapes."""
    model, prepared = planned.model, planned.model.prepare(planned.values)
    names = {*planned.inputs, *(HELD_LOAD for effect in model.effects if isinstance(effect, HeldLoad))}
    layout, series = Layout(prepared), Series(tuple(sorted(names)))
    fixed, state = layout.pack(prepared, prepared.scales.time), initial_states(model, prepared)
    batch = Batch(fixed, fixed.new_zeros(sum(series.heights), fixed.shape[1]), fixed.new_zeros(()))
    with torch.no_grad():
        return kernel_of(model, layout, series, batch, state), batch, state
