"""`gd.evaluate`: several estimators on the same noisy runs, their figures worked out again by numpy."""

import math

import numpy as np
import pytest

import gear_damping as gd

RATE, OMEGA = 500.0, 40.0
RATIOS = np.linspace(0.5, 2.0, 24)  # % of critical


@pytest.fixture(scope="module")
def runs():
    """Decays of a linear oscillator."""
    model = gd.Model(gd.Oscillator(stiffness=OMEGA**2), [gd.ViscousDamping()])
    coefficients = 2 * RATIOS / 100 * OMEGA
    given = {"viscous_damping.damping_coefficient": coefficients, "initial_displacement": 1e-2}
    return gd.simulate(model, sampling_rate=RATE, n_samples=1000, batch=len(RATIOS), **given)


@pytest.fixture(scope="module")
def found(runs):
    asked = {"fit": gd.estimator("output_error"), "decrement": gd.estimator("log_decrement")}
    return gd.evaluate(asked, runs, snr_db=[30, 20])


def closed_form_limit(snr_db):
    """Standard deviation of the ratio in % behind white noise, by the slopes of the decay in closed form."""
    limits, time = [], np.arange(1000) / RATE
    for ratio in RATIOS / 100:

        def decay(z, x0, v0):
            w = OMEGA * math.sqrt(1 - z * z)
            return np.exp(-z * OMEGA * time) * (x0 * np.cos(w * time) + (v0 + z * OMEGA * x0) / w * np.sin(w * time))

        at, steps = (ratio, 1e-2, 0.0), (1e-6, 1e-7, 1e-5)
        slopes = []
        for place, step in enumerate(steps):
            up, down = list(at), list(at)
            up[place] += step
            down[place] -= step
            slopes.append((decay(*up) - decay(*down)) / (2 * step))
        jacobian = np.array(slopes).T
        noise = decay(*at).std() * 10 ** (-snr_db / 20)
        limits.append(100 * noise * math.sqrt(np.linalg.inv(jacobian.T @ jacobian)[0, 0]))
    return math.sqrt(np.mean(np.square(limits)))


def test_the_bound_is_that_of_the_decay(found):
    for snr, level in found.content["snr_db"].items():
        assert level["bound_percent"] == pytest.approx(closed_form_limit(float(snr)), rel=1e-3)


def test_what_fits_the_equation_comes_near_the_bound(found):
    """24 runs: an efficient estimate scatters by a seventh about a ratio of one."""
    for level in found.content["snr_db"].values():
        fit = level["estimators"]["fit"]
        assert 0.6 < fit["ratio_to_bound"] < 1.7
        assert fit["answered"] == len(RATIOS)
        assert fit["rmse_percent"] < level["estimators"]["decrement"]["rmse_percent"] < 0.3


def test_who_knows_nothing_says_the_mean(found):
    for level in found.content["snr_db"].values():
        nothing = level["estimators"]["mean"]
        assert nothing["rmse_percent"] == pytest.approx(np.std(RATIOS))
        assert nothing["skill"] == pytest.approx(0, abs=1e-12)
        assert nothing["coverage90"] is None


def test_more_noise_more_error_and_the_same_seed_the_same_table(found, runs):
    low, high = (found.content["snr_db"][snr]["estimators"]["fit"]["rmse_percent"] for snr in ("30", "20"))
    assert high > 2 * low
    again, other = (
        gd.evaluate({"fit": gd.estimator("output_error")}, runs, snr_db=[30], bound=False, seed=seed) for seed in (0, 1)
    )
    same, else_ = (one.content["snr_db"]["30"]["estimators"]["fit"]["rmse_percent"] for one in (again, other))
    assert same == low != else_
    assert again.content["snr_db"]["30"]["bound_percent"] is None


def test_the_table_and_the_picture_name_every_estimator(found):
    assert all(f"`{name}`" in found.table() for name in ("fit", "decrement", "mean"))
    labels = {text.get_text() for text in found.plot().axes[0].get_legend().get_texts()} or {
        text.get_text() for text in found.plot().legends[0].get_texts()
    }
    assert {"fit", "decrement", "mean", "bound"} <= labels


def test_a_record_that_does_not_suit_is_counted_and_not_scored(runs):
    """Runs of a few samples hold no decay."""
    short = gd.simulate(runs.model, sampling_rate=RATE, n_samples=12, batch=3, initial_displacement=1e-2)
    found = gd.evaluate({"decrement": gd.estimator("log_decrement")}, short, snr_db=[20], bound=False)
    row = found.content["snr_db"]["20"]["estimators"]["decrement"]
    assert row["answered"] == 0
    assert row["rmse_percent"] is None
    assert "`decrement` (0 of 3 runs suit it) | –" in found.table()


def test_none_to_ask_is_refused(runs):
    with pytest.raises(gd.InputError, match="estimators = \\{\\}: none is named"):
        gd.evaluate({}, runs)
