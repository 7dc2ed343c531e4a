"""The bound against that of a damped cosine in closed form, and against what many fits of it scatter by."""

import math

import numpy as np
import pytest
import torch
from scipy.optimize import least_squares

import gear_damping as gd
from gear_damping.identification.cramer_rao import covariance, cramer_rao

STIFFNESS, DAMPING, RATE, SAMPLES, NOISE = (2 * math.pi * 15) ** 2, 4.0, 500.0, 400, 2e-4
START = (0.01, -0.3)
OF_DAMPING = ["stiffness", "viscous_damping.damping_coefficient"]


def path(stiffness, damping, displacement, velocity, samples=SAMPLES):
    """A free decay in closed form; complex arguments are welcome."""
    time = np.arange(samples) / RATE
    decay, turn = damping / 2, np.sqrt(stiffness - damping**2 / 4)
    sine = (velocity + decay * displacement) / turn
    return np.exp(-decay * time) * (displacement * np.cos(turn * time) + sine * np.sin(turn * time))


def closed_form(samples=SAMPLES, prior=None):
    """Covariance of (stiffness, damping, x0, v0) by complex steps through the closed form."""
    truth = np.array([STIFFNESS, DAMPING, *START], dtype=complex)
    slopes = [path(*(truth + 1e-20j * scale * np.eye(4)[i]), samples).imag / (1e-20 * scale) for i, scale in
              enumerate((STIFFNESS, DAMPING, 1.0, 1.0))]  # fmt: skip
    information = np.array(slopes) @ np.array(slopes).T / NOISE**2
    return np.linalg.inv(information + np.diag(1 / np.square(prior if prior else [np.inf] * 4)))


@pytest.fixture(scope="module")
def decay():
    model = gd.Model(gd.Oscillator(stiffness=STIFFNESS), [gd.ViscousDamping(damping_coefficient=DAMPING)])
    values = {"initial_displacement": [START[0], 2 * START[0]], "initial_velocity": [START[1], 2 * START[1]]}
    return gd.simulate(model, sampling_rate=RATE, n_samples=SAMPLES, batch=2, **values)


def test_it_is_that_of_a_damped_cosine(decay):
    found = cramer_rao(decay.runs, OF_DAMPING, torch.tensor(NOISE))
    expected = np.sqrt(np.diag(closed_form()))
    np.testing.assert_allclose(found.covariance[0].diagonal().sqrt(), expected, rtol=1e-4)
    np.testing.assert_allclose(found.deviation("stiffness"), [expected[0], expected[0] / 2], rtol=1e-4)
    correlation = found.covariance[0, 0, 1] / found.covariance[0, 0, 0].sqrt() / found.covariance[0, 1, 1].sqrt()
    exact = closed_form()
    assert float(correlation) == pytest.approx(exact[0, 1] / math.sqrt(exact[0, 0] * exact[1, 1]), abs=1e-3)


def test_fewer_samples_and_what_is_known_beforehand(decay):
    prior = [math.inf, math.inf, 1e-6, 1e-4]
    known = {"initial_displacement": 1e-6, "initial_velocity": 1e-4}
    found = gd.bound(decay, OF_DAMPING, noise=NOISE, samples=90, expected=known)
    expected = np.sqrt(np.diag(closed_form(90, prior)))
    for name, value in zip((*OF_DAMPING, *known), expected, strict=True):
        assert found[name][0] == pytest.approx(value, rel=1e-4)
    assert found["stiffness"][0] < gd.bound(decay, OF_DAMPING, noise=NOISE, samples=90)["stiffness"][0]


def test_a_damping_ratio_is_in_percent(decay):
    ratio = gd.bound(decay, ["damping_ratio", "stiffness"], snr_db=30)["damping_ratio"][0]
    level = decay.displacement[0].std(ddof=1) * 10**-1.5
    expected = 100 * math.sqrt(closed_form()[1, 1]) * level / NOISE / (2 * math.sqrt(STIFFNESS))
    assert ratio == pytest.approx(expected, rel=1e-3)


def test_fits_scatter_by_it(decay):
    """300 records of one truth: the variance of 300 draws is known within a sixteenth of itself, twice."""
    bound = gd.bound(decay, OF_DAMPING, noise=NOISE)["viscous_damping.damping_coefficient"][0]
    random, clean, found = np.random.default_rng(4), path(STIFFNESS, DAMPING, *START), []
    scale = np.array([STIFFNESS, DAMPING, *START])
    for _ in range(300):
        seen = clean + NOISE * random.normal(size=SAMPLES)
        fit = least_squares(lambda z, seen=seen: (path(*(scale * z)) - seen) / NOISE, np.ones(4))
        found.append(DAMPING * fit.x[1])
    assert np.std(found) == pytest.approx(bound, rel=0.12)


def test_of_a_gear_pair_more_unknowns_are_known_less():
    model = gd.Model(gd.GearPair(pinion_speed=480.0), [gd.FourierMeshStiffness(), gd.PowerLawDamping(exponent=2)])
    runs = gd.simulate(model, sampling_rate=40e3, n_samples=800)
    alone = gd.bound(runs, snr_db=30)["damping_ratio"][0]
    beside = gd.bound(runs, ["damping_ratio", "power_law_damping.exponent"], snr_db=30)["damping_ratio"][0]
    assert beside > 2 * alone
    assert gd.bound(runs, snr_db=10)["damping_ratio"][0] == pytest.approx(10 * alone, rel=1e-6)


@pytest.mark.parametrize(
    ("free", "more", "said"),
    [
        (["stifness"], {"snr_db": 30}, "did you mean 'stiffness'"),
        (["initial_velocity"], {"snr_db": 30}, "no such parameter"),
        (["stiffness"], {"noise": -1.0}, "must be positive"),
        (["stiffness"], {"noise": 1.0, "expected": {"stifness": 1.0}}, "is not among what is unknown"),
        (["stiffness"], {"noise": 1.0, "samples": 99999}, "must lie within 2 and 400"),
        (["damping_ratio", "viscous_damping.damping_coefficient"], {"noise": 1.0}, "names one parameter twice"),
        (["damping_ratio"], {}, "one of noise and snr_db is needed"),
        (["damping_ratio"], {"snr_db": 30, "noise": 1e-6}, "one of noise and snr_db is needed"),
    ],
)
def test_what_is_wrong_is_said(decay, free, more, said):
    with pytest.raises(gd.InputError, match=said):
        gd.bound(decay, free, **more)


def test_two_laws_have_no_ratio_of_their_own():
    laws = [gd.ViscousDamping(damping_coefficient=1.0), gd.PowerLawDamping(coefficient=1.0)]
    runs = gd.simulate(gd.Model(gd.Oscillator(stiffness=100.0), laws), sampling_rate=50, n_samples=50)
    with pytest.raises(gd.InputError, match="the model has 2 damping laws"):
        gd.bound(runs, snr_db=20)


def test_two_slopes_that_are_one_but_for_rounding_have_no_bound():
    """Squared, their difference is lost: an inverse held millions or nan, one on each machine."""
    generator = np.random.default_rng(3)
    first, other = generator.normal(size=300), generator.normal(size=300)
    for difference, told in ((1e-10, False), (1e-6, True)):
        columns = torch.tensor(np.stack([first, 2 * first + difference * generator.normal(size=300), other], -1))[None]
        found = covariance(columns, torch.zeros(3, dtype=torch.float64))[0].diagonal()
        assert bool(torch.isfinite(found[:2]).all()) == told
        share = other - first * (first @ other) / (first @ first)
        assert float(found[2]) == pytest.approx(1 / float(share @ share), rel=0.02)
