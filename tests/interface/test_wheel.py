"""The wheel by itself: installed nowhere near the repository, used from an empty folder."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
import torch

from gear_damping.identification.lightning_module import DampingModule
from gear_damping.identification.saved import write_shared

ROOT = Path(__file__).parents[2]
LINES = """
import gear_damping as gd

law = gd.PowerLawDamping(coefficient=240, exponent=2)
model = gd.Model(gd.GearPair(pinion_speed=300), [gd.FourierMeshStiffness(), law, gd.Backlash(gap=80e-6)])
runs = gd.simulate(model, sampling_rate=40e3, n_samples=200, batch=4)
assert runs.transmission_error.shape == (4, 200)
coefficients, frequencies = runs.cwt()
assert coefficients.shape == (4, len(frequencies), 200)
assert gd.Model.from_config(model.to_config()) == model

record = gd.load("measurement.yaml")
fit = gd.identify(record)
assert abs(fit.damping_ratio_percent["value"] - 100 * 1.5 / 40) < 0.1

estimator = gd.load_estimator("network")
assert estimator.module.data["window"] == 30
estimator.save("again")
print("AT", gd.__file__)
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """A folder that holds the unpacked wheel, and nothing else."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


def run(installed, folder, *arguments):
    environment = {**os.environ, "PYTHONPATH": str(installed), "PYTHONSAFEPATH": "1"}
    command = [sys.executable, *arguments]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def shared_network(folder):
    """A network for sharing, with drawn weights."""
    data = {"id": "x", "sampling_rate": 500.0, "window": 30, "whole_run": False, "trained_on": None}
    with torch.random.fork_rng():
        write_shared(DampingModule("raw_lstm", data), folder)


def test_ten_lines_run_in_an_empty_folder(installed, tmp_path):
    time = np.arange(400) / 500.0
    decay = 1e-3 * np.exp(-1.5 * time) * np.cos(40.0 * time)
    noisy = decay + 1e-6 * np.random.default_rng(1).standard_normal(400)
    np.savetxt(tmp_path / "a.csv", np.column_stack([time, noisy]), "%.9g", ",", header="t,x", comments="")
    channels = "{time: {column: t, unit: s}, displacement: {column: x, unit: m}}"
    text = f"system: oscillator\nrecords:\n- {{file: a.csv, channels: {channels}}}\n"
    (tmp_path / "measurement.yaml").write_text(text)
    shared_network(tmp_path / "network")
    found = run(installed, tmp_path, "-c", LINES)
    assert found.returncode == 0, found.stderr
    assert f"AT {installed}" in found.stdout
    assert (tmp_path / "again" / "model.json").read_bytes() == (tmp_path / "network" / "model.json").read_bytes()
    assert "raw_lstm" in (tmp_path / "again" / "model_card.md").read_text()


def test_its_command_line_has_its_configuration_with_it(installed, tmp_path):
    small = ["simulator.n_runs=2", "simulator.n_samples=100", "progress=false"]
    found = run(installed, tmp_path, "-m", "gear_damping", "task=simulate", "experiment=backlash", *small)
    assert found.returncode == 0, found.stderr
    assert list((tmp_path / "outputs").rglob("runs.npz"))
    assert {path.name for path in tmp_path.iterdir()} == {"outputs"}
    shown = run(installed, tmp_path, "-m", "gear_damping", "--help")
    assert "plan, paper, collect" in shown.stdout
    assert "slurm" in {path.stem for path in (installed / "gear_damping" / "conf" / "hydra" / "launcher").iterdir()}
