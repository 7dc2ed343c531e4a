"""Spectra against closed forms, Parseval's theorem and chirps of known order."""

from math import pi

import pytest
import torch
from torch.testing import assert_close

from gear_damping.signals.spectra import amplitude_spectrum, order_spectrum, power_spectral_density

RATE = 1000.0


def noise(batch, n_samples):
    return torch.randn(batch, n_samples, generator=torch.Generator().manual_seed(8), dtype=torch.float64)


@pytest.mark.parametrize("window", ["hann", "boxcar", "flattop"])
@pytest.mark.parametrize("n_samples", [1000, 1001])
def test_tones_show_their_amplitude(window, n_samples):
    n = torch.arange(n_samples, dtype=torch.float64)
    angle = 2 * pi * n / n_samples
    signal = torch.stack([1.5 + 2 * torch.cos(100 * angle + 1), 0.25 * torch.sin(60 * angle)])
    frequencies, amplitude = amplitude_spectrum(signal, RATE, window)
    assert frequencies.shape == (n_samples // 2 + 1,)
    assert frequencies[100].item() == pytest.approx(100 * RATE / n_samples)
    assert_close(amplitude[:, 100], torch.tensor([2.0, 0.0]).double(), atol=1e-9, rtol=0)
    assert_close(amplitude[:, 60], torch.tensor([0.0, 0.25]).double(), atol=1e-9, rtol=0)
    assert_close(amplitude[:, 0], torch.tensor([1.5, 0.0]).double(), atol=1e-9, rtol=0)


def test_line_at_half_the_sampling_rate_is_not_doubled():
    alternating = torch.tensor([[1.0, -1.0] * 50])
    _, amplitude = amplitude_spectrum(alternating, RATE, "boxcar")
    assert amplitude.dtype == torch.float32
    assert amplitude[0, -1].item() == pytest.approx(1)


@pytest.mark.parametrize("n_samples", [500, 501])
def test_amplitudes_hold_the_mean_square(n_samples):
    signal = noise(3, n_samples)
    _, amplitude = amplitude_spectrum(signal, RATE, "boxcar")
    weight = torch.full((amplitude.shape[1],), 0.5, dtype=torch.float64)
    weight[0] = 1
    if n_samples % 2 == 0:
        weight[-1] = 1
    assert_close((weight * amplitude**2).sum(1), signal.square().mean(1))


def test_density_integrates_to_the_variance():
    signal = noise(2, 4096)
    frequencies, density = power_spectral_density(signal, RATE, segment_length=4096, window="boxcar")
    assert_close(density.sum(1) * frequencies[1], signal.var(1, unbiased=False))
    # White noise of variance 1 has the density 2 / RATE at every frequency.
    _, density = power_spectral_density(signal, RATE, segment_length=128)
    assert density[:, 2:-2].mean().item() == pytest.approx(2 / RATE, rel=0.05)
    assert density[:, 2:-2].std().item() < 0.4 * 2 / RATE


def test_density_keeps_type_and_default_segment():
    frequencies, density = power_spectral_density(noise(2, 800).float(), RATE)
    assert density.dtype == frequencies.dtype == torch.float32
    assert density.shape == (2, 51)
    with pytest.raises(ValueError, match="segment_length must be 2 to 800"):
        power_spectral_density(noise(2, 800), RATE, segment_length=801)


def run_up(n_samples=8000, seconds=4.0):
    """Shaft angle (rad) of a run-up from 10 to 25 revolutions per second: 70 revolutions."""
    t = torch.linspace(0, seconds, n_samples, dtype=torch.float64)
    return 2 * pi * (10 * t + 15 / seconds * t**2 / 2)


def test_chirp_is_one_order_line():
    angle = run_up()
    signal = torch.stack([0.8 * torch.sin(17 * angle + 0.3), 0.2 * torch.cos(3 * angle)])
    orders, amplitude = order_spectrum(signal, angle)
    for row, (order, height) in enumerate([(17, 0.8), (3, 0.2)]):
        line = amplitude[row].argmax()
        assert orders[line].item() == pytest.approx(order)
        assert amplitude[row, line].item() == pytest.approx(height, rel=1e-4)
        elsewhere = (orders - order).abs() > 0.1
        assert amplitude[row, elsewhere].max() < 1e-4 * height
    # The same chirp is smeared over frequency: the order axis is what makes it a line.
    assert amplitude_spectrum(signal, 2000.0)[1].max() < 0.2


def test_orders_end_where_the_fastest_part_is_resolved():
    angle = run_up()
    orders, _ = order_spectrum(torch.sin(angle)[None], angle)
    assert orders[-1].item() == pytest.approx(pi / angle.diff().max().item(), abs=1 / 60)
    _, amplitude = order_spectrum(0.5 * torch.sin(38 * angle)[None], angle)
    assert amplitude.max().item() == pytest.approx(0.5, rel=1e-3)


def test_high_orders_of_the_slow_part_do_not_fold():
    # Order 60 is sampled while the shaft is slow; 80 samples per revolution, enough for the fast part,
    # would show it at order 20.
    angle = run_up()
    burst = torch.zeros(1, len(angle), dtype=torch.float64)
    burst[0, :1500] = torch.sin(60 * angle[:1500]) * torch.hann_window(1500, dtype=torch.float64)
    _, amplitude = order_spectrum(burst, angle)
    assert amplitude.max() < 1e-4


def test_constant_speed_agrees_with_the_amplitude_spectrum():
    angle = 2 * pi * torch.arange(641, dtype=torch.float64) / 64
    signal = 3 * torch.sin(5 * angle)[None]
    orders, amplitude = order_spectrum(signal, angle, "boxcar")
    assert orders[50].item() == pytest.approx(5)
    assert amplitude[0, 50].item() == pytest.approx(3, rel=1e-4)


def test_impossible_angles_are_refused():
    signal = noise(1, 100)
    turning = torch.linspace(0, 20, 100)
    for angle in (turning.flip(0), turning[:50], turning[None].expand(1, 100), turning.remainder(2 * pi)):
        with pytest.raises(ValueError, match="increase from sample to sample"):
            order_spectrum(signal, angle)
    with pytest.raises(ValueError, match="must cover a revolution"):
        order_spectrum(signal, turning / 10)
