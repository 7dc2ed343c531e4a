"""From prepared members to trajectories: packing, kernels, groups of equal sub-steps, `odeint`."""

from collections.abc import Mapping

import torch
from torch import Tensor
from torchdiffeq import odeint

from gear_damping.physics.model import Model, Prepared
from gear_damping.simulation import torchdiffeq_method
from gear_damping.simulation.accuracy import substeps_for
from gear_damping.simulation.compilation import choose
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.kernel import Batch, Kernel, holds_weights
from gear_damping.simulation.layout import Layout
from gear_damping.simulation.prior import extra_states
from gear_damping.simulation.series import Series
from gear_damping.simulation.solver_settings import Progress, Solver
from gear_damping.simulation.stepper import Stepper
from gear_damping.units import parse_unit


def integrate(
    model: Model,
    prepared: Prepared,
    driven: Driven,
    interval: Tensor,
    n_samples: int,
    solver: Solver,
) -> tuple[list[str], Tensor, Tensor | None]:
    """Names of the states, their values (n_state, batch, time), and the acceleration (batch, time) where it is asked.

    In natural units, as the sampling interval, (batch,), perturbations and a held load are. Members that need the same
    number of sub-steps go together, so that no member's answer depends on its batch-mates. What lies on a GPU is
    stepped on the CPU and comes back there: see `place_of`.
    """
    layout, series = Layout(prepared), Series(tuple(sorted(driven.series)))
    home = interval.device
    place = place_of(model, home)
    fixed = layout.pack(prepared, interval).to(place)
    start = initial_states(model, prepared, driven.initial_perturbations).to(place)
    units = {name: unit.cpu() for name, unit in input_units(model, driven.series, prepared).items()}
    given = {name: values.cpu() for name, values in driven.series.items()}
    packed = series.shared(given, units, n_samples - 1, interval.shape[0], driven.held).to(place)
    example = Batch(fixed, packed[0], fixed.new_zeros(()))
    kernel = kernel_of(model, layout, series, example, start)
    choice = choose(solver.engine, kernel, example, start)
    groups = [(n, indices.to(place)) for n, indices in groups_of(prepared, interval, n_samples - 1, solver)]
    states = start.new_empty(*start.shape, n_samples)
    accelerations = start.new_empty(start.shape[1], n_samples) if solver.acceleration else None
    names = ["displacement", "velocity", *kernel.equation.extra_names]
    work, done = sum(n * len(indices) for n, indices in groups), 0
    for n, indices in groups:
        whole = len(groups) == 1
        some = (fixed, packed) if whole else (fixed[:, indices].contiguous(), packed.of(indices))
        stepper = choice.stepper(kernel, *some)
        stepper.acceleration = start.new_empty(len(indices), n_samples) if solver.acceleration else None
        share = _share(solver.progress, done, n * len(indices), work)
        found = solve(stepper, start if whole else start[:, indices], n_samples, n, share)
        if whole:
            return names, found.to(home), _at(home, stepper.acceleration)
        states[:, indices] = found
        if solver.acceleration:
            accelerations[indices] = stepper.acceleration
        done += n * len(indices)
    return names, states.to(home), _at(home, accelerations)


def place_of(model: Model, home: torch.device) -> torch.device:
    """Where members are stepped whose values lie on `home`: the CPU, but for a network inside the model.

    A trajectory is thousands of short steps in turn, for which one core with the native kernel takes half the time of a
    GPU and less (docs/speed.md). An effect that holds a network has its weights where the values are.
    """
    return home if any(holds_weights(part) for part in (model.system, *model.effects)) else torch.device("cpu")


def _at(home: torch.device, acceleration: Tensor | None) -> Tensor | None:
    return None if acceleration is None else acceleration.to(home)


def solve(stepper: Stepper, start: Tensor, n_samples: int, substeps: int, progress: Progress | None) -> Tensor:
    """Walk a batch from its initial states, (n_state, batch), through `odeint`; (n_state, batch, time)."""
    times = torch.arange(n_samples, dtype=start.dtype, device=start.device)
    options = {"stepper": stepper, "substeps": substeps, "progress": progress}
    torchdiffeq_method.register()
    with torch.no_grad():
        found = odeint(stepper.rates, start, times, method=torchdiffeq_method.METHOD, options=options)
    return found.permute(1, 2, 0)


def input_units(model: Model, inputs: Mapping[str, Tensor], prepared: Prepared) -> dict[str, Tensor]:
    """Natural unit of every input series of the system, (batch,)."""
    known = {name: unit for name, unit in model.system.inputs.items() if name in inputs}
    return {name: prepared.scales.unit_of(parse_unit(unit).dimension) for name, unit in known.items()}


def groups_of(prepared: Prepared, interval: Tensor, intervals: int, solver: Solver) -> list[tuple[int, Tensor]]:
    """Sub-steps and the members that take them, in chunks that bound the memory."""
    if solver.substeps is None:
        substeps = substeps_for(solver.accuracy, prepared, interval, intervals).clamp(max=solver.most_substeps)
    else:
        substeps = torch.full(interval.shape, solver.substeps, device=interval.device)
    members = [(int(n), (substeps == n).nonzero().squeeze(1)) for n in substeps.unique()]
    return [(n, indices) for n, together in members for indices in together.split(solver.chunk)]


def initial_states(
    model: Model, prepared: Prepared, initial_perturbations: Mapping[str, Tensor] | None = None
) -> Tensor:
    """States at the start, (n_state, batch), and how far those of effects depart from theirs, all in natural units."""
    own = [prepared.base["initial_displacement"], prepared.base["initial_velocity"]]
    extra = extra_states(model, prepared)
    for name, perturbation in (initial_perturbations or {}).items():
        extra[name] = extra[name] + perturbation
    return torch.stack([*own, *extra.values()])


def _share(progress: Progress | None, done: int, own: int, work: int) -> Progress | None:
    """Progress of one group as a part of the whole, in thousandths."""
    if progress is None:
        return None
    return lambda now, total: progress(round(1000 * (done + own * now / total) / work), 1000)


_kernels: dict[tuple, Kernel] = {}


def kernel_of(model: Model, layout: Layout, series: Series, members: Batch, start: Tensor) -> Kernel:
    """The kernel of a model; models of one structure share it, and what was compiled for it."""
    parts = (model.system, *model.effects)
    key = tuple((type(part), tuple(sorted(part.chosen.items())), id(part) * holds_weights(part)) for part in parts)
    key += (tuple(layout.entries), series.names)
    if key not in _kernels:
        _kernels[key] = Kernel(model, layout, series, members, start)
    return _kernels[key]
