"""Forward sensitivities: how a trajectory changes with its parameters, integrated beside it in one pass.

The rates of the sensitivities are the directional derivatives of the rates of the states, so that what
comes out is the derivative of the discrete solution itself. They are traced into the same native kernel,
where everything that states and sensitivities have in common is worked out once.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.func import jvp

from gear_damping.physics.model import Model
from gear_damping.simulation.compilation import choose
from gear_damping.simulation.integrate import groups_of, initial_states, input_units, kernel_of, solve
from gear_damping.simulation.kernel import Kernel, Members
from gear_damping.simulation.layout import Layout
from gear_damping.simulation.series import Series, SharedSeries
from gear_damping.simulation.simulate import true_inputs
from gear_damping.simulation.solver_settings import Solver

Natural = tuple[Tensor, Tensor, Tensor]  # packed parameters, initial states, packed inputs


@dataclass(frozen=True)
class Rows:
    """Numbers of the rows of packed parameters and of packed inputs that hang on a parameter."""

    fixed: tuple[int, ...]
    series: tuple[int, ...]


@dataclass(frozen=True)
class Sensitivities:
    """A trajectory with its derivatives.

    Args:
        response: The system's response in SI, (batch, time).
        by_parameter: Its derivative by each parameter, SI over SI, (batch, time).
    """

    response: Tensor
    by_parameter: dict[str, Tensor]


class SensitiveKernel(Kernel):
    """Steps of states and sensitivities together.

    Rows of states are those of the plain kernel, then for each parameter their derivatives by it; rows of
    parameters and inputs likewise, without those that do not hang on the parameter: where a derivative is
    zero by structure the native kernel has no operation for it.
    """

    def __init__(self, plain: Kernel, derivatives: Sequence[Rows], shapes: tuple[int, int]) -> None:
        """Extend the kernel of a model.

        Args:
            plain: The kernel of the states.
            derivatives: Of each parameter, the rows that hang on it.
            shapes: Rows of the plain packed parameters and inputs.
        """
        self.plain, self.derivatives, self.shapes = plain, tuple(derivatives), shapes
        self.equation, self.layout, self.series = plain.equation, plain.layout, plain.series
        self.switch_names, self.parts = plain.switch_names, plain.parts

    def rates(self, u: Tensor, state: Tensor, members: Members, locked: Tensor) -> Tensor:
        """Rates of the states, then of their derivatives by each parameter."""
        states = state.tensor_split(len(self.derivatives) + 1)
        fixed = _unpacked(members.fixed, self.shapes[0], [rows.fixed for rows in self.derivatives])
        series = _unpacked(members.series, self.shapes[1], [rows.series for rows in self.derivatives])

        def plain(y: Tensor, p: Tensor, s: Tensor) -> Tensor:
            return self.plain.rates(u, y, Members(p, s, members.index), locked)

        point = (states[0], fixed[0], series[0])
        found = [jvp(plain, point, (states[k], fixed[k], series[k])) for k in range(1, len(states))]
        return torch.cat([found[0][0], *(derivative for _, derivative in found)])

    def switches(self, u: Tensor, state: Tensor, members: Members) -> Tensor:
        """The switching functions hang on the states alone."""
        own = Members(members.fixed[: self.shapes[0]], members.series[: self.shapes[1]], members.index)
        return self.plain.switches(u, state.tensor_split(len(self.derivatives) + 1)[0], own)


def _unpacked(packed: Tensor, height: int, kept: Sequence[tuple[int, ...]]) -> list[Tensor]:
    """The plain rows, then the derivatives by each parameter with their zeros."""
    parts, row = [packed[:height]], height
    for rows in kept:
        listed = list(torch.zeros_like(packed[:height]).unbind(0))
        for place in rows:
            listed[place] = packed[row]
            row += 1
        parts.append(torch.stack(listed) if listed else packed[:0])
    return parts


def simulate_sensitivities(
    model: Model,
    values: Mapping[str, Tensor],
    *,
    sampling_rate: float,
    n_samples: int,
    inputs: Mapping[str, Tensor] | None = None,
    solver: Solver | None = None,
) -> Sensitivities:
    """The response of a batch and its derivatives by those scalar parameters whose values ask for gradients.

    Exact for the discrete solution where the forces are continuous across switches, as those of a flank
    that touches are; a shift of the instant at which a force jumps (edges of a rectangular mesh stiffness,
    steps of the torque, damping that sets in with contact) is not part of them.

    Args:
        model: Base system and effects, without drawn loads.
        values: Parameters in SI by flat name, (batch,) or (n, batch); at least one scalar one `requires_grad`, and no
            list does.
        sampling_rate: Output samples per second.
        n_samples: Output samples of each run.
        inputs: Measured series as for `simulate`.
        solver: Settings of the solver.

    Raises:
        ValueError: nothing asks for gradients, or a list or something unknown does.
    """
    declared, parameters = model.parameters(), [name for name, value in values.items() if value.requires_grad]
    wrong = [name for name in parameters if name not in declared or declared[name].vector]
    if wrong or not parameters:
        raise ValueError(f"scalar parameters of the model must ask for gradients, got {wrong or 'none'}")
    solver, inputs = solver or Solver(), dict(inputs or {})
    given = {name: value.detach().to(torch.float64) for name, value in values.items()}
    series = Series(tuple(sorted(inputs)))
    natural = _natural(model, given, inputs, sampling_rate, n_samples, series)
    parts = [jvp(lambda x, n=n: natural({n: x}), (given[n],), (torch.ones_like(given[n]),)) for n in parameters]
    plain, derivatives = parts[0][0], [derivative for _, derivative in parts]
    states = _integrated(model, given, series, plain, derivatives, solver)
    length, height = model.prepare(given).scales.length.unsqueeze(1), plain[1].shape[0]
    found = {name: length * states[(k + 1) * height] for k, name in enumerate(parameters)}
    return Sensitivities(length * states[0], found)


def _natural(
    model: Model,
    given: Mapping[str, Tensor],
    inputs: Mapping[str, Tensor],
    sampling_rate: float,
    n_samples: int,
    series: Series,
) -> Callable[[Mapping[str, Tensor]], Natural]:
    """Packed parameters, initial states and packed inputs, from changed values in unchanged units."""
    scales = model.prepare(given).scales
    interval = 1 / (sampling_rate * scales.time)

    def natural(changed: Mapping[str, Tensor]) -> Natural:
        prepared = model.prepare({**given, **changed}, scales)
        driving = true_inputs(model, {**given, **changed}, inputs, interval.shape[0])
        units = input_units(model, inputs, prepared)
        packed = series.shared(driving, units, n_samples - 1, interval.shape[0])
        return Layout(prepared).pack(prepared, interval), initial_states(model, prepared), packed.for_each()

    return natural


def _integrated(
    model: Model,
    given: Mapping[str, Tensor],
    series: Series,
    plain: Natural,
    derivatives: Sequence[Natural],
    solver: Solver,
) -> Tensor:
    """States and their derivatives in natural units, (rows, batch, time)."""
    prepared = model.prepare(given)
    rows = [Rows(_nonzero(fixed), _nonzero(packed.transpose(0, 1))) for fixed, _, packed in derivatives]
    both = list(zip(derivatives, rows, strict=True))
    fixed = torch.cat([plain[0], *(d[0][list(r.fixed)] for d, r in both)])
    start = torch.cat([plain[1], *(d[1] for d in derivatives)])
    packed = torch.cat([plain[2], *(d[2][:, list(r.series)] for d, r in both)], dim=1)
    first = Members(plain[0], plain[2][0], fixed.new_zeros(()))
    kernel = _sensitive(kernel_of(model, Layout(prepared), series, first, plain[1]), rows, first)
    choice = choose(solver.engine, kernel, Members(fixed, packed[0], fixed.new_zeros(())), start)
    intervals = packed.shape[0]
    states = start.new_empty(*start.shape, intervals + 1)
    for n, lanes in groups_of(prepared, fixed[0], intervals, solver):
        own = SharedSeries.written_out(packed[:, :, lanes])
        stepper = choice.stepper(kernel, fixed[:, lanes].contiguous(), own)
        states[:, lanes] = solve(stepper, start[:, lanes], intervals + 1, n, None)
    return states


def _nonzero(rows: Tensor) -> tuple[int, ...]:
    """The rows in which anything hangs on the parameter."""
    return tuple(torch.nonzero(rows.flatten(1).any(dim=1)).flatten().tolist())


_sensitive_kernels: dict[tuple, SensitiveKernel] = {}


def _sensitive(plain: Kernel, rows: Sequence[Rows], members: Members) -> SensitiveKernel:
    """One kernel for each model and structure of its derivatives, so that it is compiled once."""
    key = (id(plain), *rows)
    if key not in _sensitive_kernels:
        _sensitive_kernels[key] = SensitiveKernel(plain, rows, (members.fixed.shape[0], members.series.shape[0]))
    return _sensitive_kernels[key]
