"""Exact Bayes of one window, beside the theorem written out, and beside many windows drawn from what it assumes."""

import numpy as np
import pytest
import torch

from gear_damping.identification.known_model.exact_bayes import WindowBayes, window_bayes
from gear_damping.tasks.composed import composed
from gear_damping.tasks.simulated import plan_of

WINDOW, RATE = 12, 8.0  # samples; of a period


def decays(n_ratios=41, samples=60):
    """Decays of 1 to 20 % of critical, with the noise of a fifth of their size."""
    ratios = torch.linspace(1, 20, n_ratios, dtype=torch.float64)
    angle = 2 * torch.pi * torch.arange(samples) / RATE
    signals = torch.exp(-ratios[:, None] / 100 * angle) * torch.cos(angle)
    noise = 0.2 * signals.std(-1, correction=0)
    return WindowBayes(ratios, signals, noise, torch.arange(0, samples - WINDOW + 1, 3), WINDOW)


def drawn(bayes, count, seed=0):
    """Windows as the theorem assumes them, and their ratios."""
    source = torch.Generator().manual_seed(seed)
    runs = torch.randint(len(bayes.ratios), (count,), generator=source)
    starts = bayes.starts[torch.randint(len(bayes.starts), (count,), generator=source)]
    clean = torch.stack([bayes.signals[r, s : s + WINDOW] for r, s in zip(runs, starts, strict=True)])
    noise = bayes.noise[runs, None] * torch.randn(count, WINDOW, generator=source, dtype=torch.float64)
    return clean + noise, bayes.ratios[runs]


def test_it_is_the_theorem_written_out():
    bayes = decays(7)
    windows, _ = drawn(bayes, 5)
    found = bayes.posterior(windows).numpy()
    for window, row in zip(windows.numpy(), found, strict=True):
        weights = np.zeros(7)
        for g in range(7):
            sigma = float(bayes.noise[g])
            for start in bayes.starts.tolist():
                left = (window - bayes.signals[g, start : start + WINDOW].numpy()) / sigma
                weights[g] += np.prod(np.exp(-(left**2) / 2) / sigma)
        np.testing.assert_allclose(row, weights / weights.sum(), rtol=1e-9, atol=1e-12)


def test_its_mean_errs_by_what_it_says_and_its_interval_holds_nine_tenths():
    bayes = decays()
    windows, true = drawn(bayes, 8000)
    said = bayes.estimate(windows)
    left = bayes.posterior(windows)
    predicted = left @ bayes.ratios.square() - said.ratio.square()
    beyond = (said.ratio - true).square() - predicted
    assert abs(float(beyond.mean())) < 3 * float(beyond.std()) / 8000**0.5
    assert float(beyond.std()) / 8000**0.5 < 0.05 * float(predicted.mean())  # else the line before says little
    held = ((said.low <= true) & (true <= said.high)).double().mean()
    assert float(held) == pytest.approx(0.9, abs=0.02)
    assert float((said.ratio - true).mean()) == pytest.approx(0.0, abs=0.15)


def test_a_window_without_information_leaves_what_was_known_before():
    bayes = decays()
    deaf = WindowBayes(bayes.ratios, bayes.signals, torch.full_like(bayes.noise, 1e6), bayes.starts, WINDOW)
    said = deaf.estimate(torch.zeros(1, WINDOW))
    assert float(said.ratio[0]) == pytest.approx(10.5, abs=1e-3)
    assert (float(said.low[0]), float(said.high[0])) == pytest.approx((1.73, 19.27), abs=0.1)


def plan(family):
    from gear_damping.config.settings import read_settings

    words = ["experiment=baseline", f"family={family}", "simulator.n_samples=80", "simulator.n_runs=4"]
    return plan_of(read_settings(*composed(words)))


def test_the_grid_of_a_plan_has_its_runs(monkeypatch):
    monkeypatch.setattr("gear_damping.identification.known_model.exact_bayes.GRID", 3)
    made = window_bayes(plan("paper"), (0.1, 0.5), 20.0, torch.arange(10), 30)
    np.testing.assert_allclose(made.ratios, [0.1, 0.3, 0.5])
    assert made.signals.shape == (3, 80)
    assert float(made.signals[0].std(correction=0) / made.noise[0]) == pytest.approx(10.0)
    assert float((made.signals[0] - made.signals[2]).abs().max()) > 0


def test_a_family_that_varies_more_is_refused():
    with pytest.raises(ValueError, match="family bench varies pinion_torque too"):
        window_bayes(plan("bench"), (0.1, 0.6), 30.0, torch.arange(3), 30)
