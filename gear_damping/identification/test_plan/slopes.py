"""How the records of tests change with what is unknown, by central differences through the simulation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from gear_damping.identification.test_plan.channels import needs_acceleration, seen
from gear_damping.identification.test_plan.rig import Rig
from gear_damping.identification.test_plan.starts import INITIAL, InitialState
from gear_damping.simulation.accuracy import substeps_for
from gear_damping.simulation.driven import Driven
from gear_damping.simulation.runs import FINE
from gear_damping.simulation.simulate import natural_units, simulate
from gear_damping.simulation.solver_settings import Solver

STEP = 1e-6  # of each unknown's scale, on either side: between what rounding and what curvature leave, 1e-8 of a slope
BENT = 0.1  # second difference over the first; of a smooth motion it is about the step itself
LEAST_CHANGE = 1e-9  # of a record, over two steps; of smaller ones rounding would make the second difference


@dataclass(frozen=True)
class Recorder:
    """How tests are recorded.

    Args:
        rig: The rig.
        rate: Samples per second.
        samples: Of a record.
        channels: What the sensors see.
    """

    rig: Rig
    rate: float
    samples: int
    channels: tuple[str, ...]

    def solver(self, values: Mapping[str, Tensor]) -> Solver:
        """The rig's solver with one number of sub-steps for all: at another number a slope would see its error."""
        own, prepared = self.rig.solver, self.rig.model.prepare(values)
        steps = own.substeps
        if steps is None:
            interval = 1 / (self.rate * prepared.scales.time)
            steps = int(substeps_for(own.accuracy, prepared, interval, self.samples - 1).max())
            steps = min(steps, own.most_substeps)
        return replace(own, substeps=steps, acceleration=needs_acceleration(self.channels), progress=None)

    def records(
        self, values: Mapping[str, Tensor], initial_perturbations: Mapping[str, Tensor], solver: Solver
    ) -> Tensor:
        """What the sensors see without noise, (channels, batch, time); nan where a run diverged."""
        how = {"sampling_rate": self.rate, "n_samples": self.samples, "solver": solver}
        runs = simulate(self.rig.model, values, inputs=Driven(initial_perturbations=initial_perturbations), **how)
        found = seen(runs, self.channels)
        return torch.where((runs.status == FINE)[None, :, None], found, torch.nan)


def scales_of(recorder: Recorder, start: InitialState, names: Sequence[str]) -> dict[str, Tensor]:
    """What counts as a step of order one, (batch,): a value, a natural unit of a state, 1 for what is 0."""
    prepared = recorder.rig.model.prepare(start.values)
    units = natural_units(recorder.rig.model, prepared)
    found = {}
    for name in names:
        if name in INITIAL or name in start.initial_perturbations:
            found[name] = units[INITIAL.get(name, name)]
        else:
            value = start.values[name]
            found[name] = torch.where(value != 0, value.abs(), 1.0)
    return found


@dataclass(frozen=True)
class Slopes:
    """Records with their slopes.

    Args:
        records: (channels, batch, time).
        by: Slopes by each unknown over its scale, (channels, batch, unknowns, time).
        straight: Members whose records follow every step in a straight line, (batch,). Others graze a contact or are
            so irregular that no slope describes them.
    """

    records: Tensor
    by: Tensor
    straight: Tensor


def slopes(recorder: Recorder, start: InitialState, scales: Mapping[str, Tensor], solver: Solver) -> Slopes:
    """Simulate members and how their records change.

    Args:
        recorder: How the tests are recorded.
        start: The members.
        scales: Of each unknown; a slope is one by an unknown over its scale.
        solver: As `Recorder.solver` gives it.
    """
    batch, count = start.fine.shape[0], 2 * len(scales) + 1
    values = {name: value.repeat(*[1] * (value.ndim - 1), count) for name, value in start.values.items()}
    initial_perturbations = {name: value.repeat(count) for name, value in start.initial_perturbations.items()}
    for place, (name, scale) in enumerate(scales.items()):
        for side, sign in ((0, 1), (1, -1)):
            part = slice((1 + 2 * place + side) * batch, (2 + 2 * place + side) * batch)
            (initial_perturbations if name in initial_perturbations else values)[name][..., part] += sign * STEP * scale
    found = recorder.records(values, initial_perturbations, solver).unflatten(1, (count, batch))
    above, below, middle = found[:, 1::2], found[:, 2::2], found[:, :1]
    change, bend = (above - below).norm(dim=-1), (above + below - 2 * middle).norm(dim=-1)
    straight = (bend <= BENT * torch.maximum(change, LEAST_CHANGE * middle.norm(dim=-1))).all(1).all(0)
    return Slopes(found[:, 0], ((above - below) / (2 * STEP)).transpose(1, 2), straight)
