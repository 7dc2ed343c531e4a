"""task=simulate: write simulated runs as arrays, as a figure and, where asked for, as a measurement."""

from dataclasses import replace
from typing import Any

import numpy as np

from gear_damping.config.settings import Settings
from gear_damping.errors import written_whole
from gear_damping.interface.simulated import run_figure
from gear_damping.measurement.write import write_measurement
from gear_damping.physics.systems.known import SYSTEMS
from gear_damping.reporting import figures
from gear_damping.tasks import statements
from gear_damping.tasks.recorded import as_records, recorded_channels, rig_parameters
from gear_damping.tasks.run_folder import RunFolder
from gear_damping.tasks.simulated import plan_of, simulated
from gear_damping.tasks.simulated_summary import summary_of

NOISE_SEED = 2  # added to the seed of the plan for what the sensors add


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Simulate and write; returns the metrics for run.json."""
    # Asked to simulate at a damping ratio, all runs have it; only a training keeps it for its test runs.
    plan = replace(plan_of(settings), damping_ratio_percent=settings.simulator.damping_ratio_percent)
    folder.add_inputs(settings.simulator.files, "simulator.extended")
    runs = simulated(plan, settings)
    statements.log_runs(settings, runs)
    channels = recorded_channels(runs, plan.seed + NOISE_SEED)
    arrays = {name: signal.numpy() for name, signal in channels.items()}
    values = {f"parameters/{name}": value.numpy() for name, value in runs.values.items()}
    ratio = runs.damping_ratio_percent.numpy()
    with written_whole(folder.path / "runs.npz") as path, path.open("wb") as file:
        np.savez(file, t=runs.time.numpy(), damping_ratio_percent=ratio, **arrays, **values)
    folder.write_json("manifest.json", {"hash": plan.hash, "n_diverged": runs.n_diverged, "plan": plan.describe()})
    if settings.write_measurement:
        records, system = as_records(runs, channels), runs.model.system
        own = None if system.name in SYSTEMS else type(system)
        rig = rig_parameters(settings)
        path = write_measurement(folder.path / "measurement", system.name, records, rig, own=own)
        statements.log(f"wrote {path}: measurement.path={path} takes the runs as measured records")
    shown = run_figure(runs, channels[runs.model.system.response])
    figures.save(shown, folder.path / "simulation.png")
    folder.write_json("simulation.json", summary_of(runs, plan, channels) | {"measured": settings.write_measurement})
    statements.log(f"wrote {folder.path / 'runs.npz'}: {len(runs.status)} runs of {len(runs.time)} samples")
    return {"n_runs": len(runs.status), "n_diverged": runs.n_diverged}
