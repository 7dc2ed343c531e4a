"""Another mass on a spring, hidden in what a sensor on the first one shows, is found; no harmonic is taken for one."""

import math

import numpy as np
import pytest
import torch
import yaml
from scipy.signal import lsim

from gear_damping.explanation.explain import explain
from gear_damping.explanation.model.rig import strongest_frequencies
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.load import load_measurement

ROLES = ("fit", "fit", "holdout")
RATE, SECONDS = 200.0, 12.0
FIRST, SECOND, RATIO = 2 * math.pi * 5.0, 2 * math.pi * 8.2, 0.01


def state_space(mass_ratio):
    """The two masses, the force on the first."""
    spring, damper = SECOND**2, 2 * RATIO * SECOND
    pull = mass_ratio * np.array([spring, damper])
    matrix = np.zeros((4, 4))
    matrix[0, 1] = matrix[2, 3] = 1.0
    matrix[1] = [-(FIRST**2) - pull[0], -2 * RATIO * FIRST - pull[1], pull[0], pull[1]]
    matrix[3] = [spring, damper, -spring, -damper]
    return matrix, np.array([[0.0], [1.0], [0.0], [0.0]]), np.eye(4)[:1], np.zeros((1, 1))


def written(folder, mass_ratio, line=0.0):
    """Three records under random forces, smooth between the samples, one of them held out.

    `line`: size of a line in the response, over its standard deviation, with another phase in every record.
    """
    rng, time = np.random.default_rng(5), np.arange(round(SECONDS * RATE)) / RATE
    records = []
    for k in range(3):
        waves = rng.uniform(0.5, 40.0, 200), rng.uniform(0, 2 * math.pi, 200)
        fine = np.arange(8 * len(time)) / (8 * RATE)
        force = np.cos(2 * math.pi * fine[:, None] * waves[0] + waves[1]).sum(1)
        x = lsim(state_space(mass_ratio), force, fine)[1][::8]
        x = x + 0.01 * x.std() * rng.normal(size=len(x))
        x = x + line * x.std() * np.cos(2 * math.pi * 8.2 * time + 2.0 * k)
        np.savetxt(folder / f"r{k}.csv", np.c_[time, x, force[::8]], delimiter=",", header="t,x,u", comments="")
        channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"},
                    "force": {"column": "u", "unit": "N"}}  # fmt: skip
        records.append({"name": f"r{k}", "file": f"r{k}.csv", "role": ROLES[k], "channels": channels})
    path = folder / "measurement.yaml"
    path.write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    return path


@pytest.mark.slow
def test_a_second_mode_is_named_with_its_mass_and_frequency(tmp_path):
    content = explain(load_measurement(written(tmp_path, 0.05))).content
    assert (content["verdict"], [cause["name"] for cause in content["causes"]]) == ("explained", ["second_mode"])
    found = content["causes"][0]["parameters"]
    assert found["mass_ratio"]["value"] == pytest.approx(0.05, rel=0.1)
    assert found["frequency"]["value"] == pytest.approx(8.2, rel=0.01)


def test_a_line_that_somebody_else_drives_is_no_mode(tmp_path):
    """A mode that does not die away, begun anew in every record, would look the same."""
    content = explain(load_measurement(written(tmp_path, 0.0, line=0.1))).content
    assert content["verdict"] == "unexplained"
    assert not [cause for cause in content["causes"] if cause["status"] == "established"]
    assert "a line" in " ".join(content["sentences"])


def test_none_is_named_where_there_is_one_mass(tmp_path):
    content = explain(load_measurement(written(tmp_path, 0.0))).content
    assert (content["verdict"], content["causes"]) == ("consistent", [])


def test_harmonics_of_the_own_frequency_are_no_modes():
    time = torch.arange(2400, dtype=torch.float64) / RATE
    left = sum(a * torch.cos(2 * math.pi * f * time) for a, f in ((9.0, 5.3), (4.0, 15.0), (1.0, 17.0), (0.5, 31.0)))
    found = strongest_frequencies([(FitRecord("a", left, RATE), left)], 5.0)
    assert found == pytest.approx((17.0, 31.0), rel=0.02)
    assert strongest_frequencies([(FitRecord("a", left, RATE), left)], 0.0) == ()


def test_what_lies_between_the_natural_frequency_and_that_of_the_motion_is_the_first_mode():
    """A pendulum of 5 Hz that swings wide at 3.6 Hz first: its misfit stands between the two."""
    time = torch.arange(2400, dtype=torch.float64) / RATE
    frequency = 5.0 - 1.4 * torch.exp(-time / 6.0)
    motion = torch.exp(-time / 8.0) * torch.cos(2 * math.pi * torch.cumsum(frequency, 0) / RATE)
    left = sum(a * torch.cos(2 * math.pi * f * time) for a, f in ((9.0, 4.05), (1.0, 8.3)))
    found = strongest_frequencies([(FitRecord("a", motion, RATE), left)], 5.0)
    assert found[0] == pytest.approx(8.3, rel=0.02)
    assert not any(3.8 < frequency < 5.5 for frequency in found)
    still = FitRecord("a", torch.cos(2 * math.pi * 5.0 * time), RATE)
    assert strongest_frequencies([(still, left)], 5.0) == pytest.approx((4.05, 8.3), rel=0.02)
