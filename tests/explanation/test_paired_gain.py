"""The test of a gain on held-out records: what noise gives, what a few events give, what a wrong prediction gives."""

import numpy as np
import pytest
import torch

from gear_damping.explanation.statistics.paired import confirmation, paired_gain, share_taken

SAMPLES, BLOCK, RATE = 1600, 100, 400


def ring(at, phase=0.0):
    """A decaying oscillation of unit height that begins at a sample."""
    t = np.arange(SAMPLES) - at
    return np.where(t >= 0, np.exp(-t / 40.0) * np.cos(0.3 * t + phase), 0.0)


def t_of(truth, predicted, rng, smooth=0.0):
    noise = rng.normal(size=SAMPLES)
    for i in range(1, SAMPLES):
        noise[i] = smooth * noise[i - 1] + (1 - smooth**2) ** 0.5 * noise[i]
    measured = torch.tensor(truth + noise)
    return paired_gain([measured], [measured - torch.tensor(predicted)], [BLOCK])[1]


def test_one_event_that_is_predicted_is_certain():
    rng = np.random.default_rng(7)
    assert min(t_of(5 * ring(700), 5 * ring(700), rng) for _ in range(50)) > 3.0


def test_an_event_that_is_not_there_never_gains():
    rng = np.random.default_rng(8)
    found = [t_of(0 * ring(700), 2 * ring(700), rng, smooth) for smooth in (0.0, 0.8) for _ in range(200)]
    assert max(found) < 3.0


def test_an_event_half_of_whose_height_is_predicted_twice_over_has_no_sure_gain():
    """A prediction that is twice the truth neither gains nor loses: t is that of noise."""
    rng = np.random.default_rng(9)
    for smooth in (0.0, 0.8):
        found = np.array([t_of(2 * ring(700), 4 * ring(700), rng, smooth) for _ in range(400)])
        assert abs(found.mean()) < 0.3
        assert found.std() < 1.3
        assert (found > 3.0).mean() <= 0.01


def test_a_gain_all_along_is_tested_over_blocks():
    """Where every block tells, their scatter is the error, whatever else the predictions miss."""
    rng = np.random.default_rng(10)
    wave = np.cos(0.3 * np.arange(SAMPLES))
    found = [t_of(0.1 * wave, 0.2 * wave, rng) for _ in range(200)]
    assert np.mean(np.array(found) > 3.0) <= 0.01


def test_what_a_prediction_adds_is_confirmed_on_what_is_left_without_it():
    """The sum over blocks of what is added times what is left, by hand; noise alone gives a standard normal."""
    rng = np.random.default_rng(11)
    old, added = rng.normal(size=SAMPLES), np.cos(0.3 * np.arange(SAMPLES))
    by_hand = (added * old).reshape(-1, BLOCK).sum(1)
    found = confirmation([torch.tensor(old)], [torch.tensor(old - added)], [BLOCK])
    assert found == pytest.approx(by_hand.sum() / np.sqrt((by_hand**2).sum()), rel=1e-12)
    nothing = [rng.normal(size=SAMPLES) for _ in range(400)]
    drawn = np.array([confirmation([torch.tensor(n)], [torch.tensor(n - added)], [BLOCK]) for n in nothing])
    assert abs(drawn.mean()) < 0.2
    assert 0.8 < drawn.std() < 1.2


def test_the_interval_of_a_share_holds_it_as_often_as_it_says():
    rng, inside = np.random.default_rng(12), []
    wave = np.cos(0.3 * np.arange(SAMPLES))
    truth = (0.5 * wave**2).sum() / ((wave**2).sum() + SAMPLES)  # half of the wave's power is taken
    for _ in range(400):
        noise = rng.normal(size=SAMPLES)
        pair = ([torch.tensor(wave + noise)], [torch.tensor(0.5**0.5 * wave + noise)])
        found = share_taken(*pair, [BLOCK])
        inside.append(found.interval95[0] < truth + _cross(wave) < found.interval95[1])
    assert 0.92 < np.mean(inside) < 0.98


def _cross(wave):
    """Nothing: noise and wave have no product on average."""
    return 0.0


@pytest.mark.parametrize("test", [lambda *three: paired_gain(*three)[1], confirmation])
def test_a_prediction_that_is_not_finite_is_worse_than_any_other(test):
    noise = torch.tensor(np.random.default_rng(12).normal(size=SAMPLES))
    lost = noise.clone()
    lost[700:] = torch.nan
    assert test([lost], [noise], [BLOCK]) > 1e9
    assert test([noise], [lost], [BLOCK]) < -1e9
    assert test([lost], [lost], [BLOCK]) == 0.0
