"""What the figures of a rig foretell, by closed forms: 18 and 45 teeth of 3 mm, 20 degrees, 150 N m at 1800 rpm."""

import numpy as np
import pytest

from gear_damping.measurement.foretold import natural_frequency, of_record
from gear_damping.measurement.load import load_measurement
from gear_damping.tasks.inspect import _measurement_lines

STATED = {
    "n_teeth_pinion": 18,
    "n_teeth_gear": 45,
    "module": "3 mm",
    "pressure_angle": "20 deg",
    "mesh_stiffness_max": "400 N/um",
    "mesh_stiffness_min": "200 N/um",
    "contact_ratio": 1.6,
    "inertia_pinion": "0.0012 kg*m^2",
    "inertia_gear": "0.05 kg*m^2",
}


@pytest.fixture
def rig(bench):
    """With everything stated that a gear pair has."""
    bench.content["parameters"] = dict(STATED)
    return bench


def test_a_gear_pair_is_foretold_by_its_figures(rig):
    radii = np.array([18, 45]) * 3e-3 * np.cos(np.radians(20)) / 2
    mass = 1 / (radii[0] ** 2 / 0.0012 + radii[1] ** 2 / 0.05)
    measurement = rig.load()
    assert natural_frequency(measurement) == pytest.approx(np.sqrt(320e6 / mass) / (2 * np.pi))
    pressed = 1e6 * 150 / radii[0] / 320e6  # the torque of the file is 150 N m and a slow wave of 1
    said = of_record(measurement, measurement.records[0])
    assert said.startswith("teeth mesh at 540 Hz on average, the mean torque presses them by ")
    assert float(said.split()[-2]) == pytest.approx(pressed, rel=0.01)
    assert said.endswith(" um")


@pytest.mark.parametrize(
    ("mean_um", "datum", "is_doubted"),
    [(18.5, "absolute", False), (-18.5, "absolute", False), (1.85, "absolute", True), (1.85, "arbitrary", False)],
)
def test_a_mean_far_from_what_the_torque_makes_is_doubted(rig, mean_um, datum, is_doubted):
    """A torque with a gain of .1 pressed teeth by 191 um that gave way by 20."""
    name = rig.channels["transmission_error"]["column"]
    rig.columns[name] = rig.columns[name] - rig.columns[name].mean() + mean_um
    rig.channels["transmission_error"] |= {"datum": datum, "unit": "um"}
    measurement = rig.load()
    said = of_record(measurement, measurement.records[0])
    assert (", and its mean, counted from the unloaded contact, is 1.85 um" in said) == is_doubted


@pytest.mark.parametrize(("inertia", "is_doubted"), [("0.0012 kg*m^2", False), ("0.0012 kg*cm^2", True)])
def test_a_natural_frequency_beyond_the_records_is_doubted(rig, inertia, is_doubted):
    rig.content["parameters"]["inertia_pinion"] = inertia
    measurement = rig.load()
    (line,) = [line for line in _measurement_lines(measurement) if "natural frequency" in line]
    half = measurement.records[0].sampling_rate / 2
    assert (natural_frequency(measurement) > half) == is_doubted
    assert line.endswith(f", above half of every sampling rate ({half:g} Hz): are their units right?") == is_doubted


def test_a_speed_about_its_mean_is_not_the_mean(rig):
    rig.columns["w1"] = 0.1 * np.sin(600 * rig.columns["t"])
    del rig.channels["pinion_angle"], rig.channels["transmission_error"]
    rig.channels["pinion_speed"] = {"column": "w1", "unit": "rad/s", "coupling": "AC"}
    rig.record["conditions"] = {"pinion_speed": {"value": 1800, "unit": "rpm"}}
    measurement = rig.load()
    assert of_record(measurement, measurement.records[0]).startswith("teeth mesh at 540 Hz on average, ")


@pytest.mark.parametrize("missing", ["contact_ratio", "mesh_stiffness_max"])
def test_what_is_not_stated_is_not_foretold(missing, rig):
    del rig.content["parameters"][missing]
    measurement = rig.load()
    assert natural_frequency(measurement) is None
    assert of_record(measurement, measurement.records[0]) == "teeth mesh at 540 Hz on average"


def test_an_oscillator_is_foretold_by_its_stiffness(tmp_path):
    np.savetxt(tmp_path / "a.csv", np.cos(np.arange(300) / 10), header="x", comments="")
    lines = ["system: oscillator", "parameters: {stiffness: {value: 400, unit: 1/s^2}}"]
    lines += ["records: [{file: a.csv, sampling_rate: 100 Hz, channels: {displacement: {column: x, unit: mm}}}]"]
    (tmp_path / "m.yaml").write_text("\n".join(lines))
    measurement = load_measurement(tmp_path / "m.yaml")
    assert natural_frequency(measurement) == pytest.approx(20 / (2 * np.pi))
    assert of_record(measurement, measurement.records[0]) == ""
