"""Noise of a measured load: taken out where it stands above the load's content, and nothing else with it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import torch

from gear_damping.explanation.evidence.input_noise import error_of_load, expected_load, without_input_noise
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.steps import calibrate
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.identification.output_error.segments import Segments
from gear_damping.physics.systems.traits import Trait

SAMPLES, RATE, NOISE = 2000, 200.0, 0.1
RANDOM = np.random.default_rng(5)


def load(stamps):
    """Twelve lines below 12 Hz that do not fit the record, of variance 6."""
    lines = np.linspace(1.03, 11.7, 12)
    phases = np.linspace(0, 50, 12)
    return np.cos(2 * np.pi * np.multiply.outer(stamps / RATE, lines) + phases).sum(1)


def warped(samples, drift):
    """Instants in mean intervals of a clock whose rate falls from so much too fast to so much too slow."""
    place = np.linspace(0, 1, samples)
    return (samples - 1) * (place - 2 * drift * place * (1 - place))


def record(series, held=(), stamps=None):
    response = torch.as_tensor(RANDOM.normal(size=SAMPLES))
    return FitRecord("run", response, RATE, {"force": torch.as_tensor(series)}, held=held, stamps=stamps)


@pytest.mark.parametrize("drift", [0.0, 0.05])
def test_most_of_the_noise_goes_and_the_load_stays(drift):
    """However uneven the stamps of the samples are: a load is known at even instants."""
    true = load(np.arange(SAMPLES))
    stamps = torch.as_tensor(warped(SAMPLES, drift)) if drift else None
    measured = true + NOISE * RANDOM.normal(size=SAMPLES)
    (found,) = without_input_noise([record(measured, stamps=stamps)])
    error = found.inputs["force"].numpy() - true
    assert np.std(error) < 0.55 * NOISE  # 12 lines of 5 each and their feet, of 1000
    assert abs(np.dot(error, true)) / np.dot(true, true) < 0.005  # and no share of the load is lost


def test_every_line_is_weighed_by_its_signal_over_all_of_it():
    rows = np.arange(SAMPLES)
    true = load(rows)
    lines, floor = np.fft.rfft(true - np.linspace(true[0], true[-1], SAMPLES)), 0.25
    slow = np.zeros(len(lines), dtype=complex)
    for k in range(len(lines)):
        near = [min(max(k + d, 0), len(lines) - 1) for d in (-2, -1, 0, 1, 2)]
        power = np.mean([abs(lines[n]) ** 2 for n in near])
        slow[k] = lines[k] * max(0.0, 1 - floor * SAMPLES / power)
    expected = np.linspace(true[0], true[-1], SAMPLES) + np.fft.irfft(slow, SAMPLES)
    np.testing.assert_allclose(expected_load(true, floor), expected, atol=1e-9)


def test_a_load_that_is_white_itself_is_left_alone():
    assert without_input_noise([record(RANDOM.normal(size=SAMPLES))]) is None


def test_a_load_that_is_held_was_commanded():
    measured = load(np.arange(SAMPLES)) + NOISE * RANDOM.normal(size=SAMPLES)
    assert without_input_noise([record(measured, held=("force",))]) is None


def test_a_load_without_noise_is_left_alone():
    assert without_input_noise([record(load(np.arange(SAMPLES)))]) is None


def test_what_a_load_is_expected_wrong_by_is_what_it_is_wrong_by():
    """Of many draws, lag by lag: most of the noise that is left lies where the load is, below 13 Hz."""
    found, expected, lags = 0.0, 0.0, 12
    wide = np.convolve(RANDOM.normal(size=SAMPLES + 30), np.hanning(31), "valid")[:SAMPLES]
    for _ in range(40):
        measured = wide + NOISE * RANDOM.normal(size=SAMPLES)
        error = expected_load(measured, NOISE**2) - wide
        found = found + np.array([np.mean(error[lag:] * error[: SAMPLES - lag]) for lag in range(lags)]) / 40
        expected = expected + error_of_load(measured, NOISE**2)[:lags] / 40
    np.testing.assert_allclose(found / found[0], expected / expected[0], atol=0.12)
    assert expected[0] == pytest.approx(found[0], rel=0.15)


def test_all_of_a_steady_torque_may_be_the_noise_of_its_meter():
    """It has no content of its own; an angle beside it is no load, and stays as it was read."""
    torque = 12 + NOISE * RANDOM.normal(size=SAMPLES)
    angle = 40 * np.arange(SAMPLES) / RATE + 1e-4 * RANDOM.normal(size=SAMPLES)
    inputs = {"pinion_torque": torch.as_tensor(torque), "pinion_angle": torch.as_tensor(angle)}
    measured = FitRecord("run", torch.as_tensor(RANDOM.normal(size=SAMPLES)), RATE, inputs)
    assert without_input_noise([measured]) is None
    (found,) = without_input_noise([measured], is_torque=True)
    assert float(found.inputs["pinion_torque"].std()) < 0.1 * NOISE  # less would not shake a resonance either
    assert float(found.inputs["pinion_torque"].mean()) == pytest.approx(12, abs=0.02)
    assert torch.equal(found.inputs["pinion_angle"], inputs["pinion_angle"])


def test_a_line_of_a_torque_stays_and_so_does_a_weak_and_wide_content_that_many_lines_show_together():
    """Of a tenth of the noise's size over a tenth of the band: no five lines of it tell it from noise."""
    random, size = np.random.default_rng(9), 40_000
    line = 2 * NOISE * np.sin(0.7 * np.arange(size))
    spectrum = np.fft.rfft(random.normal(size=size))
    spectrum[np.arange(len(spectrum)) > 0.1 * len(spectrum)] = 0.0
    wide = NOISE * np.fft.irfft(2 * spectrum, size)  # four times the power of the noise there
    found = expected_load(line + wide + NOISE * random.normal(size=size), NOISE**2, is_torque=True)
    assert np.dot(found, line) / np.dot(line, line) == pytest.approx(1.0, abs=0.01)
    assert 0.7 < np.dot(found, wide) / np.dot(wide, wide) < 0.82  # 4/5 of it, if its power were known
    assert np.std(found - line - wide) < 0.35 * NOISE  # sqrt(.1 * .8): the noise in that tenth of the band
    weak = expected_load(0.35 * wide + NOISE * random.normal(size=size), NOISE**2, is_torque=True)
    assert 0.05 < np.dot(weak, wide) / np.dot(wide, wide) < 0.35 * 0.36  # of 1/3 of it; five lines alone show none


@pytest.mark.parametrize("moves", [True, False])
def test_a_gear_pair_is_driven_by_torques_without_noise_unless_it_moves_with_it(moves, monkeypatch):
    """A made-up calibration before, and one after."""
    record = FitRecord("run", torch.zeros(8), RATE, {"pinion_torque": torch.ones(8)})
    quiet = replace(record, inputs={"pinion_torque": torch.zeros(8)})
    evidence = Evidence("gear_pair", (record,), (), {}, None, one_record=False)
    before, after = SimpleNamespace(hypothesis=None), SimpleNamespace(hypothesis=None, is_finite=True)
    monkeypatch.setattr(calibrate, "_gear_pair", lambda one, solver: calibrate.Calibration(one, before))
    monkeypatch.setattr(calibrate, "is_standing", lambda one: False)
    monkeypatch.setattr(calibrate, "without_input_noise", lambda records, is_torque: (quiet,) if is_torque else None)
    monkeypatch.setattr(calibrate, "InitialValues", lambda **_: None)
    monkeypatch.setattr(calibrate, "fit_hypothesis", lambda *_, **__: after)
    monkeypatch.setattr(calibrate, "moves_with_noise", lambda *_: moves)
    monkeypatch.setattr(calibrate, "is_overdamped", lambda *_: False)
    found = calibrate.NOMINAL[Trait.TEETH](evidence, None)
    assert found.nominal is (before if moves else after)
    assert found.evidence.fit[0] is (record if moves else quiet)
    assert found.evidence.input_noise is not moves


@pytest.mark.parametrize(
    ("loud", "quiet", "is_quiet"), [(True, False, False), (False, True, True), (False, False, False)]
)
def test_a_model_that_runs_away_is_compared_with_none(loud, quiet, is_quiet, monkeypatch):
    """What residuals without an end would give is no comparison, and a warning of numpy."""
    measured, cleaned = SimpleNamespace(), SimpleNamespace()
    fitted = {id(measured): SimpleNamespace(is_finite=loud), id(cleaned): SimpleNamespace(is_finite=quiet)}
    monkeypatch.setattr(calibrate, "_oscillator", lambda one, _: fitted[id(one)])
    monkeypatch.setattr(calibrate, "_with_quiet_loads", lambda _: cleaned)
    monkeypatch.setattr(calibrate, "moves_with_noise", lambda *_: pytest.fail("compared"))
    found = calibrate.NOMINAL[Trait.REST](measured, None)
    assert (found.evidence is cleaned) == is_quiet


def test_a_driven_rig_is_calibrated_at_uneven_stamps_in_segments_as_at_even_ones():
    """A drive whose clock slows down: each segment is driven by the load of its own time."""
    rate, gain, damping, size = 200.0, 30.0, 5.0, 4000
    random, even = np.random.default_rng(11), np.arange(size)
    stamps = warped(size, 0.05)
    lines, phases = np.linspace(0.31, 6.3, 9), np.linspace(0, 40, 9)

    def waves(at, answer):
        angle = 2 * np.pi * np.multiply.outer(at / rate, lines) + phases
        return np.real(np.exp(1j * angle) @ answer)

    velocity = waves(stamps, gain / (damping + 2j * np.pi * lines)) + 0.02 * random.normal(size=size)
    force = waves(even, np.ones(9)) + NOISE * random.normal(size=size)
    measured = FitRecord(
        "run", torch.as_tensor(velocity), rate, {"force": torch.as_tensor(force)}, observed=Observed("velocity"),
        stamps=torch.as_tensor(stamps),
    )  # fmt: skip
    evidence = Evidence(
        "oscillator",
        (measured,),
        (),
        Known({"stiffness": 0.0}, {}),
        None,
        one_record=True,
        noise=0.02,
        segments=Segments(2.0),
    )
    found = calibrate.calibrated(evidence, None).nominal
    assert found.values["viscous_damping.damping_coefficient"] == pytest.approx(damping, rel=0.02)
    assert found.values["force_gain"] == pytest.approx(gain, rel=0.02)
