"""What records show of a motion, through any channel, at any rate and zero, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.signal import bilinear, butter, lfilter

from gear_damping.identification.observation import Known
from gear_damping.identification.oscillator.fit import fit_oscillator
from gear_damping.identification.output_error.observe import interpolation
from gear_damping.identification.output_error.records import Filter, FitRecord, Observed

OMEGA, RATIO = 2 * math.pi * 3.0, 0.02
DAMPED, DECAY = OMEGA * math.sqrt(1 - RATIO**2), RATIO * OMEGA
SHOWN = {"displacement": 0, "velocity": 1, "acceleration": 2}


def motion(time, order, turn=0.3):
    """A derivative of exp(-d t) cos(w t + turn), by its complex form."""
    root = complex(-DECAY, DAMPED)
    return (root**order * np.exp(root * time + 1j * turn)).real


def record(name, rate, channel="displacement", turn=0.3, offset=0.0, seconds=4.0, time=None, **observed):
    time = np.arange(round(seconds * rate)) / rate if time is None else time
    values = torch.as_tensor(motion(time, SHOWN[channel], turn) + offset)
    return FitRecord(name, values, rate, observed=Observed(channel, offset=True, **observed))


def found(*records, **options):
    fit = fit_oscillator(records, **options)
    return fit, fit.natural_frequency_hz.value * 2 * math.pi, fit.damping_ratio_percent.value / 100


@pytest.mark.parametrize("channel", SHOWN)
@pytest.mark.parametrize("offset", [0.0, 7.0])
def test_any_channel_alone_whatever_its_zero(channel, offset):
    fit, omega, ratio = found(record("a", 100.0, channel, offset=offset))
    assert omega == pytest.approx(OMEGA, rel=1e-5)
    assert ratio == pytest.approx(RATIO, rel=1e-3)
    assert fit.own[f"offset.{channel}@a"] == pytest.approx(offset, abs=1e-4 * OMEGA ** SHOWN[channel])


def test_records_of_different_rates_and_zeros_are_one_fit():
    records = [record(str(rate), rate, turn=rate, offset=rate) for rate in (50.0, 83.3, 125.0)]
    fit, omega, ratio = found(*records)
    assert (omega, ratio) == (pytest.approx(OMEGA, rel=1e-6), pytest.approx(RATIO, rel=1e-4))
    assert max(float(left.abs().max()) for left in fit.residuals.values()) < 1e-5
    assert fit.own["offset.displacement@83.3"] == pytest.approx(83.3, abs=1e-5)


def test_two_channels_together_tell_of_one_motion():
    first = record("a", 100.0)
    second = Observed("acceleration", offset=True, scale=1 / OMEGA**2), torch.as_tensor(motion(np.arange(400) / 100, 2))
    fit, omega, ratio = found(replace(first, others=(second,)))
    assert (omega, ratio) == (pytest.approx(OMEGA, rel=1e-6), pytest.approx(RATIO, rel=1e-4))
    assert len(fit.residuals["a"]) == 800
    wrong = second[0], 1.2 * second[1]  # not the acceleration of this displacement: it has to show
    spoilt, _, _ = found(replace(first, others=(wrong,)))
    assert float(spoilt.residuals["a"].abs().max()) > 100 * float(fit.residuals["a"].abs().max())


def test_stamps_that_jitter_are_fitted_at_their_stamps():
    rate, generator = 40.0, np.random.default_rng(0)
    positions = np.arange(200) + 0.07 * generator.standard_normal(200)
    positions[0], positions[-1] = 0.0, 199.0
    jittered = replace(record("a", rate, time=positions / rate), stamps=torch.as_tensor(positions))
    fit, omega, ratio = found(jittered)
    assert (omega, ratio) == (pytest.approx(OMEGA, rel=1e-5), pytest.approx(RATIO, rel=1e-3))
    evenly, _, _ = found(replace(jittered, stamps=None))
    assert fit.rmse["fit"] < 1e-3 * evenly.rmse["fit"]


def test_a_declared_delay_is_part_of_the_prediction():
    delay = 0.013
    late = record("a", 200.0, turn=0.3 - DAMPED * delay, delay=delay)
    late = replace(late, response=late.response * math.exp(DECAY * delay))
    fit, omega, _ = found(late)
    assert omega == pytest.approx(OMEGA, rel=1e-5)
    assert float(fit.residuals["a"][5:].abs().max()) < 1e-5


@pytest.mark.parametrize("high", [False, True])
def test_a_declared_filter_begins_in_any_state(high):
    """scipy's bilinear filter at a rate at which its warping does not matter, begun long before the record."""
    rate, corner, order = 2000.0, 5.0, 2
    time = np.arange(-4000, 8000) / rate
    analog = butter(order, 2 * math.pi * corner, "high" if high else "low", analog=True)
    passed = lfilter(*bilinear(*analog, fs=rate), motion(time, 0))[4000::10]
    seen = Observed(offset=False, filters=(Filter(corner, order, high),))
    fit, omega, ratio = found(FitRecord("a", torch.as_tensor(passed.copy()), rate / 10, observed=seen))
    assert omega == pytest.approx(OMEGA, rel=1e-3)
    assert ratio == pytest.approx(RATIO, rel=2e-2)
    assert float(fit.residuals["a"].abs().max()) < 2e-3 * float(fit.predictions["a"].abs().max())


def test_what_is_stated_with_an_uncertainty_is_an_expectation():
    """Where the record says little, the statement counts; where it says much, the record does."""
    noisy = record("a", 100.0, seconds=0.5)
    generator = torch.Generator().manual_seed(0)
    noisy = replace(noisy, response=noisy.response + 0.3 * torch.randn(50, generator=generator, dtype=torch.float64))
    stated = {"stiffness": OMEGA**2, "damping_coefficient": 2 * RATIO * OMEGA}
    free, _, _ = found(noisy, known=Known(stated, {}))
    bound, _, _ = found(noisy, known=Known(stated, {"damping_coefficient": 0.01}))
    off = [abs(f.parameters["damping_coefficient"].value / stated["damping_coefficient"] - 1) for f in (free, bound)]
    assert off[1] < 0.05 < off[0]


def test_the_polynomial_between_samples_is_exact_for_its_degree():
    positions = torch.tensor([0.0, 0.31, 5.5, 17.77, 19.0], dtype=torch.float64)
    places, weights = interpolation(positions, 20)
    cubed = torch.arange(20, dtype=torch.float64) ** 3
    torch.testing.assert_close((cubed[places] * weights).sum(1), positions**3, rtol=1e-9, atol=1e-9)
