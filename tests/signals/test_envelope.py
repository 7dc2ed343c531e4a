"""Analytic signal and interpolation against closed forms."""

from math import pi

import numpy as np
import pytest
import scipy.signal
import torch

from gear_damping.signals.envelope import analytic_signal, envelope, instantaneous_frequency, upsample

RATE = 1000.0


def multisine(t, highest, seed=4):
    """25 tones of any frequency up to `highest` per sample, not periodic in the record; of order one."""
    rng = np.random.default_rng(seed)
    frequency, phase = rng.uniform(0, highest, 25), rng.uniform(0, 2 * pi, 25)
    return np.sin(2 * pi * frequency * t[:, None] + phase).sum(1) / 5


@pytest.mark.parametrize("n_samples", [200, 201])
def test_analytic_signal_is_that_of_scipy(n_samples):
    signal = np.random.default_rng(1).standard_normal((3, n_samples))
    found = analytic_signal(torch.tensor(signal))
    np.testing.assert_allclose(found.numpy(), scipy.signal.hilbert(signal, axis=1), atol=1e-13)
    assert analytic_signal(torch.tensor(signal).float()).dtype == torch.complex64


def test_decay_has_its_envelope_and_frequency():
    t = torch.arange(4000, dtype=torch.float64) / RATE
    decay = torch.exp(-1.5 * t) * torch.cos(2 * pi * 60 * t)
    middle = slice(500, 1500)
    ratio = envelope(decay[None])[0, middle] / torch.exp(-1.5 * t)[middle]
    assert (ratio - 1).abs().max() < 0.02
    frequency = instantaneous_frequency(decay[None], RATE)
    assert frequency.shape == (1, 4000)
    assert (frequency[0, middle] - 60).abs().max() < 0.5


def test_periodic_chirp_of_phase_has_its_frequency():
    t = torch.arange(2000, dtype=torch.float64) / RATE
    phase = 2 * pi * 200 * t + 3 * torch.sin(2 * pi * t)
    expected = 200 + 3 * torch.cos(2 * pi * t)
    found = instantaneous_frequency(torch.cos(phase)[None], RATE)[0]
    assert (found - expected)[1:-1].abs().max() < 1e-4
    assert (found - expected).abs().max() < 0.1
    with pytest.raises(ValueError, match="sampling_rate must be positive"):
        instantaneous_frequency(torch.cos(phase)[None], -1.0)


@pytest.mark.parametrize(("highest", "bound"), [(0.2, 1e-7), (0.35, 1e-7), (0.42, 2e-7)])
def test_multisine_is_interpolated(highest, bound):
    factor, n_samples = 8, 600
    t = np.arange((n_samples - 1) * factor + 1) / factor
    exact = torch.tensor(multisine(t, highest))
    signal = exact[::factor][None].expand(2, -1)
    found = upsample(signal, factor)
    assert found.shape == (2, len(t))
    error = (found - exact).abs()
    assert torch.equal(found[:, ::factor], signal)
    assert error[:, 32 * factor : -32 * factor].max() < bound
    # Towards the ends the unknown continuation is felt, and only there.
    assert error[:, 24 * factor : -24 * factor].max() < 1e-4
    assert error.max() < 0.5


def test_straight_line_stays_straight_to_its_ends():
    line = 3.0 + 0.5 * torch.arange(100, dtype=torch.float64)
    expected = 3.0 + 0.5 * torch.arange(99 * 5 + 1, dtype=torch.float64) / 5
    assert (upsample(line[None], 5)[0] - expected).abs().max() < 1e-6
    step = torch.zeros(1, 400)
    step[:, 200:] = 1
    assert upsample(step, 4)[0, : 160 * 4].abs().max() == 0


@pytest.mark.parametrize("n_samples", [2, 3, 20])
def test_short_records_are_interpolated_roughly(n_samples):
    exact = torch.cos(0.1 * torch.arange((n_samples - 1) * 4 + 1, dtype=torch.float64) / 4)
    found = upsample(exact[None, ::4], 4)[0]
    assert (found - exact).abs().max() < 0.06


def test_factor_one_and_wrong_factors():
    signal = torch.rand(2, 50, generator=torch.Generator().manual_seed(2))
    assert torch.equal(upsample(signal, 1), signal)
    for factor in (0, 1.5, -2):
        with pytest.raises(ValueError, match="factor must be a positive whole number"):
            upsample(signal, factor)
