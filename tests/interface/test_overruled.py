"""Values of a gear pair that the model and the file of its records both have: said where they differ."""

import math

import numpy as np
import pytest
from closed_forms import free_decay

import gear_damping as gd

RATE, STIFFNESS, TORQUE = 50e3, 1.5e8, 14.6
FREE = ["damping_ratio", "fourier_mesh_stiffness.maximum"]


@pytest.fixture(scope="module")
def ringing(tmp_path_factory):
    """A pair that stands and rings with 3 % about the deflection that a torque holds."""
    folder = tmp_path_factory.mktemp("ringing")
    radii = [teeth * 3.5e-3 / 2 * math.cos(math.radians(20)) for teeth in (23, 41)]
    masses = [inertia / radius**2 for inertia, radius in zip((1.2e-3, 9e-3), radii, strict=True)]
    mass = masses[0] * masses[1] / sum(masses)
    time = np.arange(1600) / RATE
    motion = TORQUE / radii[0] / STIFFNESS
    motion = motion + free_decay(time, mass, 0.06 * math.sqrt(STIFFNESS * mass), STIFFNESS, 12e-6, 0.0)[0]
    motion += 3e-8 * np.random.default_rng(4).standard_normal(time.size)
    np.savetxt(folder / "ring.csv", np.column_stack([time, motion]), "%.12g", ",", header="t,te", comments="")
    (folder / "measurement.yaml").write_text(f"""system: gear_pair
parameters: {{n_teeth_pinion: 23, n_teeth_gear: 41, module: 3.5 mm, pressure_angle: 20 deg,
  inertia_pinion: 1.2e-3 kg*m^2, inertia_gear: 9e-3 kg*m^2}}
records:
- file: ring.csv
  channels: {{time: {{column: t, unit: s}}, transmission_error: {{column: te, unit: m}}}}
  conditions: {{pinion_speed: 0 rpm, pinion_torque: {TORQUE} N*m, gear_torque: balanced}}
""")
    return gd.load(folder / "measurement.yaml")


def identified(ringing, **given):
    parts = [gd.FourierMeshStiffness(maximum=STIFFNESS, minimum=STIFFNESS), gd.ViscousDamping()]
    return gd.identify(ringing, gd.Model(gd.GearPair(**given), parts), free=FREE)


def test_another_number_of_teeth_is_refused(ringing):
    """20 teeth of the model beat the 23 of the file without a word."""
    with pytest.raises(gd.InputError, match=r"n_teeth_pinion = 20\.0: is the model's, and the file states 23"):
        identified(ringing, n_teeth_pinion=20)


def test_what_is_held_against_the_file_is_said(ringing):
    said = "inertia_gear is held at 0.018, as the model has it, and the file states 0.009"
    assert said in identified(ringing, inertia_gear=1.8e-2).table()
    same = identified(ringing, inertia_gear=9e-3, n_teeth_pinion=23, pinion_torque=TORQUE)
    assert same.content["overruled"] == []


@pytest.mark.parametrize("given", [{"pinion_torque": 100.0}, {"pinion_speed": 30.0}])
def test_what_every_record_has_of_its_own_is_no_value_of_the_rig(given, ringing):
    found = identified(ringing, **given)
    ((name, value),) = given.items()
    assert f"{name} = {value:g} of the model has no effect: every record has its own" in found.table()
    assert name not in found.model.given
