"""A rig without a spring keeps the time that its damper gives it, however slowly it is driven."""

import numpy as np
import pytest
from scipy.signal import lfilter

from gear_damping.explanation.explain import evidence_of
from gear_damping.explanation.steps.calibrate import calibrated
from gear_damping.measurement.load import load_measurement

RATE, DAMPING, GAIN = 10.0, 0.6, 7.0  # Hz; 1/s; of the drive
DECLARED = """
system: oscillator
parameters: {stiffness: {value: 0, unit: 1/s^2}}
records:
  - name: steps
    file: steps.csv
    channels:
      sampling_rate: 10 Hz
      force: {column: u, unit: "1", hold: true}
      velocity: {column: v, unit: rad/s}
"""


def test_its_time_is_one_over_the_damping_and_not_that_of_its_drive(tmp_path):
    rng = np.random.default_rng(41)
    drive = np.repeat(rng.uniform(-1.0, 1.0, 12), 600)  # a step a minute
    decay = np.exp(-DAMPING / RATE)
    speed = lfilter([0.0, GAIN / DAMPING * (1 - decay)], [1.0, -decay], drive) + 0.01 * rng.standard_normal(drive.size)
    rows = [f"{u:.6f},{v:.6f}" for u, v in zip(drive, speed, strict=True)]
    (tmp_path / "steps.csv").write_text("\n".join(["u,v", *rows]))
    (tmp_path / "measurement.yaml").write_text(DECLARED)
    nominal = calibrated(evidence_of(load_measurement(tmp_path / "measurement.yaml"))).nominal
    assert nominal.values["viscous_damping.damping_coefficient"] == pytest.approx(DAMPING, rel=0.02)
    assert nominal.hypothesis.given["characteristic_time"] == pytest.approx(1 / DAMPING, rel=0.02)
