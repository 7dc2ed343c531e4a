"""The hum of the mains in a sensor has its name at the frequencies of grids, and nowhere else."""

import math

import numpy as np
import pytest
import yaml
from scipy.signal import lsim

from gear_damping.explanation.explain import explain
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.cause import Rig
from gear_damping.physics.effects.mains_hum import MainsHum

ROLES = ("fit", "fit", "holdout")
RATE, SECONDS, FINER = 400.0, 8.0, 8
NATURAL, RATIO = 2 * math.pi * 11.0, 0.02


def written(folder, hertz, size=0.1, channel="displacement"):
    """An oscillator under random forces, and in its sensor a sine of its own phase in every record."""
    rng, records, scale = np.random.default_rng(8), [], 0.0
    fine = np.arange(round(FINER * SECONDS * RATE)) / (FINER * RATE)
    rig = np.array([[0.0, 1.0], [-(NATURAL**2), -2 * RATIO * NATURAL]])
    seen = {"displacement": [[1.0, 0.0]], "velocity": [[0.0, 1.0]]}[channel]
    for k, role in enumerate(ROLES):
        waves = rng.uniform(0.5, 40.0, 200), rng.uniform(0, 2 * math.pi, 200)
        force = np.cos(2 * math.pi * fine[:, None] * waves[0] + waves[1]).sum(1)
        x, t = lsim((rig, [[0.0], [1.0]], seen, [[0.0]]), force, fine)[1][::FINER], fine[::FINER]
        scale = scale or x.std()  # of all records alike
        x = x + scale * (0.01 * rng.normal(size=len(x)) + size * np.sin(2 * math.pi * hertz * t + 2.1 * k))
        np.savetxt(folder / f"r{k}.csv", np.c_[t, x, force[::FINER]], delimiter=",", header="t,x,u", comments="")
        unit = {"displacement": "m", "velocity": "m/s"}[channel]
        channels = {"time": {"column": "t", "unit": "s"}, channel: {"column": "x", "unit": unit},
                    "force": {"column": "u", "unit": "N"}}  # fmt: skip
        records.append({"name": f"r{k}", "file": f"r{k}.csv", "role": role, "channels": channels})
    path = folder / "measurement.yaml"
    path.write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    return path


@pytest.mark.parametrize(
    ("band", "longest", "shown"), [(500.0, 1.0, (50, 60)), (55.0, 1.0, (50,)), (5.0, 1.0, ()), (500.0, 0.07, (60,))]
)
def test_it_is_tried_where_records_show_it(band, longest, shown):
    """At 10 Hz, 50 Hz stand still: there the hum was named for the friction of a wheel that coasts."""
    recipes = MainsHum.cause.recipes_for(Rig("oscillator", values={"amplitude": 1.0}, band=band, longest=longest))
    assert tuple(recipe.scanned["frequency"] for recipe in recipes) == shown


def established(content):
    return [cause["name"] for cause in content["causes"] if cause["status"] == "established"]


@pytest.mark.slow
@pytest.mark.parametrize(("hertz", "channel"), [(50.03, "displacement"), (59.98, "velocity")])
def test_a_hum_of_either_grid_is_named(tmp_path, hertz, channel):
    content = explain(load_measurement(written(tmp_path, hertz, channel=channel))).content
    assert (content["verdict"], established(content)) == ("explained", ["mains_hum"])
    found = content["causes"][0]["parameters"]["frequency"]
    assert found["value"] == pytest.approx(hertz, abs=2e-3)
    assert found["interval95"][0] < hertz < found["interval95"][1]


@pytest.mark.slow
def test_a_line_elsewhere_is_none(tmp_path):
    content = explain(load_measurement(written(tmp_path, 40.0))).content
    assert "mains_hum" not in established(content)
    assert "40 Hz" in " ".join(content["sentences"])
