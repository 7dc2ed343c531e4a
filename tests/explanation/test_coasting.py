"""A wheel that coasts: dry friction beside drag, neither of which shows its law without the other.

The speed of dv/dt = -(d + q v^2) is sqrt(d/q) tan(phi - sqrt(d q) t), in closed form.
"""

import numpy as np
import pytest

from gear_damping.explanation.explain import explain
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.cause import Rig
from gear_damping.physics.effects.asymmetric_friction import AsymmetricFriction
from gear_damping.physics.effects.hysteretic_damping import HystereticDamping

FIRST, RATE = 15.0, 10.0  # m/s, Hz
DECLARED = """
system: oscillator
parameters: {{stiffness: {{value: 0, unit: 1/s^2}}}}
records:
  - {{name: fast, file: run.csv, role: fit, window: {{from: 0, to: {half}, unit: s}}, channels: &channels
      {{time: {{column: t, unit: s}}, velocity: {{column: v, unit: m/s}}}}}}
  - {{name: slow, file: run.csv, role: holdout, window: {{from: {half}, to: {end}, unit: s}}, channels: *channels}}
"""


def coasts(folder, dry, drag, noise):
    """A run almost to rest: its first half is fitted."""
    begin = np.arctan(FIRST * np.sqrt(drag / dry))
    stops = begin / np.sqrt(dry * drag)
    time = np.arange(0, 0.9 * stops, 1 / RATE)
    speed = np.sqrt(dry / drag) * np.tan(begin - np.sqrt(dry * drag) * time)
    speed += noise * np.random.default_rng(3).standard_normal(time.size)
    rows = [f"{t:.2f},{v:.5f}" for t, v in zip(time, speed, strict=True)]
    (folder / "run.csv").write_text("\n".join(["t,v", *rows]))
    (folder / "measurement.yaml").write_text(DECLARED.format(half=round(stops / 2), end=int(0.9 * stops) - 1))
    return load_measurement(folder / "measurement.yaml")


@pytest.mark.parametrize(
    ("dry", "drag", "noise"),
    [
        (0.16, 0.0014, 0.005),  # the dry friction is found first
        pytest.param(0.3, 0.004, 0.01, marks=pytest.mark.slow),  # the drag alone runs to the bound of its exponent
    ],
)
def test_dry_friction_and_drag_are_told_apart(tmp_path, dry, drag, noise):
    answer = explain(coasts(tmp_path, dry, drag, noise)).content
    found = {cause["name"]: {k: v["value"] for k, v in cause["parameters"].items()} for cause in answer["causes"]}
    assert answer["verdict"] == "explained"
    assert set(found) == {"coulomb_friction", "power_law_damping"}
    assert found["coulomb_friction"]["force"] == pytest.approx(dry, rel=0.05)
    assert found["power_law_damping"]["exponent"] == pytest.approx(2.0, rel=0.05)
    named = {candidate["name"] for candidate in answer["candidates"]}
    assert not named & {"asymmetric_friction", "hysteretic_damping"}


@pytest.mark.parametrize("kind", [AsymmetricFriction, HystereticDamping])
def test_what_only_a_reversal_shows_is_tried_where_there_is_one(kind):
    assert kind.cause.recipes_for(Rig("oscillator"))
    assert not kind.cause.recipes_for(Rig("oscillator", one_way=True))
