"""A drive that keeps small forces back: found in a motion by scipy, with the sharp edges of the real one."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from gear_damping.explanation.explain import explain
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.catalogue import builtin_effects
from gear_damping.physics.cause import Rig
from gear_damping.physics.effects.dead_zone import DeadZone

STIFFNESS, DAMPING, GAIN, RATE, SECONDS = 225.0, 0.9, 600.0, 100.0, 9.0  # 1/s^2, 1/s, rad/s^2 a unit of duty, Hz, s
RIVALS = ("dead_zone", "coulomb_friction", "cubic_stiffness", "power_law_damping", "sensor_saturation", "sensor_gain")
DECLARED = """
system: oscillator
records:
"""
RECORD = """
  - {{name: {name}, file: {name}.csv, role: {role}, channels: {{time: {{column: t, unit: s}},
      displacement: {{column: x, unit: rad}}, force: {{column: u, unit: "1"}}}}}}
"""


def kept_back(asked, width):
    """The exact dead zone."""
    return np.sign(asked) * np.maximum(np.abs(asked) - width, 0.0)


def drives(folder, width):
    """Three sweeps and a slow sum of sines with three amplitudes, one of them held out."""
    noise, declared = np.random.default_rng(4), DECLARED
    for number, (amplitude, role) in enumerate([(0.4, "fit"), (0.7, "fit"), (0.55, "holdout")]):
        time = np.arange(0, SECONDS, 1 / RATE)

        def duty(t, amplitude=amplitude, number=number):
            return amplitude * (np.sin((2 + number) * t + 0.12 * t**2) + 0.4 * np.sin(1.7 * t + number))

        def motion(t, state, duty=duty):
            return [state[1], GAIN * kept_back(duty(t), width) - DAMPING * state[1] - STIFFNESS * state[0]]

        found = solve_ivp(motion, (0, SECONDS), [0, 0], t_eval=time, rtol=1e-8, atol=1e-10, max_step=0.002)
        angle = found.y[0] + 0.001 * noise.standard_normal(time.size)
        rows = [f"{t:.2f},{x:.6f},{u:.6f}" for t, x, u in zip(time, angle, duty(time), strict=True)]
        (folder / f"r{number}.csv").write_text("\n".join(["t,x,u", *rows]))
        declared += RECORD.format(name=f"r{number}", role=role)
    (folder / "measurement.yaml").write_text(declared)
    return load_measurement(folder / "measurement.yaml")


def explained(folder, width):
    """Among the laws that come nearest, which saves the minute that all of them take."""
    kinds = builtin_effects().items()
    library = {name: kind for name, kind in kinds if name in RIVALS or kind.cause is None}
    return explain(drives(folder, width), library=library).content


def test_a_dead_zone_of_the_drive_is_named_with_its_size(tmp_path):
    answer = explained(tmp_path, 0.05)
    (cause,) = answer["causes"]
    assert (answer["verdict"] in ("explained", "ambiguous"), cause["name"]) == (True, "dead_zone")
    assert cause["parameters"]["width"]["value"] == pytest.approx(0.05 * GAIN, rel=0.05)
    assert answer["gain"]["damping_ratio_percent"]["after"]["value"] == pytest.approx(50 * DAMPING / 15, rel=0.05)


def test_none_is_named_where_there_is_none(tmp_path):
    assert explained(tmp_path, 0.0)["verdict"] == "consistent"


def test_it_is_tried_where_a_force_was_measured():
    assert DeadZone.cause.recipes_for(Rig("oscillator", inputs=("force",)))
    assert not DeadZone.cause.recipes_for(Rig("oscillator"))
