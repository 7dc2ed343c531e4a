"""A gear pair that stands and rings: the teeth that carry never change, so that it is an oscillator with its masses."""

import math

import numpy as np
import pytest
from closed_forms import free_decay

import gear_damping as gd

RATE, SAMPLES, NOISE = 40e3, 1600, 1e-7
INERTIAS, TEETH, MODULE, TORQUE = (1.2e-3, 18e-3), (23, 47), 3e-3, 14.6
STIFFNESS, RATIO = 1.5e8, 0.02


@pytest.fixture
def record(tmp_path):
    """A ring-down about the deflection that a torque holds, with the mass and load of the line of action by hand."""
    radii = [teeth * MODULE / 2 * math.cos(math.radians(20)) for teeth in TEETH]
    masses = [inertia / radius**2 for inertia, radius in zip(INERTIAS, radii, strict=True)]
    mass = masses[0] * masses[1] / (masses[0] + masses[1])
    static = TORQUE / radii[0] / STIFFNESS
    time = np.arange(SAMPLES) / RATE
    damping = 2 * RATIO * math.sqrt(STIFFNESS * mass)
    motion = static + free_decay(time, mass, damping, STIFFNESS, 8e-6, 0.0)[0]
    motion += NOISE * np.random.default_rng(4).standard_normal(SAMPLES)
    np.savetxt(tmp_path / "ring.csv", np.column_stack([time, motion]), "%.12g", ",", header="t,te", comments="")
    (tmp_path / "measurement.yaml").write_text(f"""system: gear_pair
parameters:
  n_teeth_pinion: {TEETH[0]}
  n_teeth_gear: {TEETH[1]}
  module: 3 mm
  pressure_angle: 20 deg
  inertia_pinion: {INERTIAS[0]} kg*m^2
  inertia_gear: {INERTIAS[1]} kg*m^2
records:
- file: ring.csv
  channels: {{time: {{column: t, unit: s}}, transmission_error: {{column: te, unit: m}}}}
  conditions: {{pinion_speed: 0 rpm, pinion_torque: {TORQUE} N*m, gear_torque: balanced}}
""")
    return gd.load(tmp_path / "measurement.yaml")


def test_a_ring_down_of_standing_gears_tells_damping_and_one_stiffness(record):
    fit = gd.identify(record)
    ratio = fit.damping_ratio_percent
    assert ratio["value"] == pytest.approx(100 * RATIO, rel=0.02)
    assert ratio["interval95"][1] - ratio["interval95"][0] < 0.1  # %; with a mesh phase it was all that can be
    assert fit.parameters["fourier_mesh_stiffness.maximum"]["value"] == pytest.approx(STIFFNESS, rel=2e-3)
    assert not any("shape" in name or "phase" in name for name in fit.parameters)
    assert "lack of fit" not in fit.table()
