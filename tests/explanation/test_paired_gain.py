"""The test of a gain on held-out records: what noise gives, what a few events give, what a wrong prediction gives."""

import numpy as np
import torch

from gear_damping.explanation.statistics.paired import paired_gain

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
