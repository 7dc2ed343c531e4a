"""Two masses, a force on the first and a sensor on the second: the mode that moves it the other way is found."""

import math

import numpy as np
import pytest
import yaml
from scipy.signal import lsim

from gear_damping.explanation.explain import explain
from gear_damping.measurement.load import load_measurement

ROLES = ("fit", "fit", "holdout")
RATE, SECONDS, FINER = 200.0, 12.0, 8
MASSES, HELD, BETWEEN, LOSS = (1.0, 0.6), 900.0, 1300.0, 3e-4  # kg, N/m to the ground and between them, s
UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s^2"}


def matrices(held, drag=0.0):
    """Mass, damping and stiffness of the two, the damping as the stiffness but for a drag of the first."""
    stiffness = np.array([[held + BETWEEN, -BETWEEN], [-BETWEEN, BETWEEN]])
    mass = np.diag(MASSES)
    return mass, LOSS * stiffness + drag * mass, stiffness


def modes(held, drag=0.0):
    """Frequency in Hz and damping ratio of each mode that swings."""
    mass, damping, stiffness = matrices(held, drag)
    squared, shapes = np.linalg.eigh(np.diag(np.diag(mass) ** -0.5) @ stiffness @ np.diag(np.diag(mass) ** -0.5))
    rates = np.sqrt(squared.clip(0))
    ratios = [
        (v @ (damping / np.sqrt(np.outer(MASSES, MASSES))) @ v) / (2 * w) if w > 1 else 0
        for w, v in zip(rates, shapes.T, strict=True)
    ]
    return [(w / (2 * math.pi), ratio) for w, ratio in zip(rates, ratios, strict=True)]


def motion(force, time, held, sensor, kind, drag=0.0):
    """What a sensor on one of the masses shows of a force on the first."""
    mass, damping, stiffness = matrices(held, drag)
    inverse = np.linalg.inv(mass)
    state = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ stiffness, -inverse @ damping]])
    driven = np.r_[np.zeros(2), inverse[:, 0]][:, None]
    rows = {"displacement": np.eye(4)[:2], "velocity": np.eye(4)[2:], "acceleration": state[2:]}[kind]
    direct = driven[2:] if kind == "acceleration" else np.zeros((2, 1))
    return lsim((state, driven, rows[[sensor]], direct[[sensor]]), force, time)[1]


def written(folder, kind, sensor, held=HELD, drag=0.0, unsprung=False):
    rng, records = np.random.default_rng(11), []
    fine = np.arange(round(FINER * SECONDS * RATE)) / (FINER * RATE)
    for k, role in enumerate(ROLES):
        waves = rng.uniform(0.3, 30.0, 150), rng.uniform(0, 2 * math.pi, 150)
        force = np.cos(2 * math.pi * fine[:, None] * waves[0] + waves[1]).sum(1)
        x = motion(force, fine, held, sensor, kind, drag)[::FINER]
        x = x + 0.01 * x.std() * rng.normal(size=len(x))
        np.savetxt(
            folder / f"r{k}.csv", np.c_[fine[::FINER], x, force[::FINER]], delimiter=",", header="t,x,u", comments=""
        )
        channels = {"time": {"column": "t", "unit": "s"}, kind: {"column": "x", "unit": UNITS[kind]},
                    "force": {"column": "u", "unit": "N"}}  # fmt: skip
        records.append({"name": f"r{k}", "file": f"r{k}.csv", "role": role, "channels": channels})
    content = {"system": "oscillator", "records": records}
    if unsprung:
        content["parameters"] = {"stiffness": {"value": 0, "unit": "1/s^2"}}
    path = folder / "measurement.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def named(content):
    return content["verdict"], [cause["name"] for cause in content["causes"] if cause["status"] == "established"]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["displacement", "velocity"])
def test_a_sensor_on_the_other_mass_is_seen(tmp_path, kind):
    content = explain(load_measurement(written(tmp_path, kind, sensor=1))).content
    assert named(content) == ("explained", ["noncollocated_mode"])
    found = content["causes"][0]["parameters"]
    frequencies = [frequency for frequency, _ in modes(HELD)]
    assert min(abs(found["frequency"]["value"] / one - 1) for one in frequencies) < 0.003


@pytest.mark.slow
def test_a_sensor_on_the_driven_mass_needs_none(tmp_path):
    content = explain(load_measurement(written(tmp_path, "displacement", sensor=0))).content
    assert named(content) == ("explained", ["second_mode"])


@pytest.mark.slow
def test_a_load_behind_a_soft_shaft_whose_speed_is_measured(tmp_path):
    content = explain(load_measurement(written(tmp_path, "velocity", 1, held=0.0, drag=2.0, unsprung=True))).content
    assert named(content) == ("explained", ["noncollocated_mode"])
