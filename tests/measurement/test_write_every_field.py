"""Every field of a record and its channels comes back from the file that it is written to."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.identification.observation import fit_record
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.record import Channel, Quantity, Record
from gear_damping.measurement.write import write_measurement
from gear_damping.physics.systems.gear_pair import GearPair

UNLIKE = {"name", "values", "unit", "hold", "timing_error", "mean_added"}  # none that an acceleration has
WORKED_OUT = {"rounding"}  # of the samples at the rate of their own file, which the written one does not have
DIFFERENT = {
    "lowpass": 3e3, "lowpass_order": 4, "highpass": 2.0, "highpass_order": 2, "coupling": "AC", "delay": 1e-4,
    "range": 4.0, "noise": 0.25, "uncertainty": 0.03, "polarity": -1, "gain": -4.0, "datum": "arbitrary",
    "mounting": "tangential", "radius": 0.03, "shaft": "gear", "frame": "relative", "declared_unit": "mm/s^2",
    "declared_factor": 1e-3,
}  # fmt: skip


def _of(system: str, response: Channel, **others: Channel) -> Record:
    time = np.arange(40) / 1e4
    conditions = {"pinion_speed": Quantity(100.0, "rad/s", 0.005), "pinion_torque": Quantity(9.0, "N*m", 0.1)}
    return Record("one", Path("-"), "", "reference" if response.mounting == "casing" else "holdout", 1e4, time,
                  {response.name: response} | others, conditions if system == "gear_pair" else {},
                  "balanced" if system == "gear_pair" else None)  # fmt: skip


@pytest.mark.parametrize("name", sorted({f.name for f in fields(Channel)} - UNLIKE - WORKED_OUT))
def test_every_field_of_a_channel_is_written_and_read(name, tmp_path):
    values = np.random.default_rng(1).standard_normal(40)
    system = "oscillator" if name == "frame" else "gear_pair"
    mounted = {} if name == "frame" else {"mounting": "tangential", "radius": 0.02, "shaft": "pinion"}
    needed = {"highpass_order": {"highpass": 2.0}, "lowpass_order": {"lowpass": 3e3},
              "coupling": {"datum": "arbitrary"},
              "declared_factor": {"declared_unit": "mm/s^2"}, "declared_unit": {"declared_factor": 1e-3}}  # fmt: skip
    channel = Channel("acceleration", values, "m/s^2", **mounted)
    channel = replace(channel, **needed.get(name, {}) | {name: DIFFERENT[name]})
    base = {"base_acceleration": Channel("base_acceleration", values, "m/s^2")} if name == "frame" else {}
    record = _of(system, channel, **base)
    measurement = load_measurement(write_measurement(tmp_path, system, [record], None, 0.002))
    read = measurement.records[0]
    assert measurement.segment_s == 0.002
    assert (read.role, dict(read.conditions), read.gear_torque_mode, read.mesh_index) == (
        record.role, dict(record.conditions), record.gear_torque_mode, record.mesh_index,
    )  # fmt: skip
    found = read.channels["acceleration"]
    np.testing.assert_allclose(found.values, values, rtol=1e-14)
    told = {key: value for key, value in vars(channel).items() if key != "values"}
    assert {key: vars(found)[key] for key in told} == told
    assert getattr(found, name) != getattr(Channel("acceleration", values, "m/s^2"), name)


def test_a_speed_that_was_given_its_mean_comes_back_with_what_its_sensor_saw(tmp_path):
    values = np.random.default_rng(1).standard_normal(40)
    speed = Channel(
        "pinion_speed", values + 100.0, "rad/s", coupling="AC", datum="arbitrary", range=5.0, mean_added=99.0
    )
    measurement = load_measurement(write_measurement(tmp_path, "gear_pair", [_of("gear_pair", speed)], None, 0.002))
    found = measurement.records[0].channels["pinion_speed"]
    np.testing.assert_allclose(found.values - found.values.mean(), values - values.mean(), rtol=1e-12, atol=1e-12)
    assert found.values.mean() == pytest.approx(100.0)
    np.testing.assert_allclose(found.values - found.mean_added, values + 1.0, rtol=1e-12)
    assert [finding.kind for finding in measurement.findings if finding.kind == "clipped"] == []


def test_what_could_not_be_read_back_is_not_written(tmp_path):
    channel = Channel("acceleration", np.zeros(40), "m/s^2", mounting="tangential", radius=0.02)
    with pytest.raises(InputError, match=r"acceleration\.shaft: is missing"):
        write_measurement(tmp_path / "new", "gear_pair", [_of("gear_pair", channel)])
    assert not (tmp_path / "new").exists()


def test_how_late_an_angle_may_be_is_written_and_read(tmp_path):
    values = np.random.default_rng(1).standard_normal(40)
    angle = Channel("pinion_angle", np.arange(40) / 100, "rad", datum="arbitrary", timing_error=3e-6)
    record = _of("gear_pair", Channel("transmission_error", values, "m"), pinion_angle=angle)
    read = load_measurement(write_measurement(tmp_path, "gear_pair", [record], None, 0.002)).records[0]
    assert read.channels["pinion_angle"].timing_error == 3e-6
    own = {p.name: p for p in fit_record(read, GearPair).own if p.name.startswith("angle")}
    assert {name: p.expected for name, p in own.items()} == {"angle_error": 0.0, "angle_error_rate": 0.0}
    late = 3e-6 * 100.0  # s, of 100 rad/s
    assert own["angle_error"].deviation == pytest.approx(late)
    assert own["angle_error_rate"].deviation == pytest.approx(12**0.5 * late / 3.9e-3)


@pytest.mark.parametrize("hold", [False, True])
def test_whether_an_input_is_held_is_written_and_read(hold, tmp_path):
    """Stated both ways: what is read of the numbers alone would be the other."""
    values = np.random.default_rng(1).standard_normal(40)
    steps = values if hold else np.sign(values)
    force = Channel("force", steps, "N", hold=hold)
    record = _of("oscillator", Channel("displacement", values, "m"), force=force)
    read = load_measurement(write_measurement(tmp_path, "oscillator", [record], None, 0.002)).records[0]
    assert read.channels["force"].hold is hold
