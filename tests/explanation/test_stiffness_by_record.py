"""A frequency that differs from record to record is named with that of each record, or told where one model is lost."""

import re

import numpy as np
import pytest
import yaml

from gear_damping.explanation.explain import explain
from gear_damping.interface.identified_oscillator import content_of, linear_fit
from gear_damping.measurement.load import load_measurement

RATE, SECONDS, NOISE = 60.0, 14.0, 0.1


def measured(folder, frequencies, ratios):
    """Free decays by their closed form; the last record is held out."""
    rng, time, records = np.random.default_rng(12), np.arange(int(RATE * SECONDS)) / RATE, []
    for k, (frequency, ratio) in enumerate(zip(frequencies, ratios, strict=True)):
        natural = 2 * np.pi * frequency
        damped, amplitude = natural * np.sqrt(1 - ratio**2), 10 + 3 * (k % 3)
        wave = np.cos(damped * time) + ratio * natural / damped * np.sin(damped * time)
        moved = amplitude * np.exp(-ratio * natural * time) * wave + rng.normal(0, NOISE, len(time))
        np.savetxt(folder / f"r{k}.csv", np.c_[time, moved], delimiter=",", header="t,x", comments="")
        channels = {"time": {"column": "t", "unit": "s"}, "displacement": {"column": "x", "unit": "mm"}}
        role = "holdout" if k == len(frequencies) - 1 else "fit"
        records.append({"name": f"r{k}", "file": f"r{k}.csv", "role": role, "channels": channels})
    (folder / "measurement.yaml").write_text(yaml.safe_dump({"system": "oscillator", "records": records}))
    return load_measurement(folder / "measurement.yaml")


def told(sentences, what):
    """Figures by record from the sentence about them, with their intervals."""
    (said,) = (one for one in sentences if one.startswith(f"The {what} is "))
    found = {}
    for part in said.partition(" is ")[2].partition(": no")[0].split(", "):
        value, _, rest = part.partition(" (")
        ends, _, record = rest.partition(") in ")
        found[record] = float(value.split()[0]), *map(float, ends.split(" to "))
    return found


@pytest.mark.slow
@pytest.mark.parametrize("frequencies", [(3.1, 3.14, 3.05, 3.2, 3.1), (3.1, 3.3, 2.9, 3.2, 3.0)], ids=["near", "far"])
def test_it_is_named_with_the_frequency_of_every_record(frequencies, tmp_path):
    content = explain(measured(tmp_path, frequencies, (0.02,) * 5)).content
    assert [cause["name"] for cause in content["causes"]] == ["stiffness_by_record"]
    assert content["verdict"] == "explained"
    assert content["causes"][0]["status"] == "established"
    found = told(content["sentences"], "natural frequency")
    for k, frequency in enumerate(frequencies[:4]):
        value, low, high = found[f"r{k}"]
        assert value == pytest.approx(frequency, rel=5e-4)
        assert 0 < high - low < 2e-3 * frequency
    damping = content["gain"]["damping_ratio_percent"]
    assert damping["by_record"] == []
    low, high = damping["after"]["interval95"]
    assert low < 2 < high < low + 0.2


@pytest.mark.slow
def test_a_damping_that_differs_too_is_named_beside_it(tmp_path):
    ratios = (0.02, 0.024, 0.03, 0.017, 0.022)
    content = explain(measured(tmp_path, (3.1, 3.14, 3.05, 3.2, 3.1), ratios)).content
    assert {cause["name"] for cause in content["causes"]} == {"stiffness_by_record", "damping_by_record"}
    rows = {row["record"]: row["value"] for row in content["gain"]["damping_ratio_percent"]["by_record"]}
    assert [rows[f"r{k}"] for k in range(4)] == pytest.approx([100 * one for one in ratios[:4]], rel=0.04)
    assert set(told(content["sentences"], "natural frequency")) == {"r0", "r1", "r2", "r3"}


def test_one_frequency_for_all_records_is_none(tmp_path):
    measurement = measured(tmp_path, (3.1,) * 5, (0.02,) * 5)
    content = explain(measurement).content
    assert (content["verdict"], content["causes"]) == ("consistent", [])
    assert not any("follows each" in said for said in content["sentences"])
    assert content_of(measurement, linear_fit(measurement, None, None))["differing"] is None


def test_records_of_two_rigs_are_told_with_the_figures_of_each(tmp_path):
    measurement = measured(tmp_path, (2.4, 2.4, 1.9, 1.9, 2.4), (0.02, 0.02, 0.03, 0.03, 0.02))
    content = explain(measurement).content
    assert (content["verdict"], content["causes"]) == ("unexplained", [])
    (said,) = (one for one in content["sentences"] if one.startswith("A linear model of its own follows each record: "))
    identified = content_of(measurement, linear_fit(measurement, None, None))["differing"]
    for text in (said, identified):
        found = {name: (float(f), float(r)) for f, r, name in re.findall(r"([\d.]+) Hz and ([\d.]+) % in (r\d)", text)}
        assert [found[f"r{k}"][0] for k in range(4)] == pytest.approx([2.4, 2.4, 1.9, 1.9], rel=2e-3)
        assert [found[f"r{k}"][1] for k in range(4)] == pytest.approx([2, 2, 3, 3], rel=0.04)
