"""task=simulate: write simulated runs as arrays, as a figure and, where asked for, as a measurement."""

from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import torch

from gear_damping.config.settings import Settings
from gear_damping.measurement.record import Channel, Quantity, Record
from gear_damping.measurement.write import write_measurement
from gear_damping.reporting import figures
from gear_damping.simulation.runs import Runs
from gear_damping.tasks import statements
from gear_damping.tasks.run_folder import RunFolder
from gear_damping.tasks.simulated import plan_of, simulated

CHANNEL_UNITS = {"transmission_error": "m", "pinion_torque": "N*m", "pinion_angle": "rad", "displacement": "m"}


def run(settings: Settings, folder: RunFolder) -> dict[str, Any]:
    """Simulate and write; returns the metrics for run.json."""
    plan = plan_of(settings)
    runs = simulated(plan, settings)
    statements.say_runs(settings, runs)
    channels = recorded_channels(runs, settings.seed)
    arrays = {name: signal.numpy() for name, signal in channels.items()}
    values = {f"parameters/{name}": value.numpy() for name, value in runs.values.items()}
    ratio = runs.damping_ratio_percent.numpy()
    np.savez(folder.path / "runs.npz", t=runs.time.numpy(), damping_ratio_percent=ratio, **arrays, **values)
    folder.write_json("manifest.json", {"hash": plan.hash, "n_diverged": runs.n_diverged, "plan": plan.describe()})
    if settings.write_measurement:
        write_measurement(folder.path / "measurement", *_as_measurement(runs, channels, settings))
    figures.save(_figure(runs, channels), folder.path / "simulation.png")
    statements.say(f"wrote {folder.path / 'runs.npz'}: {len(runs.status)} runs of {len(runs.time)} samples")
    return {"n_runs": len(runs.status), "n_diverged": runs.n_diverged}


def recorded_channels(runs: Runs, seed: int) -> dict[str, torch.Tensor]:
    """Every channel of a measurement file, behind the sensors that act on it, (runs, time)."""
    generator = torch.Generator().manual_seed(seed)
    channels = {runs.model.system.response: runs.record(generator)}
    if "pinion_angle" in runs.angles:
        channels["pinion_angle"] = runs.measured("pinion_angle", generator)
        torque = runs.inputs.get("pinion_torque", runs.values["pinion_torque"].unsqueeze(1))
        channels["pinion_torque"] = torque.expand(channels["pinion_angle"].shape)
    return channels


def _as_measurement(runs: Runs, channels: dict[str, torch.Tensor], settings: Settings) -> tuple[str, list[Record]]:
    records = []
    for i in range(len(runs.status)):
        signals = {n: Channel(n, signal[i].numpy().copy(), CHANNEL_UNITS[n]) for n, signal in channels.items()}
        speed = runs.values.get("pinion_speed")
        conditions = {} if speed is None else {"pinion_speed": Quantity(float(speed[i]), "rad/s")}
        record = Record(
            f"run_{i + 1}",
            Path(f"run_{i + 1}.csv"),
            "",
            None,
            runs.sampling_rate,
            runs.time.numpy(),
            signals,
            conditions,
        )
        records.append(record)
    return runs.model.system.name, records


def _figure(runs: Runs, channels: dict[str, torch.Tensor]) -> figures.Figure:
    response = channels[runs.model.system.response][0].numpy()
    velocity = runs.states["velocity"][0].numpy()
    speed = runs.values.get("pinion_speed")
    shaft = None if speed is None else float(speed[0]) / (2 * pi)
    teeth = None if speed is None else float(runs.values["n_teeth_pinion"][0])
    ratio = None if speed is None else teeth / float(runs.values["n_teeth_gear"][0])
    unit, factor = ("µm", 1e6) if shaft else ("m", 1.0)
    return figures.simulation_figure(
        runs.time.numpy(), factor * response, velocity, unit, runs.sampling_rate,
        shaft_frequency_hz=shaft, n_teeth_pinion=teeth, gear_order=ratio,
    )  # fmt: skip
