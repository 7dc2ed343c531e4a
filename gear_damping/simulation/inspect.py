"""What happened inside one run: every instant is evaluated as a member of one batch."""

import torch
from torch import Tensor

from gear_damping.physics.equation import EquationOfMotion
from gear_damping.simulation.integrate import input_units
from gear_damping.simulation.runs import Runs, state_units
from gear_damping.simulation.series import Series
from gear_damping.units import parse_unit


def forces_of(runs: Runs, member: int) -> dict[str, Tensor]:
    """`stiffness` (N/m), `contact`, `mesh_force` (N) and `load` (N) of one run over time, each (time,).

    The load leaves out what was drawn for the run and held over samples.
    """
    one = {name: value[..., member : member + 1] for name, value in runs.values.items()}
    count = len(runs.time)
    every = {name: value.expand(*value.shape[:-1], count) for name, value in one.items()}
    prepared = runs.model.prepare(every)
    scales = prepared.scales
    equation = EquationOfMotion(runs.model)
    units = state_units(runs.model)
    state = [runs.states[n][member] / scales.unit_of(parse_unit(units[n]).dimension) for n in units]
    given = _inputs(runs, member)
    at = equation.kinematics(runs.time / scales.time, tuple(state), given, prepared.base)
    at.active_branch = {name: (value >= 0).to(value) for name, value in equation.switches(at, prepared.terms).items()}
    equation.rates(at, prepared.base, prepared.terms)
    contact = at.contact if isinstance(at.contact, Tensor) else torch.ones(count)
    return {
        "stiffness": at.stiffness * scales.force / scales.length,
        "contact": contact,
        "mesh_force": at.mesh_force * scales.force,
        "load": at.load * scales.force,
    }


def _inputs(runs: Runs, member: int) -> dict[str, Tensor]:
    """Every input of one run at the outputs as the solver sees it, natural units, each (time,)."""
    if not runs.inputs:
        return {}
    prepared = runs.model.prepare({name: value[..., member : member + 1] for name, value in runs.values.items()})
    inputs = {name: value[member : member + 1] for name, value in runs.inputs.items()}
    series, intervals = Series(tuple(sorted(inputs))), len(runs.time) - 1
    packed = series.shared(inputs, input_units(runs.model, inputs, prepared), intervals, 1).for_each()
    rows = torch.cat([packed, packed[-1:]])[..., 0].T  # the last output is the end of the last interval
    u = torch.zeros(intervals + 1, dtype=rows.dtype)
    u[-1] = 1
    return series.at(rows, u, 1 / (runs.sampling_rate * prepared.scales.time))
