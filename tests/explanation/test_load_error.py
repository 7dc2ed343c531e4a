"""The error of a measured load behind an oscillator, against an integrator and the covariance of many draws."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.linalg import cholesky, solve_triangular
from scipy.signal import firwin, lfilter, lsim

from gear_damping.explanation.evidence.noise import NoiseLevel
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.statistics.load_error import KnownError, Linear, load_error, moved_by
from gear_damping.explanation.steps.calibrate import calibrated
from gear_damping.explanation.trials.assess import assessed
from gear_damping.explanation.trials.innovations import load_errors
from gear_damping.explanation.trials.noisy_load import moves_with_noise
from gear_damping.explanation.trials.random_part import Random
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord, Observed

STIFFNESS, DAMPING, RATE, SAMPLES = (2 * np.pi * 10) ** 2, 2.5, 120.0, 700
TAPS = firwin(41, 0.4)  # below 24 Hz
SENSOR, POLE = 3e-4, 0.5
FINER = 8


def error_autocovariance():
    """Of white noise of unit variance behind the filter."""
    full = np.correlate(TAPS, TAPS, "full")[len(TAPS) - 1 :]
    return np.concatenate([full, np.zeros(SAMPLES - len(full))])


def shown_motion(push, stamps, derivatives=0, damping=DAMPING):
    """What an integrator gives for a load that goes in a line from sample to sample, after it has settled."""
    rest = 900  # samples before the record, over which the start dies away
    time = np.arange(len(push)) / RATE
    fine = np.arange(FINER * (len(push) - 1) + 1) / (RATE * FINER)
    rates = np.array([[0.0, 1.0], [-STIFFNESS, -damping]])
    system = (rates, [[0.0], [1.0]], np.eye(2), np.zeros((2, 1)))
    load = np.interp(fine, time, push)
    _, states, _ = lsim(system, load, fine)
    series = (states[:, 0], states[:, 1], states @ rates[1] + load)[derivatives]
    return np.interp(rest / RATE + stamps, fine, series)


def drawn(seed, derivatives=0, jitter=0.0):
    """A residual (time,) and its stamps in s: the motion that a band of noise makes, behind a coloured sensor."""
    random = np.random.default_rng(seed)
    stamps = (np.arange(SAMPLES) + jitter * random.uniform(-1, 1, SAMPLES)) / RATE
    push = lfilter(TAPS, 1, random.normal(size=SAMPLES + 960))
    sensor = lfilter([1], [1, -POLE], SENSOR * random.normal(size=SAMPLES + 50))[50:]
    return shown_motion(push, stamps, derivatives) + sensor, stamps


def known(stamps, derivatives=0):
    motion, interval = moved_by(error_autocovariance(), Linear(1.0, DAMPING, STIFFNESS, derivatives), 1 / RATE)
    return KnownError(stamps, motion, interval, SENSOR**2)


SLOW = pytest.mark.slow


@pytest.mark.parametrize("derivatives", [pytest.param(0, marks=SLOW), 1, pytest.param(2, marks=SLOW)])
def test_the_motion_is_that_of_an_integrator(derivatives):
    random, lags = np.random.default_rng(2), 60
    found = np.zeros(lags)
    for _ in range(12):
        push = lfilter(TAPS, 1, random.normal(size=9000))
        seen = shown_motion(push, np.arange(8000) / RATE, derivatives)
        found += [np.mean(seen[lag:] * seen[: len(seen) - lag]) for lag in range(lags)]
    motion, interval = moved_by(error_autocovariance(), Linear(1.0, DAMPING, STIFFNESS, derivatives), 1 / RATE)
    finer = round(1 / RATE / interval)
    np.testing.assert_allclose(motion[: lags * finer : finer] / motion[0], found / found[0], atol=0.06)
    assert motion[0] == pytest.approx(found[0] / 12, rel=0.1)


@pytest.mark.parametrize("jitter", [0.0, 0.3])
def test_what_is_random_becomes_white_and_is_that_of_its_covariance(jitter):
    seen, stamps = drawn(3, jitter=jitter)
    part = load_error(seen, known(stamps))
    white = part.innovations(seen[:, None])[:, 0]
    correlations = [abs((white[lag:] * white[:-lag]).mean()) for lag in range(1, 30)]
    assert max(correlations) < 4 / SAMPLES**0.5
    assert part.sensor == pytest.approx(SENSOR**2 / (1 - POLE**2), rel=0.2)
    apart = np.abs(stamps[:, None] - stamps[None, :])
    decay, turn = DAMPING / 2, np.sqrt(STIFFNESS - DAMPING**2 / 4)  # flat noise as wide as the resonance: a ring
    size = 1 / RATE / (2 * DAMPING * STIFFNESS)
    ring = size * np.exp(-decay * apart) * (np.cos(turn * apart) + decay / turn * np.sin(turn * apart))
    numbers = np.arange(SAMPLES)
    sensor = SENSOR**2 / (1 - POLE**2) * POLE ** np.abs(numbers[:, None] - numbers[None, :])
    expected = solve_triangular(cholesky(ring + sensor, lower=True), seen, lower=True)
    assert np.corrcoef(white[20:], expected[20:])[0, 1] > 0.98


def test_it_is_likelier_than_a_white_sensor_only_where_it_is_there():
    seen, stamps = drawn(4)
    quiet = SENSOR * np.random.default_rng(5).normal(size=SAMPLES)
    of_white = [(SAMPLES - 2) * np.log(np.mean(series[2:] ** 2)) for series in (seen, quiet)]
    found = [load_error(series, known(stamps)).deviance for series in (seen, quiet)]
    assert found[0] < of_white[0] - 300
    assert found[1] > of_white[1]


def rig(is_in_motion, highest, noise=0.3, count=4, damping=DAMPING, seed=7, samples=SAMPLES):
    """Records of an oscillator whose load of lines up to so many Hz was measured with noise, or that moves with it."""
    random, rows = np.random.default_rng(seed), np.arange(samples + 960)
    phases, lines = random.uniform(0, 7, (count, 12)), np.linspace(0.7, highest, 12)
    records = []
    for i in range(count):
        true = (1 + i) * np.cos(2 * np.pi * np.multiply.outer(rows / RATE, lines) + phases[i]).sum(1)
        seen = true + (1 + i) * noise * random.normal(size=len(rows))
        moved = shown_motion(seen if is_in_motion else true, np.arange(samples) / RATE, damping=damping)
        moved = moved + SENSOR * random.normal(size=samples)
        force = torch.as_tensor(seen[900 : 900 + samples])
        records.append(FitRecord(f"run {i}", torch.as_tensor(moved), RATE, {"force": force}, observed=Observed()))
    known = Known({}, {})
    return Evidence("oscillator", tuple(records[:-1]), (records[-1],), known, None, one_record=False, noise=SENSOR)


def test_noise_that_an_oscillator_moves_with_stays_in_its_load():
    assert not calibrated(rig(is_in_motion=True, highest=6.0)).evidence.input_noise


@pytest.mark.parametrize("seed", [4, 11, 12])
def test_noise_of_the_sensor_of_a_load_is_none_though_a_few_blocks_of_a_narrow_resonance_like_it(seed):
    """It rings for as long as a record lasts, so that its blocks hang together."""
    light = rig(is_in_motion=False, highest=17.0, damping=0.5, seed=seed, samples=250)
    assert calibrated(light).evidence.input_noise


@pytest.mark.slow
def test_where_the_error_of_a_load_is_unknown_blocks_of_the_residual_decide():
    evidence = rig(is_in_motion=False, highest=6.0, count=3)
    found = calibrated(evidence)
    series = [residual.clone() for residual in found.nominal.fit_residuals]
    less = replace(found.nominal, fit_residuals=[0.5 * one for one in series])
    bare = replace(evidence, fit=tuple(replace(record, input_errors={}) for record in evidence.fit))
    assert moves_with_noise(less, found.nominal, bare)
    assert not moves_with_noise(found.nominal, less, bare)


def test_a_record_that_was_not_fitted_has_the_error_of_its_load_whatever_colour_the_others_are_taken_for():
    groups, level = torch.zeros(1, 1), NoiseLevel({"fitted": 0.1, "held": 0.1}, "floor", 1e9, agree=True)
    coloured = Random((), groups, 0.04, 1.0, {"fitted": 0.04}, errors={"fitted": 0.5, "held": 0.25})
    assert coloured.joined(level).by_record == pytest.approx({"fitted": 0.2, "held": 0.5})


@pytest.mark.parametrize(("parts", "held"), [((0.3, 0.6), 1.2), ((0.5, 0.5), 0.5)])
def test_coloured_noise_that_goes_with_the_floors_does_so_in_records_that_were_not_fitted(parts, held):
    level = NoiseLevel({"a": 0.1, "b": 0.2, "held": 0.4}, "floor", 1e9, agree=True)
    own = {name: part**2 for name, part in zip("ab", parts, strict=True)}
    coloured = Random((), torch.zeros(1, 1), sum(own.values()) / 2, 1.0, own)
    assert coloured.joined(level).by_record["held"] == pytest.approx(held)


def test_the_error_of_a_load_is_no_effect_and_is_expected_in_records_that_were_not_fitted():
    found = calibrated(rig(is_in_motion=False, highest=17.0))
    assert found.evidence.input_noise
    seen = assessed(found.nominal, [], found.evidence)
    assert seen.visible.p > 0.01
    assert len(seen.random.loads) == 3
    assert seen.random.sensor**0.5 == pytest.approx(SENSOR, rel=0.2)
    left = float(found.nominal.left_out[0].square().mean())
    names = [record.name for record in found.evidence.records]
    noise = seen.random.joined(NoiseLevel(dict.fromkeys(names, SENSOR), "floor", 1e9, agree=True))
    assert 0.3 < left / noise.by_record["run 3"] ** 2 < 1.5  # the start of the record takes a part
    assert noise.by_record["run 3"] > 1.5 * noise.by_record["run 0"]  # its load and with it the error is larger
    assert set(load_errors(found.nominal, found.evidence.records)) == set(names)
