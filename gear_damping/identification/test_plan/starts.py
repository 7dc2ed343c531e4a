"""Where a record begins: the motion of a rig that has run for a while."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import ceil, pi

import torch
from torch import Tensor

from gear_damping.identification.test_plan.rig import Rig
from gear_damping.physics.systems.traits import Trait
from gear_damping.simulation.prior import extra_states
from gear_damping.simulation.runs import FINE, effect_state_units
from gear_damping.simulation.simulate import natural_units, simulate

FADED = 12.0  # time constants at the stated damping ratio: linear transients have fallen to 6e-6
LONGEST = 10.0  # s; a rig with next to no damping would settle for ever
LEAST_PERIODS = 20.0  # natural ones, for a rig with much damping
AT_ONCE = 10**7  # samples of one state simulated together: 80 MB
STEADY = {"pinion_acceleration": 0.0, "pinion_jerk": 0.0}  # of a shaft that has reached its speed
INITIAL = {"initial_displacement": "displacement", "initial_velocity": "velocity"}  # parameter -> state


@dataclass(frozen=True)
class InitialState:
    """Members at the beginning of their records.

    Args:
        values: Parameters with the initial displacement and velocity, (batch,) or (n, batch).
        initial_perturbations: Of states of effects, from where their effect puts them, (batch,) in SI.
        fine: Which members did not diverge before, (batch,).
    """

    values: dict[str, Tensor]
    initial_perturbations: dict[str, Tensor]
    fine: Tensor


def settling_time(rig: Rig, wanted: float | None) -> float:
    """Seconds before a record begins."""
    if wanted is not None:
        return wanted
    if not rig.model.system.has(Trait.PRELOAD):
        return 0.0
    frequency = float(rig.model.prepare(rig.values).derived["natural_frequency"])
    ratio = float(rig.ratio_percent(rig.values)) / 100
    faded = FADED / (ratio * frequency) if ratio > 0 else LONGEST
    return min(max(faded, LEAST_PERIODS * 2 * pi / frequency), LONGEST)


def initial_state(rig: Rig, values: Mapping[str, Tensor], seconds: float, rate: float) -> InitialState:
    """Members after they have run for so many seconds, from their static deflection where no start was given."""
    batch = values["initial_displacement"].shape[0]
    zero = {name: torch.zeros(batch, dtype=torch.float64) for name in effect_state_units(rig.model)}
    if seconds <= 0:
        return InitialState(dict(values), zero, torch.ones(batch, dtype=torch.bool))
    count = ceil(seconds * rate) + 1
    chunks = torch.arange(batch).split(max(2, AT_ONCE // count))
    found = [_run(rig, {n: v[..., chunk] for n, v in values.items()}, count, rate) for chunk in chunks]
    return InitialState(
        {name: torch.cat([one.values[name] for one in found], -1) for name in found[0].values},
        {
            name: torch.cat([one.initial_perturbations[name] for one in found])
            for name in found[0].initial_perturbations
        },
        torch.cat([one.fine for one in found]),
    )


def _run(rig: Rig, values: dict[str, Tensor], count: int, rate: float) -> InitialState:
    model, still = rig.model, {name: torch.zeros_like(values[name]) for name in STEADY if name in values}
    before = values | still
    given = model.given | dict(rig.given)
    if "initial_displacement" not in given and model.system.has(Trait.PRELOAD):
        derived = model.prepare(before).derived
        before["initial_displacement"] = derived["mean_load"] / derived["mean_stiffness"]
    solver = replace(rig.solver, acceleration=False, progress=None)
    runs = simulate(model, before, sampling_rate=rate, n_samples=count, solver=solver)
    last = {name: state[:, -1] for name, state in runs.states.items()}
    seconds = torch.full_like(runs.reference_velocity, (count - 1) / rate)
    turned = model.system.begun_later(before, seconds)
    after = values | {name: turned[name] for name in ("pinion_angle",) if name in turned}
    after |= {name: last[state] for name, state in INITIAL.items()}
    prepared = model.prepare(after)
    own, units = extra_states(model, prepared), natural_units(model, prepared)
    initial_perturbations = {name: last[name] - own[name] * units[name] for name in own}
    return InitialState(after, initial_perturbations, runs.status == FINE)
