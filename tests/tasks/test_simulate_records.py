"""What task=simulate leaves: every channel of a rig, and files that come back as a measurement."""

import json

import numpy as np
import pytest

from gear_damping.measurement.load import load_measurement
from gear_damping.reporting import figures
from gear_damping.tasks.command import main

OSCILLATOR = ["simulator=oscillator", "family=none", "simulator.initial_displacement=0.05"]


@pytest.fixture(autouse=True)
def _no_drawing(monkeypatch):
    """Figures have tests of their own and take longer than the runs."""
    monkeypatch.setattr(figures, "save", lambda figure, path: path)


def simulate(folder, *arguments):
    """The arrays of runs.npz."""
    place = [f"hydra.run.dir={folder / 'run'}", f"data_folder={folder / 'data'}", "progress=false"]
    size = ["simulator.n_runs=2", "simulator.n_samples=400", "write_measurement=true"]
    assert main(["task=simulate", *size, *arguments, *place]) == 0
    with np.load(folder / "run" / "runs.npz") as runs:
        return dict(runs)


def read_back(folder):
    return load_measurement(folder / "run" / "measurement" / "measurement.yaml")


def test_a_varied_torque_is_in_the_torque_channels_and_a_ripple_is_not(tmp_path):
    ramp = "simulator.torque_variation={form:ramp,ramp_start:0.002,ramp_end:0.006,ramp_change:40}"
    runs = simulate(tmp_path, ramp, "simulator.torque_ripple={}")
    added = np.interp(runs["t"], [0.002, 0.006], [0, 40])
    expected = runs["parameters/pinion_torque"][:, None] + added
    np.testing.assert_allclose(runs["pinion_torque"], expected, rtol=1e-12)
    np.testing.assert_allclose(runs["gear_torque"], 2 * expected, rtol=1e-12)
    record = read_back(tmp_path).records[1]
    assert record.gear_torque_mode == "balanced"
    assert set(record.channels) == {"transmission_error", "pinion_torque", "pinion_angle"}
    for name, channel in record.channels.items():
        np.testing.assert_allclose(channel.values, runs[name][1], rtol=1e-12)


def test_a_held_gear_torque_is_a_channel_of_its_own(tmp_path):
    runs = simulate(tmp_path, "simulator.gear_torque_mode=held", "simulator.gear_torque=290")
    assert (runs["gear_torque"] == 290).all()
    record = read_back(tmp_path).records[0]
    assert record.gear_torque_mode is None
    assert (record.channels["gear_torque"].values == 290).all()


def test_known_parameters_of_the_rig_go_along_and_what_is_to_be_found_does_not(tmp_path):
    rig = ["simulator.n_teeth_gear=41", "simulator.module={value:4,unit:mm}", "simulator.backlash={}"]
    mesh = ["simulator.fourier_mesh_stiffness=null", "simulator.rectangular_mesh_stiffness.contact_ratio=1.7"]
    runs = simulate(tmp_path, *rig, *mesh, "simulator.power_law_damping.exponent=1.5")
    known = {name: quantity.value for name, quantity in read_back(tmp_path).parameters.items()}
    assert known == pytest.approx({"n_teeth_gear": 41, "module": 4e-3, "contact_ratio": 1.7})
    np.testing.assert_allclose(runs["gear_torque"] / runs["pinion_torque"], 41 / 20)


def test_the_response_is_behind_the_sensors_and_the_angle_behind_its_own(tmp_path):
    sensors = ["simulator.sensor_gain.gain=1.1", "simulator.sensor_offset.offset_um=3"]
    clean = simulate(tmp_path / "clean")
    seen = simulate(tmp_path / "seen", *sensors, "simulator.shaft_angle_error.amplitude_deg=0.25")
    np.testing.assert_allclose(seen["transmission_error"], 1.1 * clean["transmission_error"] + 3e-6, rtol=1e-9)
    wrong = seen["pinion_angle"] - clean["pinion_angle"]
    np.testing.assert_allclose(np.abs(wrong).max(), np.deg2rad(0.25), rtol=0.02)


def test_an_oscillator_has_velocity_and_acceleration_of_its_displacement(tmp_path):
    runs = simulate(tmp_path, *OSCILLATOR, "simulator.cubic_stiffness.coefficient=1e6", "simulator.n_samples=2000")
    assert {"displacement", "velocity", "acceleration"} <= set(runs)
    for name, rate in (("displacement", "velocity"), ("velocity", "acceleration")):
        slope = np.gradient(runs[name][0], runs["t"])
        np.testing.assert_allclose(slope[2:-2], runs[rate][0][2:-2], atol=0.01 * np.abs(slope).max())
    assert set(read_back(tmp_path).records[0].channels) == {"displacement"}


def test_a_record_goes_into_identification(tmp_path):
    simulate(tmp_path, *OSCILLATOR, "simulator.viscous_damping.damping_coefficient=4", "simulator.n_runs=1")
    path = tmp_path / "run" / "measurement" / "measurement.yaml"
    again = [f"hydra.run.dir={tmp_path / 'again'}", "progress=false"]
    assert main(["task=identify", f"measurement.path={path}", *again]) == 0
    found = json.loads((tmp_path / "again" / "identification.json").read_text())
    assert found["damping_ratio_percent"]["value"] == pytest.approx(2.0, rel=1e-4)
    assert found["natural_frequency_hz"]["value"] == pytest.approx(100 / (2 * np.pi), rel=1e-5)


def test_the_damping_ratio_asked_for_is_that_of_all_runs(tmp_path):
    assert simulate(tmp_path, "simulator.damping_ratio_percent=0.3")["damping_ratio_percent"] == pytest.approx(0.3)


def test_noise_comes_from_the_seed(tmp_path):
    first, same, other = (
        simulate(tmp_path / str(i), "simulator.sensor_noise.snr_db=20", f"seed={seed}")["transmission_error"]
        for i, seed in enumerate((1, 1, 2))
    )
    assert (first == same).all()
    assert (first != other).any()
