"""A damping that differs from record to record is named, with the damping of each; one damping for all is none."""

import re

import numpy as np
import pytest
import yaml

from gear_damping.explanation.explain import explain
from gear_damping.interface.identified_oscillator import content_of, linear_fit
from gear_damping.measurement.load import load_measurement

RATE, SECONDS, FREQUENCY = 60.0, 14.0, 3.1
RATIOS = (0.020, 0.024, 0.030, 0.017, 0.022)  # of critical; the last record is held out


def measured(folder, ratios):
    """Free decays by their closed form, with amplitudes that go with no damping."""
    rng, time, records = np.random.default_rng(11), np.arange(int(RATE * SECONDS)) / RATE, []
    for k, ratio in enumerate(ratios):
        natural = 2 * np.pi * FREQUENCY
        damped, amplitude = natural * np.sqrt(1 - ratio**2), 10 + 3 * (k % 3)
        wave = np.cos(damped * time) + ratio * natural / damped * np.sin(damped * time)
        moved = amplitude * np.exp(-ratio * natural * time) * wave + rng.normal(0, 0.02 * amplitude, len(time))
        np.savetxt(folder / f"r{k}.csv", np.c_[time, moved], delimiter=",", header="t,x", comments="")
        channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "mm"}}
        role = "holdout" if k == len(ratios) - 1 else "fit"
        records.append({"name": f"r{k}", "file": f"r{k}.csv", "role": role, "channels": channels})
    stated = {"stiffness": "370 1/s^2", "damping_ratio": 0.03}
    content = {"system": "oscillator", "parameters": stated, "records": records}
    (folder / "measurement.yaml").write_text(yaml.safe_dump(content))
    return load_measurement(folder / "measurement.yaml")


@pytest.fixture(scope="module")
def several(tmp_path_factory):
    return explain(measured(tmp_path_factory.mktemp("several"), RATIOS))


def test_it_is_named_and_confirmed_on_the_held_out_record(several):
    assert [cause["name"] for cause in several.content["causes"]] == ["damping_by_record"]
    assert several.content["verdict"] in ("explained", "partly_explained")
    assert several.content["causes"][0]["status"] == "established"


def test_the_damping_of_every_record_is_told_with_its_interval(several):
    rows = several.content["gain"]["damping_ratio_percent"]["by_record"]
    assert [row["record"] for row in rows] == ["r0", "r1", "r2", "r3"]
    for row, ratio in zip(rows, RATIOS, strict=False):
        low, high = row["interval95"]
        assert row["value"] == pytest.approx(100 * ratio, rel=0.02)
        assert 0.002 * row["value"] < high - low < 0.1 * row["value"]
    assert "in r2" in next(one for one in several.content["sentences"] if one.startswith("The damping ratio is 3"))


def test_the_strength_by_record_is_what_each_is_off_the_mean(several):
    cause = several.content["causes"][0]
    spread, rows = cause["parameters"]["spread"]["value"], cause["per_record"]
    levels = [cause["parameters"][f"level@{row['record']}"]["value"] for row in rows]
    assert np.mean(np.square(levels)) == pytest.approx(1, rel=1e-6)
    assert [row["value"] for row in rows] == pytest.approx([spread * level for level in levels], rel=1e-6)
    natural = 2 * np.pi * FREQUENCY
    apart = [2 * ratio * natural for ratio in RATIOS[:4]]
    assert np.ptp([row["value"] for row in rows]) == pytest.approx(np.ptp(apart), rel=0.03)


def test_the_extended_model_leaves_what_it_left_before_it_was_brought_to_one_scale(several):
    outcome = several.found.outcome
    again = outcome.problem.linearise(outcome.fitted.shared.unsqueeze(0), outcome.fitted.states.unsqueeze(0))
    np.testing.assert_allclose(again.residual[0], outcome.fitted.prediction.residual[0], atol=1e-6)
    places = [i for i, p in enumerate(outcome.problem.free) if p.name.startswith("damping_by_record")]
    own = outcome.fitted.prediction.sensitivity[0][..., places]
    np.testing.assert_allclose(again.sensitivity[0][..., places], own, rtol=1e-3, atol=1e-3 * float(own.abs().max()))


def test_identify_says_that_one_damping_is_none_of_theirs(tmp_path):
    measurement = measured(tmp_path, RATIOS)
    said = content_of(measurement, linear_fit(measurement, None, None))["differing"]
    assert said.startswith("the damping ratio is not one for all records, about ")
    told = dict(reversed(one.split(" % in ")) for one in said.partition("about ")[2].partition(":")[0].split(", "))
    assert [float(told[f"r{k}"]) for k in range(4)] == pytest.approx([100 * one for one in RATIOS[:4]], rel=0.12)


def test_one_damping_for_all_records_is_none(tmp_path):
    measurement = measured(tmp_path, RATIOS[:1] * 5)
    assert content_of(measurement, linear_fit(measurement, None, None))["differing"] is None
    content = explain(measurement).content
    assert (content["verdict"], content["causes"]) == ("consistent", [])
    assert content["gain"]["damping_ratio_percent"]["by_record"] == []


def test_without_a_spring_the_coefficient_of_every_record_is_told(tmp_path):
    """Discs that a magnet brakes: no damping is critical, and the ratio of each was said to be 0 %."""
    rates, time, generator = (0.1, 0.15, 0.45, 0.2), np.arange(0, 12, 0.05), np.random.default_rng(8)
    records = []
    for k, rate in enumerate(rates):
        speed = 20 * np.exp(-rate * time) + 0.01 * generator.normal(size=time.size)
        np.savetxt(tmp_path / f"r{k}.csv", np.c_[time, speed], delimiter=",")
        channels = {"time": {"column": 0, "unit": "s"}, "velocity": {"column": 1, "unit": "rad/s"}}
        role = "holdout" if k == len(rates) - 1 else "fit"
        records.append({"name": f"r{k}", "file": f"r{k}.csv", "role": role, "channels": channels})
    content = {"system": "oscillator", "parameters": {"stiffness": "0 1/s^2"}, "records": records}
    (tmp_path / "measurement.yaml").write_text(yaml.safe_dump(content))
    found = explain(load_measurement(tmp_path / "measurement.yaml")).content
    assert [cause["name"] for cause in found["causes"]] == ["damping_by_record"]
    (said,) = (one for one in found["sentences"] if one.startswith("The viscous damping is"))
    told = {record: float(value) for value, record in re.findall(r"([\d.]+) 1/s \([^)]*\) in (r\d)", said)}
    assert told == pytest.approx({"r0": 0.1, "r1": 0.15, "r2": 0.45}, rel=0.02)
