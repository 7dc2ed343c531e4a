"""Motions that were worked out from another column of the file are told from those of a sensor of their own."""

import numpy as np
import pytest
import yaml

from gear_damping.measurement.load import load_measurement

RATE = 200.0
TIME = np.arange(1200) / RATE
RNG = np.random.default_rng
SWING = 20 * np.exp(-0.2 * TIME) * np.cos(2 * np.pi * 1.3 * TIME)  # mm
SPEED = np.gradient(SWING, TIME)


def notes(folder, channels, columns, digits="%.9g"):
    names = ",".join(["t", *columns])
    table = np.column_stack([TIME, *columns.values()])
    np.savetxt(folder / "run.csv", table, delimiter=",", header=names, comments="", fmt=digits)
    record = {"file": "run.csv", "channels": {"time": {"column": "t", "unit": "s"}, **channels}}
    (folder / "m.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": [record]}))
    (record,) = load_measurement(folder / "m.yaml").records
    return [found.message for found in record.findings if found.kind == "worked_out"]


def slopes(values):
    """As programs take them: over two steps, from the sample before, to the next one."""
    steps = np.diff(values) * RATE
    return {"central": np.gradient(values, TIME), "back": np.r_[0, steps], "ahead": np.r_[steps, 0]}


VELOCITY = {"velocity": {"column": "v", "unit": "m/s"}}
ACCELERATION = {"acceleration": {"column": "a", "unit": "m/s^2"}}


@pytest.mark.parametrize("how", ["central", "back", "ahead"])
@pytest.mark.parametrize("step", [0.0, 0.002])
@pytest.mark.parametrize("digits", ["%.9g", "%.5f"])
def test_a_velocity_that_is_the_slope_of_a_column_is_told(how, step, digits, tmp_path):
    x = SWING + 0.01 * RNG(1).normal(size=TIME.size)
    x = np.round(x / step) * step if step else x
    (said,) = notes(tmp_path, VELOCITY, {"pos": x, "v": slopes(x)[how] / 1000, "other": np.sin(5 * TIME)}, digits)
    assert said.startswith("velocity is the slope of column 'pos'")
    assert "declare 'pos' as displacement without it" in said


def test_an_acceleration_may_be_the_slope_of_a_slope_or_of_a_declared_velocity(tmp_path):
    x = SWING + 0.01 * RNG(2).normal(size=TIME.size)
    twice = np.diff(x, n=2, prepend=np.nan, append=np.nan) * RATE**2
    (said,) = notes(tmp_path, ACCELERATION, {"pos": x, "a": np.nan_to_num(twice)})
    assert "acceleration is the slope of the slope of column 'pos'" in said
    assert "as displacement" in said
    v = SPEED + 0.1 * RNG(3).normal(size=TIME.size)
    (said,) = notes(tmp_path, VELOCITY | ACCELERATION, {"v": v, "a": np.gradient(v, TIME)})
    assert said.startswith("acceleration is the slope of column 'v'")
    assert "as velocity" in said


@pytest.mark.parametrize("noise", [0.003, 0.03])
def test_a_sensor_of_its_own_is_not_told_as_a_slope(noise, tmp_path):
    x = SWING + 0.01 * RNG(4).normal(size=TIME.size)
    v = SPEED + noise * np.std(SPEED) * RNG(5).normal(size=TIME.size)
    assert notes(tmp_path, VELOCITY, {"pos": x, "v": v}) == []
    assert notes(tmp_path, VELOCITY, {"pos": np.round(x), "v": v}) == [], "too coarse to tell"
    assert notes(tmp_path, VELOCITY, {"copy": v, "v": v}) == []
