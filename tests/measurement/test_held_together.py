"""Channels of one motion that contradict each other, and torques under which shafts would not turn evenly."""

import numpy as np
import pytest

from gear_damping.measurement.load import load_measurement

RATE, FREQUENCY = 500.0, 2 * np.pi * 7.0
TIME = np.arange(2000) / RATE
SWING = np.exp(-0.4 * TIME) * np.cos(FREQUENCY * TIME)  # mm
BENT = -(FREQUENCY**2) * SWING * 1e-3  # m/s^2, but for the part of the slow decay
OSCILLATOR = """
system: oscillator
records:
  - {{name: ring, file: ring.csv, channels: {{sampling_rate: 500 Hz,
     displacement: {{column: x, unit: mm}}, {other}: {{column: y, unit: {unit}}}}}}}
"""


def kinds(folder, declared):
    (folder / "measurement.yaml").write_text(declared)
    findings = load_measurement(folder / "measurement.yaml").records[0].findings
    return {one.kind: one.message for one in findings if one.severity == "data_problem"}


@pytest.mark.parametrize(
    ("other", "unit", "values", "said"),
    [
        ("acceleration", "m/s^2", BENT, ""),
        ("acceleration", "gn", BENT / 9.81, ""),
        ("acceleration", "gn", BENT, "times (check both units) what displacement"),
        ("acceleration", "m/s^2", -BENT, "with its sign reversed (check polarity and unit)"),
        ("velocity", "m/s", np.gradient(SWING, TIME) * 1e-3, ""),
        ("velocity", "mm/s", SWING, "out of step by 90 degrees (check both columns)"),
    ],
)
def test_derivatives_of_one_motion_agree(tmp_path, other, unit, values, said):
    noise = 0.01 * np.random.default_rng(5).standard_normal((2, TIME.size))
    rows = zip(SWING + noise[0], values + np.std(values) * noise[1], strict=True)
    (tmp_path / "ring.csv").write_text("x,y\n" + "\n".join(f"{x:.8g},{y:.8g}" for x, y in rows))
    found = kinds(tmp_path, OSCILLATOR.format(other=other, unit=unit))
    assert said in found.get("motions_disagree", "")
    assert ("motions_disagree" in found) is bool(said)


@pytest.mark.parametrize(
    ("pinion", "gear", "disagrees"),
    [
        (60.0, 120.0, False),
        (60.0, 110.0, False),  # losses
        (60.0, 60.0, True),  # stated of the other shaft
        (60.0, -120.0, True),  # with the sign that it has about the other axis
    ],
)
def test_torques_of_shafts_that_turn_evenly_balance(bench, pinion, gear, disagrees):
    known = {"n_teeth_pinion": {"value": 20}, "n_teeth_gear": {"value": 40}, "module": {"value": 3, "unit": "mm"}}
    known |= {f"inertia_{shaft}": {"value": 0.01, "unit": "kg*m^2"} for shaft in ("pinion", "gear")}
    bench.content["parameters"] = known
    del bench.channels["pinion_torque"], bench.channels["gear_torque"]
    torques = {"pinion_torque": pinion, "gear_torque": gear}
    bench.record["conditions"] = {name: {"value": value, "unit": "N*m"} for name, value in torques.items()}
    assert ("torques_disagree" in bench.kinds()) is disagrees


@pytest.mark.parametrize(("faster", "said"), [(1.0, "and it hardly leaves 1"), (4.0, "and it goes from 2")])
def test_what_the_speed_does_beside_torques_of_the_wrong_shafts_is_told_as_it_is(bench, faster, said):
    known = {"n_teeth_pinion": {"value": 20}, "n_teeth_gear": {"value": 40}, "module": {"value": 3, "unit": "mm"}}
    known |= {f"inertia_{shaft}": {"value": 1e-4, "unit": "kg*m^2"} for shaft in ("pinion", "gear")}
    bench.content["parameters"] = known
    time = bench.columns["t"]
    bench.columns["theta1"] = 60 * np.pi * (time + (faster - 1) * time**2 / 2 / time[-1])
    del bench.channels["pinion_torque"], bench.channels["gear_torque"]
    torques = {"pinion_torque": 150.0, "gear_torque": 75.0}
    bench.record["conditions"] = {name: {"value": value, "unit": "N*m"} for name, value in torques.items()}
    (found,) = [one for one in bench.load().findings if one.kind == "torques_disagree"]
    assert said in found.message


@pytest.mark.parametrize(("share", "disagrees"), [(1.0, False), (0.98, False), (0.5, True), (0.02, False)])
def test_the_speed_of_the_gear_is_that_of_the_pinion_by_the_teeth(bench, share, disagrees):
    """A vibrometer at twice the radius shows half of it; one that lost its mean, next to nothing."""
    bench.content["parameters"] |= {"n_teeth_pinion": {"value": 20}, "n_teeth_gear": {"value": 40}}
    (angle,) = (bench.columns[name] for name in ("theta1",))
    speed = np.gradient(angle, bench.columns["t"]) / 2
    bench.columns["w2"] = share * speed + 0.01 * speed * np.sin(900 * bench.columns["t"])
    bench.channels["gear_speed"] = {"column": "w2", "unit": "rad/s"}
    assert ("speeds_disagree" in bench.kinds()) is disagrees


@pytest.mark.parametrize(("off", "disagrees"), [(1.0, False), (1.3, False), (0.5, True), (2.0, True)])
def test_an_acceleration_on_a_shaft_is_its_share_of_the_transmission_error(bench, off, disagrees):
    """By Newton: the force on the teeth turns each shaft by its base radius over its inertia."""
    inertias, teeth, radius = (0.004, 0.02), (20, 40), 0.05
    known = {"n_teeth_pinion": {"value": teeth[0]}, "n_teeth_gear": {"value": teeth[1]}}
    known |= {f"inertia_{s}": {"value": j, "unit": "kg*m^2"} for s, j in zip(("pinion", "gear"), inertias, strict=True)}
    bench.content["parameters"] |= known
    base = [3e-3 * z * np.cos(np.deg2rad(20)) / 2 for z in teeth]
    time, pitch = bench.columns["t"], 2 * np.pi * 1500
    runout = 20.0 * np.sin(2 * np.pi * 50 * time)  # of an encoder, which no shaft follows
    bench.columns["dte"] = 8.0 + 2.0 * np.sin(pitch * time) + runout
    force = 2e-6 * pitch**2 * np.sin(pitch * time) / (base[0] ** 2 / inertias[0] + base[1] ** 2 / inertias[1])
    bench.columns["a"] = off * radius * force * base[1] / inertias[1]
    where = {"mounting": "tangential", "shaft": "gear", "radius": {"value": 50, "unit": "mm"}}
    bench.channels["acceleration"] = {"column": "a", "unit": "m/s^2", **where}
    said = [one for one in bench.load().findings if one.kind == "motions_disagree"]
    assert bool(said) is disagrees
    assert all(one.severity == "note" for one in said)  # a shaft that bends does the same
