"""A base's acceleration of another sign, unit or frame than declared is named, beside a lack of fit."""

import numpy as np
import pytest
import yaml
from scipy.signal import lsim

import gear_damping as gd
from gear_damping.interface.base_reading import base_reading

RATE, OMEGA, DAMPING, GRAVITY = 200.0, 25.0, 1.5, 9.80665
MOVED = {"displacement": {"column": "x", "unit": "mm"}}
BASE = {"column": "b", "unit": "g"}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """The relative motion of a rig of 3 % on a base that moves at random, by scipy."""
    folder, time = tmp_path_factory.mktemp("base"), np.arange(6000) / RATE
    random = np.random.default_rng(3)
    base = sum(random.normal() * np.sin(rate * time + random.uniform(0, 6)) for rate in np.linspace(4, 60, 80))
    _, motion, _ = lsim(([-1.0], [1.0, DAMPING, OMEGA**2]), base, time)
    relative = -base - DAMPING * np.gradient(motion, time) - OMEGA**2 * motion
    noisy = motion + 1e-3 * np.std(motion) * random.normal(size=time.size)
    table = np.column_stack([1e3 * noisy, relative, relative + base, base / GRAVITY])
    np.savetxt(folder / "a.csv", table, "%.9g", ",", header="x,r,y,b", comments="")

    def load(response, base):
        channels = {"sampling_rate": f"{RATE:g} Hz", **response, "base_acceleration": base}
        declared = {"system": "oscillator", "records": [{"file": "a.csv", "role": "fit", "channels": channels}]}
        (folder / "measurement.yaml").write_text(yaml.safe_dump(declared))
        return gd.load(folder / "measurement.yaml")

    return load


@pytest.mark.parametrize(
    ("response", "base", "said"),
    [
        (MOVED, BASE | {"polarity": -1}, "`polarity: -1`"),
        (MOVED, BASE | {"unit": "m/s^2"}, "base_acceleration is in g and not in m/s^2"),
        ({"acceleration": {"column": "r", "unit": "m/s^2"}}, BASE, "`frame: relative`"),
    ],
)
def test_another_reading_is_named(response, base, said, recorded):
    assert said in base_reading(recorded(response, base))


@pytest.mark.parametrize("response", [MOVED, {"acceleration": {"column": "y", "unit": "m/s^2"}}])
def test_of_what_is_declared_right_nothing_is_said(response, recorded):
    assert base_reading(recorded(response, BASE)) is None


def test_the_table_says_it_beside_the_lack_of_fit(recorded):
    found = gd.identify(recorded(MOVED, BASE | {"unit": "m/s^2"}))
    assert "the records are followed far better where base_acceleration is in g" in found.table()
    assert "followed far better" not in gd.identify(recorded(MOVED, BASE)).table()
