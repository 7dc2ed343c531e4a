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
