"""Another mass on a spring, hidden in what a sensor on the first one shows, is found; no harmonic is taken for one."""

import math
import re

import numpy as np
import pytest
import torch
import yaml
from scipy.signal import lsim

from gear_damping.explanation.explain import explain
from gear_damping.explanation.model.rig import strongest_frequencies
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.load import load_measurement
from gear_damping.physics.cause import Rig
from gear_damping.physics.effects.second_mode import COUPLED, SecondMode
from gear_damping.physics.systems.traits import Trait

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


@pytest.mark.slow
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


def coupled_pendulums(folder, coupling=0.78, noise=0.002):
    """Two equal pendulums on a soft spring, the first let go: two normal modes by their closed form."""
    rng, time, records = np.random.default_rng(8), np.arange(round(80 * 20.0)) / 20.0, []
    rates = math.sqrt(19.8), math.sqrt(19.8 + 2 * coupling)  # together, and against each other
    for k, size in enumerate((1.0, 0.8)):
        modes = [np.exp(-0.02 * time) * np.cos(rate * time) for rate in rates]
        x = size * (modes[0] + modes[1]) / 2 + noise * rng.normal(size=len(time))
        np.savetxt(folder / f"r{k}.csv", np.c_[time, x], delimiter=",", header="t,x", comments="")
        channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "rad"}}
        records.append({"name": f"r{k}", "file": f"r{k}.csv", "role": ROLES[k + 1], "channels": channels})
    path = folder / "measurement.yaml"
    path.write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    return path


@pytest.mark.slow
def test_pendulums_that_pass_their_motion_to_and_fro_have_a_second_mode(tmp_path):
    content = explain(load_measurement(coupled_pendulums(tmp_path))).content
    assert (content["verdict"], [cause["name"] for cause in content["causes"]]) == ("explained", ["second_mode"])
    cause = content["causes"][0]
    found = cause["parameters"] | {name: {"value": value} for name, value in cause["fixed"].items()}
    mass, tuned = 0.78**2 / (19.8 + 0.78) ** 2, math.sqrt(19.8 + 0.78) / (2 * math.pi)  # of the first on its spring
    assert found["mass_ratio"]["value"] == pytest.approx(mass, rel=0.15)
    assert found["frequency"]["value"] == pytest.approx(tuned, rel=0.01)
    assert not any("does not die away" in said for said in content["sentences"])


def test_a_mode_gives_back_what_it_took_where_coupling_is_more_than_detuning():
    mode, values = SecondMode(), {"frequency": 5.0, "mass_ratio": 0.0016, "damping_ratio": 1e-5, "drag_rate": 0.0}
    assert mode.exchange_time(values, 5.0) == pytest.approx(1 / (5 * 0.04))
    assert mode.exchange_time(values, 5.1) == pytest.approx(1 / math.hypot(0.1, 5.1 * 0.04))
    assert mode.exchange_time(values, 5.5) == math.inf


@pytest.mark.parametrize(("swells", "count"), [(False, 4), (True, 8)])
def test_the_own_frequency_stands_for_two_only_where_the_motion_swells(swells, count):
    rig = Rig("oscillator", frequencies=(7.0, 9.0), values={"natural_frequency": 2 * math.pi * 5}, swells=swells)
    tried = SecondMode.cause.recipes_for(rig)
    assert len(tried) == count
    assert ({recipe.scanned["frequency"] for recipe in tried} == {7.0, 9.0, 5.0}) == swells


def poles_of(own, stiffness, damping):
    """One of each conjugate pair of eigenvalues of both masses, the slower one first."""
    rate = 2 * math.pi * own["frequency"]
    spring, damper = rate**2, 2 * own["damping_ratio"] * rate
    pull = own["mass_ratio"] * np.array([spring, damper])
    matrix = np.zeros((4, 4))
    matrix[0, 1] = matrix[2, 3] = 1.0
    matrix[1] = [-stiffness - pull[0], -damping - pull[1], pull[0], pull[1]]
    matrix[3] = [spring, damper, -spring, -damper]
    found = np.linalg.eigvals(matrix)
    return sorted(found[found.imag > 0], key=abs)


@pytest.mark.parametrize(
    ("own", "stiffness", "damping"),
    [
        ({"mass_ratio": 0.0058, "frequency": 0.6326, "damping_ratio": 3e-4, "drag_rate": 0.0}, 17.525, 0.0067),
        ({"mass_ratio": 0.2, "frequency": 3.0, "damping_ratio": 0.05, "drag_rate": 0.0}, 100.0, 0.6),
        ({"mass_ratio": 0.02, "frequency": 1.5, "damping_ratio": 0.01, "drag_rate": 0.0}, 100.0, 0.2),
    ],
)
def test_masses_with_the_same_modes_exchange_their_energy(own, stiffness, damping):
    cause = SecondMode.cause
    modes = poles_of(own, stiffness, damping)
    assert np.allclose(cause.modes(own, stiffness, damping), modes, rtol=1e-9)
    other, spring, damper = cause.settles(own, stiffness, damping)
    assert np.allclose(poles_of(other, spring, damper), modes, rtol=1e-9)
    largest = (abs(modes[0]) ** 2 + abs(modes[1]) ** 2) ** 2 / (4 * abs(modes[0] * modes[1]) ** 2) - 1  # undamped
    assert other["mass_ratio"] == pytest.approx(COUPLED * largest, rel=0.1)
    first_is_slower = [
        k < (1 + o["mass_ratio"]) * (2 * math.pi * o["frequency"]) ** 2 for o, k in ((own, stiffness), (other, spring))
    ]
    assert first_is_slower[0] == first_is_slower[1]


def test_modes_that_no_such_masses_share_their_damping_by_stay_as_they_were_found():
    own = {"mass_ratio": 0.05, "frequency": 0.5, "damping_ratio": 0.1, "drag_rate": 0.0}
    assert SecondMode.cause.settles(own, 100.0, 0.3) == (own, 100.0, 0.3)
    one = {"mass_ratio": 1e-18, "frequency": 10 / (2 * math.pi), "damping_ratio": 0.01, "drag_rate": 0.0}
    assert SecondMode.cause.settles(one, 100.0, 0.2) == (one, 100.0, 0.2)  # two modes that are one


@pytest.mark.slow
def test_both_modes_of_one_free_swing_are_told_though_no_mass_is(tmp_path):
    """The beats of two equal pendulums, one record: how heavy the second is, its start says as well."""
    rng, time = np.random.default_rng(3), np.arange(1600) / 20.0
    modes = ((0.6203, 0.0005), (0.6794, 0.0009))  # Hz and damping ratio
    x = sum(np.exp(-2 * math.pi * f * z * time) * np.cos(2 * math.pi * f * time) for f, z in modes)
    np.savetxt(tmp_path / "a.csv", np.c_[time, x + 0.01 * rng.normal(size=len(time))], delimiter=",")
    channels = {"time": {"column": 0, "unit": "s"}, "displacement": {"column": 1, "unit": "deg"}}
    path = tmp_path / "measurement.yaml"
    path.write_text(yaml.safe_dump({"system": "oscillator", "records": [{"file": "a.csv", "channels": channels}]}))
    content = explain(load_measurement(path)).content
    assert (content["verdict"], [cause["name"] for cause in content["causes"]]) == ("explained", ["second_mode"])
    fixed = content["causes"][0]["fixed"]
    assert (set(fixed), fixed["drag_rate"]) == ({"mass_ratio", "drag_rate"}, 0)
    (said,) = [one for one in content["sentences"] if one.startswith("The two modes lie at")]
    numbers = [float(one) for one in re.findall(r"[0-9.]+[0-9]", said)]
    for k, (frequency, ratio) in enumerate(modes):
        assert numbers[6 * k + 1] < frequency < numbers[6 * k + 2]
        assert numbers[6 * k + 4] < 100 * ratio < numbers[6 * k + 5]
        assert numbers[6 * k + 5] - numbers[6 * k + 4] < 100 * ratio


@pytest.mark.parametrize(("inputs", "settled"), [((), ("mass_ratio",)), (("force",), ())])
def test_how_heavy_the_second_mass_is_stays_where_it_was_put_in_a_free_swing_alone(inputs, settled):
    rig = Rig(
        "oscillator",
        inputs=inputs,
        frequencies=(7.0,),
        values={"natural_frequency": 30.0},
        traits=frozenset({Trait.REST}),
    )
    assert {recipe.settled for recipe in SecondMode.cause.recipes_for(rig)} == {settled}


def test_a_mode_far_below_the_first_is_sought_over_few_of_its_cycles():
    """A torsion pendulum of .95 Hz that sways at .26 Hz, of which a window of 20 s holds five cycles."""
    time = torch.arange(1000, dtype=torch.float64) / 50.0
    motion = torch.exp(-0.05 * time) * torch.cos(2 * math.pi * 0.95 * time)
    noise = torch.randn(1000, generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    left = 0.008 * torch.cos(2 * math.pi * 0.26 * time) + 0.002 * noise
    found = strongest_frequencies([(FitRecord("a", motion, 50.0), left)], 0.95)
    assert found[0] == pytest.approx(0.26, rel=0.1)
