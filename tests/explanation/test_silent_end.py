"""A decay that has died away is judged by the end of its motion, and not by the noise behind it."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hidden.oscillator.inputs import NONE
from hidden.oscillator.laws import members
from hidden.oscillator.motion import between, move
from scipy.signal import lfilter

from gear_damping.explanation.evidence.records import evidence_of
from gear_damping.explanation.evidence.silent_end import audible_samples
from gear_damping.explanation.explain import explain
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.measurement.load import load_measurement

RATE, FREQUENCY, NOISE = 1000.0, 20.0, 1e-3


def record_of(ratio, seconds, offset=0.3, seed=1, **inputs):
    time = np.arange(round(RATE * seconds)) / RATE
    rate = 2 * np.pi * FREQUENCY
    values = offset + np.exp(-ratio * rate * time) * np.cos(rate * time)
    values += NOISE * np.random.default_rng(seed).standard_normal(len(time))
    return FitRecord("decay", torch.tensor(values), RATE, inputs={n: torch.tensor(f(time)) for n, f in inputs.items()})


@pytest.mark.parametrize("ratio", [0.01, 0.03, 0.1])
def test_it_ends_where_the_motion_meets_the_noise(ratio):
    found = audible_samples(record_of(ratio, 30.0)) / RATE
    # where cos^2 averaged over a period has the power of the noise
    meets = np.log(1 / (np.sqrt(2) * NOISE)) / (ratio * 2 * np.pi * FREQUENCY)
    assert meets - 1.0 < found < meets + 1.0


@pytest.mark.parametrize("ratio", [0.01, 0.03])
def test_a_noise_of_the_first_order_is_no_motion_either(ratio):
    """Its spectrum above the signal lies far below its variance: every block of it seemed to move."""
    record = record_of(ratio, 30.0)
    noise = lfilter([1], [1, -0.9], np.random.default_rng(3).standard_normal(len(record.response)))
    coloured = replace(record, response=record.response + 3 * NOISE * torch.tensor(noise / noise.std()))
    found = audible_samples(coloured) / RATE
    meets = np.log(1 / (np.sqrt(2) * 3 * NOISE)) / (ratio * 2 * np.pi * FREQUENCY)
    assert meets - 1.0 < found < meets + 1.0


@pytest.mark.parametrize("seed", range(5))
def test_a_motion_that_lasts_is_kept_whole(seed):
    record = record_of(0.0, 8.0, seed=seed)
    assert audible_samples(record) == len(record.response)
    alone = FitRecord("noise", torch.tensor(np.random.default_rng(seed).standard_normal(4000)), RATE)
    assert audible_samples(alone) == 4000


def test_an_input_that_moves_is_no_silence():
    late = record_of(0.03, 30.0, force=lambda time: 1.0 * (time > 25.0) * np.sin(300 * time))
    assert audible_samples(late) == len(late.response)
    stroke = record_of(0.03, 30.0, force=lambda time: 1.0 * (time < 0.005))
    assert audible_samples(stroke) < 5 * RATE


def test_noise_on_a_measured_input_is_no_movement():
    noise = np.random.default_rng(7).standard_normal
    stroke = record_of(0.03, 30.0, force=lambda time: 1.0 * (time < 0.005) + 0.02 * noise(len(time)))
    assert audible_samples(stroke) < 5 * RATE


@pytest.mark.slow
@pytest.mark.parametrize(("knobs", "names"), [({}, set()), ({"cubic": 0.3}, {"cubic_stiffness"})])
def test_a_long_tail_changes_no_answer(knobs, names, tmp_path):
    periods = 400.0
    motion = move(members([{"zeta": 0.01} | knobs]), [NONE], np.array([[1.0], [0.0]]), 2 * np.pi * periods + 1)
    time = np.arange(round(periods * 25)) / 25
    values = between(motion, 0, 2 * np.pi * time, 0) + NOISE * np.random.default_rng(2).standard_normal(len(time))
    np.savetxt(tmp_path / "d.csv", np.c_[time / FREQUENCY, values], delimiter=",", header="t,x", comments="")
    (tmp_path / "measurement.yaml").write_text(
        "system: oscillator\nrecords:\n  - {file: d.csv, channels: {time: {column: t, unit: s},"
        " displacement: {column: x, unit: mm}}}\n"
    )
    measurement = load_measurement(tmp_path / "measurement.yaml")
    evidence = evidence_of(measurement)
    assert 0.5 * 400 < evidence.silent_s * FREQUENCY < 0.8 * 400
    assert evidence.holdout[0].response.std() > 2 * NOISE
    content = explain(measurement).content
    assert {cause["name"] for cause in content["causes"]} == names
    assert content["verdict"] == ("explained" if names else "consistent")
    assert any("hold only noise" in sentence for sentence in content["sentences"])
    assert content["gain"]["damping_ratio_percent"]["after"]["value"] == pytest.approx(1.0, rel=0.01)
