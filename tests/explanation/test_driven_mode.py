"""A mass on a spring behind a driven one that no spring holds, by scipy's response of two masses to a swept load."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
import yaml
from scipy.signal import chirp, lsim

from gear_damping.explanation.evidence.records import evidence_of
from gear_damping.explanation.explain import explain
from gear_damping.explanation.model.driven_mode import driven_mode
from gear_damping.measurement.load import load_measurement

RATE, COUNT, DAMPING, GAIN, NOISE = 200.0, 1600, 9.0, 50.0, 0.0003
CHANNELS = {"displacement": ("rad", [1, 0, 0, 0]), "velocity": ("rad/s", [0, 1, 0, 0])}


def driven(folder, mode, channel="displacement", noise=NOISE):
    """Records of a motor in a loop that turns a beam, or nothing: loads that sweep up, down and at random."""
    rng, time = np.random.default_rng(7), np.arange(COUNT) / RATE
    rig = np.array([[0, 1, 0, 0], [0, -DAMPING, 0, 0], [0, 0, 0, 1], [0, 0, 0, -1.0]])
    if mode is not None:
        frequency, ratio, zeta, *drag = mode
        spring, damper = (2 * pi * frequency) ** 2, 4 * pi * frequency * zeta
        pull = np.array([spring, damper, -spring, -damper])
        rig[1] -= ratio * pull
        rig[3] = pull - np.array([0, 0, 0, sum(drag)])
    unit, seen = CHANNELS[channel]
    loads = [chirp(time, 0.3, 8.0, 9.0), chirp(time, 0.3, 8.0, 6.0), np.sign(rng.normal(0, 1, 40)).repeat(40)]
    records = []
    for k, load in enumerate(loads):
        moved = lsim((rig, [[0], [GAIN], [0], [0]], [seen], [[0]]), load, time)[1]
        size = np.ptp(moved)
        rows = np.c_[load, moved + noise * size * rng.normal(0, 1, COUNT)]
        np.savetxt(folder / f"r{k}.csv", rows, delimiter=",", header="u,x", comments="")
        channels = {"sampling_rate": f"{RATE} Hz", channel: {"column": "x", "unit": unit}}
        channels["force"] = {"column": "u", "unit": "1"}
        records.append({"file": f"r{k}.csv", "role": "holdout" if k == 1 else "fit", "channels": channels})
    content = {"system": "oscillator", "parameters": {"stiffness": "0 1/s^2"}, "records": records}
    (folder / "measurement.yaml").write_text(yaml.safe_dump(content))
    return load_measurement(folder / "measurement.yaml")


@pytest.mark.parametrize("channel", CHANNELS)
@pytest.mark.parametrize(("frequency", "ratio"), [(2.5, 1.7), (3.0, 0.1), (4.0, 0.6)])
def test_the_frequency_at_which_the_other_mass_holds_the_first_is_found(tmp_path, frequency, ratio, channel):
    records = evidence_of(driven(tmp_path, (frequency, ratio, 0.01), channel)).fit
    found = driven_mode(records, NOISE * np.ptp(records[0].response.numpy()))
    assert found.frequency == pytest.approx(frequency, rel=0.15)
    assert ratio / 2 < found.mass_ratio < 1.2 * ratio  # noise of the motion makes it look small


def test_a_load_that_the_ground_brakes_is_found_with_its_drag(tmp_path):
    records = evidence_of(driven(tmp_path, (2.5, 0.6, 0.01, 12.0), "velocity")).fit
    found = driven_mode(records, NOISE * np.ptp(records[0].response.numpy()))
    assert (found.frequency, found.mass_ratio) == pytest.approx((2.5, 0.6), rel=0.35)
    assert 6.0 < found.drag_rate < 24.0


def test_a_load_that_nothing_else_brakes_has_no_drag(tmp_path):
    records = evidence_of(driven(tmp_path, (2.5, 0.6, 0.01), "velocity")).fit
    assert driven_mode(records, NOISE * np.ptp(records[0].response.numpy())).drag_rate == 0


def test_a_load_may_count_the_other_way_round(tmp_path):
    records = evidence_of(driven(tmp_path, (2.5, 1.7, 0.01), "velocity")).fit
    noise = NOISE * np.ptp(records[0].response.numpy())
    turned = [replace(one, inputs={"force": -one.inputs["force"]}) for one in records]
    assert driven_mode(turned, noise) == driven_mode(records, noise)


@pytest.mark.parametrize("noise", [1.5, 3.0])
def test_beside_a_noise_that_is_stated_too_large_nothing_is_begun(tmp_path, noise):
    records = evidence_of(driven(tmp_path, None, "velocity", noise=0.1)).fit
    assert driven_mode(records, noise * 0.1 * np.ptp(records[0].response.numpy())) is None


@pytest.mark.parametrize("channel", CHANNELS)
def test_one_mass_has_none_behind_it(tmp_path, channel):
    records = evidence_of(driven(tmp_path, None, channel)).fit
    assert driven_mode(records, NOISE * np.ptp(records[0].response.numpy())) is None


def test_loads_that_are_not_measured_drive_nothing(tmp_path):
    records = evidence_of(driven(tmp_path, (2.5, 1.7, 0.01))).fit
    for record in records:
        record.inputs.clear()
    assert driven_mode(records, 0.0) is None


@pytest.mark.slow
def test_a_braked_load_behind_a_soft_shaft_is_named_with_what_brakes_it(tmp_path):
    content = explain(driven(tmp_path, (2.5, 0.6, 0.01, 12.0), "velocity", noise=10 * NOISE)).content
    (cause,) = content["causes"]
    assert (content["verdict"], cause["name"]) == ("explained", "second_mode")
    for name, true, tolerance in (("frequency", 2.5, 0.05), ("mass_ratio", 0.6, 0.1), ("drag_rate", 12.0, 0.1)):
        low, high = cause["parameters"][name]["interval95"]
        assert low < true < high
        assert cause["parameters"][name]["value"] == pytest.approx(true, rel=tolerance)


@pytest.mark.parametrize("mode", [pytest.param((2.5, 1.7, 0.01), marks=pytest.mark.slow), None])
def test_a_beam_on_a_motor_is_named_and_a_motor_alone_is_not(tmp_path, mode):
    content = explain(driven(tmp_path, mode, noise=10 * NOISE)).content
    if mode is None:
        assert (content["verdict"], content["causes"]) == ("consistent", [])
        return
    (cause,) = content["causes"]
    assert (content["verdict"], cause["name"]) == ("explained", "second_mode")
    for name, true, tolerance in (("frequency", 2.5, 0.02), ("mass_ratio", 1.7, 0.05)):
        low, high = cause["parameters"][name]["interval95"]
        assert low < true < high
        assert cause["parameters"][name]["value"] == pytest.approx(true, rel=tolerance)
