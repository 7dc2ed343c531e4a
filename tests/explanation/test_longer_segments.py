"""A softening that a segment of five swings hardly shows is named once it follows longer ones."""

import numpy as np
import yaml
from scipy.integrate import solve_ivp

from gear_damping.explanation.explain import explain
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.catalogue import builtin_effects

STIFFNESS, DAMPING, RATE, SECONDS, NOISE = 72.6, 0.025, 21.0, 40.0, 0.02  # 1/s^2, 1/s, Hz, s, m
STARTS = {"first": ("fit", 0.4), "second": ("holdout", 0.3), "third": ("fit", 0.2), "fourth": ("holdout", 0.35)}  # m
LIBRARY = ("cubic_stiffness", "coulomb_friction")


def written(folder, softening):
    """Decays of an oscillator, each from where it was let go."""
    rng, time = np.random.default_rng(5), np.arange(0, SECONDS, 1 / RATE)
    records = []
    for name, (role, start) in STARTS.items():
        force = lambda t, y: (y[1], -DAMPING * y[1] - STIFFNESS * y[0] - softening * y[0] ** 3)  # noqa: E731
        x = solve_ivp(force, (0, SECONDS), (start, 0.0), t_eval=time, rtol=1e-9, atol=1e-11).y[0]
        x += NOISE * rng.normal(size=len(x))
        np.savetxt(folder / f"{name}.csv", np.c_[time, x], delimiter=",", header="t,x", comments="")
        channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "m"}}
        records.append({"name": name, "file": f"{name}.csv", "role": role, "channels": channels})
    path = folder / "measurement.yaml"
    path.write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    return path


def answer(folder, softening):
    library = {name: kind for name, kind in builtin_effects().items() if name in LIBRARY or kind.cause is None}
    return explain(load_measurement(written(folder, softening)), library=library).content


def test_the_frequency_goes_with_the_amplitude(tmp_path):
    content = answer(tmp_path, -16.3)
    assert [(c["name"], c["status"]) for c in content["causes"]] == [("cubic_stiffness", "established")]
    assert content["verdict"] == "explained"  # in segments of five swings in part
    low, high = content["causes"][0]["parameters"]["coefficient"]["interval95"]
    assert low < -16.3 < high
    assert high - low < 2.0  # of segments of five swings 5.3


def test_where_nothing_bends_nothing_is_named(tmp_path):
    assert answer(tmp_path, 0.0)["verdict"] == "consistent"
