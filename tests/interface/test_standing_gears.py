"""A gear pair that stands and rings: the teeth that carry never change, so that it is an oscillator with its masses."""

import math

import numpy as np
import pytest
from closed_forms import free_decay

import gear_damping as gd

RATE, NOISE = 50e3, 3e-8
INERTIAS, TEETH, MODULE = (1.2e-3, 9e-3), (23, 41), 3.5e-3
RATIO = 0.03


def recorded(tmp_path, stiffness, torque, samples):
    """A ring-down about the deflection that a torque holds, with the mass and load of the line of action by hand."""
    radii = [teeth * MODULE / 2 * math.cos(math.radians(20)) for teeth in TEETH]
    masses = [inertia / radius**2 for inertia, radius in zip(INERTIAS, radii, strict=True)]
    mass = masses[0] * masses[1] / (masses[0] + masses[1])
    static = torque / radii[0] / stiffness
    time = np.arange(samples) / RATE
    damping = 2 * RATIO * math.sqrt(stiffness * mass)
    motion = static + free_decay(time, mass, damping, stiffness, 12e-6, 0.0)[0]
    motion += NOISE * np.random.default_rng(4).standard_normal(samples)
    np.savetxt(tmp_path / "ring.csv", np.column_stack([time, motion]), "%.12g", ",", header="t,te", comments="")
    (tmp_path / "measurement.yaml").write_text(f"""system: gear_pair
parameters:
  n_teeth_pinion: {TEETH[0]}
  n_teeth_gear: {TEETH[1]}
  module: 3.5 mm
  pressure_angle: 20 deg
  inertia_pinion: {INERTIAS[0]} kg*m^2
  inertia_gear: {INERTIAS[1]} kg*m^2
records:
- file: ring.csv
  channels: {{time: {{column: t, unit: s}}, transmission_error: {{column: te, unit: m}}}}
  conditions: {{pinion_speed: 0 rpm, pinion_torque: {torque} N*m, gear_torque: balanced}}
""")
    return gd.load(tmp_path / "measurement.yaml")


@pytest.mark.parametrize(
    ("stiffness", "torque", "samples"),
    [(1.5e8, 14.6, 1600), (4.89e7, 0.0, 4000)],  # the second rings far below where a search begins, and bears no load
)
def test_a_ring_down_of_standing_gears_tells_damping_and_one_stiffness(tmp_path, stiffness, torque, samples):
    told = []
    fit = gd.identify(recorded(tmp_path, stiffness, torque, samples), progress=lambda *steps: told.append(steps))
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    ratio = fit.damping_ratio_percent
    assert ratio["value"] == pytest.approx(100 * RATIO, rel=0.02)
    assert ratio["interval95"][1] - ratio["interval95"][0] < 0.1  # %; with a mesh phase it was all that can be
    assert fit.parameters["fourier_mesh_stiffness.maximum"]["value"] == pytest.approx(stiffness, rel=2e-3)
    assert not any("shape" in name or "phase" in name for name in fit.parameters)
    assert "lack of fit" not in fit.table()


LARGEST = "mesh_stiffness_max: {value: 2.4e8, unit: N/m, uncertainty: 0.05}"
SMALLEST = "mesh_stiffness_min: {value: 1.45e8, unit: N/m, uncertainty: 0.05}"


@pytest.mark.parametrize("stated", [f"{LARGEST}\n  {SMALLEST}", LARGEST])
def test_one_pair_of_teeth_that_carries_contradicts_no_stiffness_of_two(tmp_path, stated):
    """A pair stands wherever it stands: its stiffness was expected to be the largest one."""
    recorded(tmp_path, 1.5e8, 14.6, 1600)
    path = tmp_path / "measurement.yaml"
    path.write_text(path.read_text().replace("records:", f"  {stated}\nrecords:"))
    fit = gd.identify(gd.load(path))
    assert fit.parameters["fourier_mesh_stiffness.maximum"]["value"] == pytest.approx(1.5e8, rel=2e-3)
    assert fit.damping_ratio_percent["value"] == pytest.approx(100 * RATIO, rel=0.02)
    assert fit.content["contradicted"] is None


def test_the_speed_of_a_shaft_that_stands_is_its_vibration(tmp_path):
    """A gyro on the pinion, whose share of the motion is by hand what its inertia makes of the force on the teeth."""
    recorded(tmp_path, 1.5e8, 0.0, 1600)
    time, _ = np.loadtxt(tmp_path / "ring.csv", delimiter=",", skiprows=1).T
    radii = [teeth * MODULE / 2 * math.cos(math.radians(20)) for teeth in TEETH]
    eases = [radius / inertia for radius, inertia in zip(radii, INERTIAS, strict=True)]
    mass = 1 / (radii[0] * eases[0] + radii[1] * eases[1])
    clean = free_decay(time, mass, 2 * RATIO * math.sqrt(1.5e8 * mass), 1.5e8, 12e-6, 0.0)[1]
    speed = clean * eases[0] * mass + 1e-5 * np.random.default_rng(5).standard_normal(time.size)
    np.savetxt(tmp_path / "ring.csv", np.column_stack([time, speed]), "%.12g", ",", header="t,w", comments="")
    text = (tmp_path / "measurement.yaml").read_text()
    text = text.replace("transmission_error: {column: te, unit: m}", "pinion_speed: {column: w, unit: rad/s}")
    (tmp_path / "measurement.yaml").write_text(text)
    fit = gd.identify(gd.load(tmp_path / "measurement.yaml"))
    assert fit.damping_ratio_percent["value"] == pytest.approx(100 * RATIO, rel=0.01)
    assert fit.parameters["fourier_mesh_stiffness.maximum"]["value"] == pytest.approx(1.5e8, rel=2e-3)
    assert not any(name.startswith("pinion_") for name in fit.parameters)  # it does not turn


@pytest.mark.parametrize(("unit", "asked"), [("mm", False), ("in", True)])
def test_a_stiffness_that_no_teeth_have_is_asked_back(tmp_path, unit, asked):
    recorded(tmp_path, 1.5e8, 0.0, 1600)
    path = tmp_path / "measurement.yaml"
    path.write_text(path.read_text().replace("module: 3.5 mm", f"module: 3.5 {unit}"))
    said = gd.identify(gd.load(path)).content["contradicted"]
    assert bool(said) is asked
    assert not asked or said.endswith("check the units of module and inertias, and of the response")
