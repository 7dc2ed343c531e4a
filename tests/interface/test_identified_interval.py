"""Whether the interval of the damping holds where a random load pushes a decay all the time."""

import math

import numpy as np
import pytest
from closed_forms import pushed_decay

import gear_damping as gd

STIFFNESS, DAMPING, RATE, NOISE, SAMPLES = (2 * math.pi * 10) ** 2, 2.0, 100.0, 1e-4, 600
RUNS = 24


def pushed(random, load):
    """A decay from .05 under a white load, behind the sensor's noise."""
    return pushed_decay(random, load, 1.0, DAMPING, STIFFNESS, RATE, SAMPLES) + NOISE * random.normal(size=SAMPLES)


def identified(folder, values):
    np.savetxt(folder / "a.csv", values, "%.12g", header="x", comments="")
    channels = "{displacement: {column: x, unit: m}}"
    text = f"system: oscillator\nrecords:\n- {{file: a.csv, sampling_rate: {RATE} Hz, channels: {channels}}}\n"
    (folder / "measurement.yaml").write_text(text)
    return gd.identify(gd.load(folder / "measurement.yaml")).damping_ratio_percent


@pytest.mark.parametrize("load", [pytest.param(0.0, marks=pytest.mark.slow), 0.1])
def test_the_interval_of_the_damping_holds(load, tmp_path):
    random, true = np.random.default_rng(11), 100 * DAMPING / (2 * math.sqrt(STIFFNESS))
    found = [identified(tmp_path, pushed(random, load)) for _ in range(RUNS)]
    deviations = [(one["value"] - true) / ((one["interval95"][1] - one["interval95"][0]) / 3.92) for one in found]
    assert 0.65 < np.sqrt(np.mean(np.square(deviations))) < 1.45  # three deviations of the mean of 24 squares
