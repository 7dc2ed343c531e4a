"""What is declared beside something that excludes it is refused or said, and never dropped without a word."""

import copy

import numpy as np
import pytest

from gear_damping.errors import InputError
from gear_damping.measurement import rig
from gear_damping.measurement.load import load_measurement
from gear_damping.measurement.vocabulary import OSCILLATOR_CHANNELS
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.schema.mappings import kind_of, names
from gear_damping.tasks.recorded import OWN_UNITS, UNITS

N, RATE = 200, 1000.0
TIME = {"time": {"column": "t", "unit": "s"}}
ERROR = {"transmission_error": {"column": "x", "unit": "um"}}
ANGLE = {"pinion_angle": {"column": "angle", "unit": "rad"}}
LOAD = {"pinion_torque": {"value": 150.0, "unit": "N*m"}}
MOTION, FORCE = {"displacement": {"column": "x", "unit": "mm"}}, {"force": {"column": "F", "unit": "N"}}


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Load a measurement of these records."""
    rng, time = np.random.default_rng(3), np.arange(N) / RATE
    columns = {name: rng.standard_normal(N) for name in ("x", "F", "a")}
    np.savez(tmp_path / "data.npz", t=time, angle=90 * time, w=90 + 0 * time, p=90 * time, **columns)

    def loaded(system: str, *records: dict, **more: object):
        listed = [{"file": "data.npz", "name": str(k)} | copy.deepcopy(r) for k, r in enumerate(records)]
        content = {"system": system, "records": listed} | more
        monkeypatch.setattr("gear_damping.measurement.load.read_yaml", lambda _: content)
        return load_measurement(tmp_path / "measurement.yaml")

    return loaded


def gears(channels: dict, **more: object) -> dict:
    return {"channels": TIME | channels, "conditions": LOAD} | more


def test_an_accelerometer_on_the_casing_beside_a_transmission_error_is_said(load):
    casing = {"acceleration": {"column": "a", "unit": "m/s^2", "mounting": "casing"}}
    found = load("gear_pair", gears(ERROR | ANGLE | casing)).findings
    assert [(one.kind, one.channel, one.severity) for one in found if one.kind == "not_compared"] == [
        ("not_compared", "acceleration", "note")
    ]
    assert not any(one.kind == "not_compared" for one in load("gear_pair", gears(ERROR | ANGLE)).findings)


def test_a_speed_beside_a_measured_angle_is_said(load):
    speed = {"pinion_speed": {"column": "w", "unit": "rad/s"}}
    found = load("gear_pair", gears(ERROR | ANGLE | speed)).findings
    assert [one.channel for one in found if one.kind == "not_compared"] == ["pinion_speed"]


@pytest.mark.parametrize(
    ("records", "key", "said"),
    [
        ([gears(ERROR | ANGLE, encoders={"pinion": {"column": "p", "counts_per_revolution": 7}})],
         "records[0].encoders.pinion", "which it would give"),
        ([gears(ERROR | {"pinion_speed": {"column": "w", "unit": "rad/s", "uncertainty": 0.01}})],
         "records[0].channels.pinion_speed.uncertainty", "gives the angle, as it was read"),
        ([gears(ERROR | ANGLE | {"gear_torque": {"column": "F", "unit": "N*m", "uncertainty": 0.01}})],
         "records[0].channels.gear_torque.uncertainty", "the pinion's torque meter alone"),
        ([gears(ERROR | ANGLE, mesh_index=True), gears(ERROR | ANGLE)],
         "records[1].mesh_index", "the zero of the mesh is one of all records"),
        ([gears(ERROR | ANGLE | {"gear_torque": "balanced"}), gears(ERROR | ANGLE | {"gear_torque": "held"})],
         "records[1]", "gear_torque is held here and balanced in records[0]"),
    ],
)  # fmt: skip
def test_what_excludes_another_of_a_gear_pair_is_refused(load, records, key, said):
    with pytest.raises(InputError) as refused:
        load("gear_pair", *records, parameters={"n_teeth_pinion": 20, "n_teeth_gear": 40})
    assert [problem.key for problem in refused.value.problems] == [key]
    assert said in str(refused.value)


@pytest.mark.parametrize(
    ("records", "more", "key"),
    [
        ([{"channels": TIME | MOTION, "conditions": {"force": {"value": 2, "unit": "N"}}}] * 2, {},
         "records[0].conditions.force"),
        ([{"channels": TIME | MOTION | {"force": FORCE["force"] | {"uncertainty": 0.01}}}], {},
         "records[0].channels.force.uncertainty"),
        ([{"channels": TIME | MOTION}], {"parameters": {"stiffness": {"value": 4e3, "unit": "1/ms^2"}}},
         "parameters.stiffness"),
    ],
)  # fmt: skip
def test_what_tells_nothing_of_an_oscillator_is_refused(load, records, more, key):
    with pytest.raises(InputError) as refused:
        load("oscillator", *records, **more)
    assert [problem.key for problem in refused.value.problems] == [key]


def test_a_constant_force_on_what_has_no_spring_is_left_out_with_a_note(load):
    pushed = {"channels": TIME | MOTION, "conditions": {"force": {"value": 12, "unit": "V"}}}
    no_spring = {"stiffness": {"value": 0, "unit": "1/s^2"}}
    for record in load("oscillator", pushed, pushed, parameters=no_spring).records:
        assert record.conditions == {}
        (note,) = [finding for finding in record.findings if finding.kind == "constant_force"]
        assert (note.severity, note.record) == ("note", record.name)
        assert "the force of 12 V under conditions is left out" in note.message
    other = {"channels": TIME | MOTION, "conditions": {"force": {"value": 6, "unit": "V"}}}
    told = load("oscillator", pushed, other, parameters=no_spring).records
    assert [record.conditions["force"].value for record in told] == [12, 6]
    with pytest.raises(InputError, match="fitted by itself"):
        load("oscillator", pushed, parameters=no_spring | {"force_gain": {"value": 3, "unit": "mm/s^2/V"}})


def test_records_without_a_force_are_free_decays(load):
    none = {"channels": TIME | MOTION, "conditions": {"force": {"value": 0, "unit": "N"}}}
    assert load("oscillator", none).records[0].conditions == {}
    driven = load("oscillator", none, {"channels": TIME | MOTION | FORCE})
    assert driven.records[0].conditions["force"].value == 0


def test_parameters_lie_within_the_bounds_of_the_physics():
    declared = {name: kind_of(info) for name, info in names(rig.GearParameters).items()}
    for parameter in GearPair.parameters:
        if parameter.name in declared:
            assert declared[parameter.name].within == (parameter.lower, parameter.upper), parameter.name


def test_every_channel_of_an_oscillator_has_a_unit_where_a_simulation_is_recorded():
    assert {*OWN_UNITS} == {*OSCILLATOR_CHANNELS}
    assert {*UNITS} >= {"transmission_error", "pinion_torque", "gear_torque", "pinion_angle"}


@pytest.mark.parametrize(("corner", "is_said"), [("5 MHz", True), ("1 kHz", True), ("990 Hz", False)])
def test_a_lowpass_that_filters_nothing_of_its_record_is_said(load, corner, is_said):
    motion = {"displacement": {"column": "x", "unit": "mm", "lowpass": corner}}
    findings = load("oscillator", {"channels": TIME | motion}).findings
    found = [one for one in findings if one.kind == "filter_beyond_band"]
    assert [(one.channel, one.severity) for one in found] == ([("displacement", "note")] if is_said else [])
    assert not found or "check its unit" in found[0].message
