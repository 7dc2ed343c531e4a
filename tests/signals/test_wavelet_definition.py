"""The transforms against the sum that defines them and against closed forms, both written out here."""

from math import pi, sqrt

import numpy as np
import pytest
import torch

from gear_damping.signals.wavelets import MorletCWT, RickerCWT

RATE = 1000.0
WAVELETS = [(RickerCWT, {}), (MorletCWT, {}), (MorletCWT, {"omega0": 20.0})]


def ricker(t):
    return 2 / (np.sqrt(3) * np.pi**0.25) * (1 - t**2) * np.exp(-(t**2) / 2)


def morlet(t, omega0=6.0):
    kappa = np.exp(-(omega0**2) / 2)
    norm = (1 + np.exp(-(omega0**2)) - 2 * np.exp(-0.75 * omega0**2)) ** -0.5
    return norm * np.pi**-0.25 * (np.exp(1j * omega0 * t) - kappa) * np.exp(-(t**2) / 2)


def ricker_spectrum(u):
    return 2 / (np.sqrt(3) * np.pi**0.25) * np.sqrt(2 * np.pi) * u**2 * np.exp(-(u**2) / 2)


def morlet_spectrum(u, omega0=6.0):
    return np.pi**-0.25 * np.sqrt(2 * np.pi) * np.exp(-((u - omega0) ** 2) / 2)


def formulas(wavelet, options):
    if wavelet is RickerCWT:
        return ricker, ricker_spectrum
    return (lambda t: morlet(t, **options)), (lambda u: morlet_spectrum(u, **options))


def direct_sum(signal, scales, psi):
    """W[s, n] = s^-1/2 sum_k x[k] conj(psi((k - n) / s)), one coefficient after the other."""
    n_samples = len(signal)
    k = np.arange(n_samples)
    rows = [
        [np.sum(signal * np.conj(psi((k - n) / scale))) / np.sqrt(scale) for n in range(n_samples)] for scale in scales
    ]
    return np.array(rows)


def noise(batch, n_samples, seed=3):
    return torch.randn(batch, n_samples, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)


@pytest.mark.parametrize(("wavelet", "options"), WAVELETS)
@pytest.mark.parametrize("n_samples", [2, 30, 200])
@pytest.mark.parametrize("dense_limit", [0, 1000])
def test_both_routes_give_the_defining_sum(wavelet, options, n_samples, dense_limit):
    # From half a sample, where the wavelet is badly sampled, to scales longer than the record.
    transform = wavelet(RATE, frequencies_hz=[500.0, 250.0, 90.0, 11.0, 0.7], **options)
    transform.dense_limit = dense_limit
    signal = noise(2, n_samples)
    psi, _ = formulas(wavelet, options)
    expected = np.stack([direct_sum(x, transform.scales, psi) for x in signal.numpy()])
    np.testing.assert_allclose(transform(signal).numpy(), expected, rtol=0, atol=2e-13 * np.abs(expected).max())


@pytest.mark.parametrize("wavelet", [RickerCWT, MorletCWT])
@pytest.mark.parametrize("n_samples", [30, 3000])
def test_single_precision_is_that_of_the_type(wavelet, n_samples):
    transform = wavelet(RATE, frequency_min_hz=5.0, frequency_max_hz=500.0, n_scales=12)
    signal = noise(3, n_samples)
    exact, single = transform(signal), transform(signal.float())
    assert (single - exact).abs().max() < 2e-6 * exact.abs().max()
    assert single.dtype == (torch.float32 if wavelet is RickerCWT else torch.complex64)


@pytest.mark.parametrize(("wavelet", "options"), WAVELETS)
def test_tone_has_the_closed_form(wavelet, options):
    amplitude, frequency, phase = 1.7, 80.0, 0.4
    transform = wavelet(RATE, frequencies_hz=[50.0, 70.0, 80.0, 110.0], **options)
    omega, n = 2 * pi * frequency / RATE, np.arange(1500)
    tone = torch.tensor(amplitude * np.cos(omega * n + phase))[None]
    scale = np.array(transform.scales)[:, None]
    _, spectrum = formulas(wavelet, options)
    expected = amplitude * np.sqrt(scale) * spectrum(scale * omega) * np.exp(1j * (omega * n + phase))
    expected = expected.real if wavelet is RickerCWT else expected / 2
    middle = slice(600, 900)
    np.testing.assert_allclose(transform(tone)[0].numpy()[:, middle], expected[:, middle], rtol=0, atol=1e-9)


@pytest.mark.parametrize(("wavelet", "options"), WAVELETS)
@pytest.mark.parametrize("convention", ["L2", "L1"])
def test_ridge_of_a_tone_obeys_the_rule(wavelet, options, convention):
    frequency = 40.0
    grid = np.geomspace(30.0, 55.0, 601)
    transform = wavelet(RATE, frequencies_hz=grid.tolist(), **options)
    n = torch.arange(2400, dtype=torch.float64)
    coefficients = transform(torch.sin(2 * pi * frequency / RATE * n)[None])[0, :, 900:1500]
    power = coefficients.abs().square().mean(1).numpy()  # 600 samples are 24 whole periods
    scales = np.array(transform.scales)
    ridge = scales[np.argmax(power if convention == "L2" else power / scales)]
    number = transform.ridge_number if convention == "L2" else transform.peak_number
    assert number * RATE / (2 * pi * ridge) == pytest.approx(frequency, rel=1.1e-3)


def test_rules_are_those_of_the_literature():
    transform = RickerCWT(1.0, frequencies_hz=[0.01])
    assert transform.scales[0] == pytest.approx(0.2516 / 0.01, rel=2e-4)
    assert transform.peak_number / (2 * pi) == pytest.approx(0.2251, rel=1e-3)
    fourier_wavelength = 1 / 0.01 / MorletCWT(1.0, frequencies_hz=[0.01]).scales[0]
    assert fourier_wavelength == pytest.approx(1.033, rel=1e-3)  # Torrence and Compo, table 1, w0 = 6


@pytest.mark.parametrize(("wavelet", "options"), WAVELETS)
def test_mother_has_unit_energy_and_no_mean(wavelet, options):
    t = torch.linspace(-12, 12, 4801, dtype=torch.float64)
    psi = wavelet(RATE, frequencies_hz=[10.0], **options).mother(t)
    assert psi.abs().square().sum().item() * 0.005 == pytest.approx(1, abs=1e-12)
    assert abs(psi.sum().item()) * 0.005 < 1e-12


@pytest.mark.parametrize("wavelet", [RickerCWT, MorletCWT])
def test_stretched_signal_moves_to_the_stretched_scale(wavelet):
    # x(t/2) at scale 2s and time 2n is sqrt(2) times x at s and n.
    t = torch.arange(-600, 601, dtype=torch.float64)
    pulse = [torch.exp(-((t / width) ** 2)) * torch.cos(3 * t / width) for width in (20.0, 40.0)]
    one = wavelet(RATE, frequencies_hz=[25.0])(pulse[0][None])[0, 0, 500:701]
    two = wavelet(RATE, frequencies_hz=[12.5])(pulse[1][None])[0, 0, 400:801:2]
    assert (two - sqrt(2) * one).abs().max() < 1e-10
    assert one.abs().max() > 0.1
