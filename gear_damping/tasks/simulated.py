"""Simulated runs for the tasks: from settings to plans, runs and what a learner sees."""

from dataclasses import replace
from pathlib import Path

import torch

from gear_damping.config.settings import Settings
from gear_damping.config.simulator import SENSOR_NOISE
from gear_damping.errors import InputError, Problem
from gear_damping.identification.runs import RunSet
from gear_damping.simulation.plan import SimulationPlan, run_plan
from gear_damping.simulation.runs import Runs
from gear_damping.tasks.progress import progress_bar

CONDITIONS = ("pinion_torque", "pinion_speed")  # of a run, that its record may state
RESPONSE_UNIT = "m"  # of a displacement, as the simulator gives it
TEST_SEED = 7919  # added to the seed for runs that are only tested on


def plan_of(settings: Settings) -> SimulationPlan:
    """The data set that the settings describe, its damping ratios drawn by the family."""
    s = settings.simulator
    return SimulationPlan(
        model=s.model,
        given=s.given,
        prior=s.family,
        n_runs=s.n_runs,
        sampling_rate=s.sampling_rate,
        n_samples=s.n_samples,
        seed=settings.seed,
        damping_law=s.damping_law,
        solver=s.solver,
        plugins=s.plugins,
        diverged_share=s.diverged_share,
    )


def test_plan_of(settings: Settings) -> SimulationPlan | None:
    """Other runs that all have the damping ratio asked for; None where none was asked for."""
    ratio = settings.simulator.damping_ratio_percent
    if ratio is None:
        return None
    plan = plan_of(settings)
    fewer = max(2, round(settings.protocol["test_fraction"] * plan.n_runs))
    return replace(plan, seed=plan.seed + TEST_SEED, n_runs=fewer, damping_ratio_percent=ratio)


def simulated(plan: SimulationPlan, settings: Settings, title: str = "simulating") -> Runs:
    """The runs of a plan, with progress.

    Raises:
        InputError: too many runs diverged, or all of them, whatever share is tolerated.
    """
    with progress_bar(title, settings.progress) as progress:
        runs = run_plan(plan, folder=Path(settings.data_folder), progress=progress)
    if not len(runs.status):
        rule, remedy = "leaves no run: all of them diverged", "bring the parameters back into a stable range"
        raise InputError(Problem("simulator.diverged_share", rule, plan.diverged_share, remedy))
    return runs


def run_set_of(runs: Runs, plan: SimulationPlan) -> RunSet:
    """What a learner sees: the response behind every sensor but its noise, which is added fresh each batch."""
    generator, system = torch.Generator().manual_seed(plan.seed + 2), plan.model.system
    return RunSet(
        signals=runs.record(generator, skip=(SENSOR_NOISE,)).float(),
        damping_ratio_percent=runs.stated_ratio_percent.float(),
        sampling_rate=plan.sampling_rate,
        id=plan.hash[:16],
        quantities={name: runs.values[name] for name in CONDITIONS if name in runs.values},
        system=system.name,
        channel=system.response,
        unit=RESPONSE_UNIT,
    )
