"""Parametric stability of a gear pair: the Floquet multipliers of its mesh, by the simulator itself."""

from math import pi

import torch
from torch import Tensor

from gear_damping.physics.effects.viscous_damping import ViscousDamping
from gear_damping.physics.model import Model
from gear_damping.physics.terms import MeshStiffness
from gear_damping.simulation.runs import Runs
from gear_damping.simulation.simulate import simulate
from gear_damping.simulation.solver_settings import Solver

SAMPLES = 65  # of one mesh period
STEP = 1e-6  # natural lengths between neighbouring starts; the linear model makes any step exact


def floquet_multiplier(runs: Runs, member: int = 0) -> float:
    """Largest modulus of the multipliers of one run's mesh, contact never lost; above 1 the motion grows.

    The mesh is the linear one: other effects are left out. The damping of the run stands as its equivalent
    viscous ratio.

    Raises:
        ValueError: the mesh does not turn or bears no load, or no damping ratio is stated.
    """
    if not has_multiplier(runs, member):
        raise ValueError("pinion_speed and the mean load must not be 0 and a damping law must be on")
    mesh = [effect for effect in runs.model.effects if isinstance(effect, MeshStiffness)]
    model = Model(runs.model.system, [*mesh, ViscousDamping()])
    values = {name: _one(runs.values[name], member) for name in model.parameters() if name in runs.values}
    derived = {name: float(value[member]) for name, value in runs.derived.items()}
    critical = 2 * (derived["equivalent_mass"] * derived["mean_stiffness"]) ** 0.5
    ratio = float(runs.damping_ratio_percent[member]) / 100
    coefficient = torch.full((3,), ratio * critical, dtype=torch.float64)
    values["viscous_damping.damping_coefficient"] = coefficient
    length, rate = derived["mean_load"] / derived["mean_stiffness"], derived["natural_frequency"]
    first = torch.tensor([0.0, STEP, 0.0], dtype=torch.float64) * length
    values["initial_displacement"] = length + first
    values["initial_velocity"] = first.roll(1) * rate
    period = 2 * pi / float(values["pinion_speed"][0].abs() * values["n_teeth_pinion"][0])
    run = simulate(model, values, sampling_rate=(SAMPLES - 1) / period, n_samples=SAMPLES, solver=Solver(accuracy=1e-9))
    last = torch.stack([run.response[:, -1] / length, run.states["velocity"][:, -1] / (length * rate)])
    monodromy = (last[:, 1:] - last[:, :1]) / STEP
    return float(torch.linalg.eigvals(monodromy).abs().max())


def has_multiplier(runs: Runs, member: int = 0) -> bool:
    """Whether the mesh of a run turns under load and its damping has a ratio: without them it has no multiplier."""
    turns, loaded = (bool(series[member] != 0) for series in (runs.values["pinion_speed"], runs.derived["mean_load"]))
    return turns and loaded and bool(runs.damping_ratio_percent[member].isfinite())


def _one(value: Tensor, member: int) -> Tensor:
    """One member's value for three members."""
    return value[..., member : member + 1].expand(*value.shape[:-1], 3).clone()
