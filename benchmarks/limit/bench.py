"""The runs that every estimator is asked about, kept with their bounds."""

from dataclasses import replace
from pathlib import Path

import torch

from gear_damping.config.settings import Settings, read_settings
from gear_damping.identification.bench import Bench
from gear_damping.identification.bench import bench as bench_of
from gear_damping.simulation.plan import run_plan
from gear_damping.tasks.composed import composed
from gear_damping.tasks.simulated import plan_of

SNRS = (30, 20, 10, 1)  # dB
TEST_SEED = 90_001  # of the runs that are asked about; training seeds are small


def settings_of(family: str, n_runs: int, seed: int) -> Settings:
    """The settings of experiment=limit."""
    overrides = ["experiment=limit", f"family={family}", f"simulator.n_runs={n_runs}", f"seed={seed}"]
    return read_settings(*composed(overrides))


def bench(family: str, n_runs: int, folder: Path) -> Bench:
    """The runs of a family; the bounds, which take longest, are kept in a folder."""
    plan = replace(plan_of(settings_of(family, n_runs, TEST_SEED)), n_runs=n_runs)
    runs = run_plan(plan)
    path = folder / f"bounds_{plan.hash[:12]}.pt"
    if not path.exists():
        made = bench_of(plan, runs, SNRS)
        folder.mkdir(parents=True, exist_ok=True)
        torch.save({str(snr): bound for snr, bound in made.bounds.items()} | {"regular": made.regular}, path)
    kept = torch.load(path, weights_only=True)
    return Bench(plan, runs, {snr: kept[str(snr)] for snr in SNRS}, kept["regular"], runs.response)
