"""The transforms as modules: linearity, batches, memory, types, arguments."""

import json
from math import exp, pi

import pytest
import torch

from gear_damping.signals.streaming import iterate_coefficients, transform_in_chunks
from gear_damping.signals.wavelets import ContinuousWavelet, MorletCWT, RickerCWT

SETTINGS = {"sampling_rate": 1000.0, "frequency_min_hz": 20.0, "frequency_max_hz": 400.0, "n_scales": 6}
KINDS = [(RickerCWT, {}), (MorletCWT, {}), (MorletCWT, {"magnitude": True})]


def noise(batch, n_samples, seed=5):
    return torch.randn(batch, n_samples, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)


def close(one, two):
    return (one - two).abs().max() < 1e-13


@pytest.mark.parametrize("wavelet", [RickerCWT, MorletCWT])
@pytest.mark.parametrize("n_samples", [30, 300])
def test_linear(wavelet, n_samples):
    transform = wavelet(**SETTINGS)
    x, y = noise(2, n_samples, 1), noise(2, n_samples, 2)
    assert close(transform(2 * x - 3 * y), 2 * transform(x) - 3 * transform(y))


@pytest.mark.parametrize(("wavelet", "options"), KINDS)
def test_delay_moves_the_coefficients(wavelet, options):
    transform = wavelet(**SETTINGS, **options)
    pulse = torch.zeros(1, 1000, dtype=torch.float64)
    pulse[:, 400:440] = noise(1, 40)
    delayed = transform(pulse.roll(37, dims=1))
    assert close(delayed[..., 37:], transform(pulse)[..., :-37])
    assert not close(delayed, transform(pulse))


@pytest.mark.parametrize(("wavelet", "options"), KINDS)
@pytest.mark.parametrize("n_samples", [30, 300])
def test_a_record_knows_nothing_of_its_batch(wavelet, options, n_samples):
    signal = noise(7, n_samples)
    whole = wavelet(**SETTINGS, **options)(signal)
    order = torch.tensor([3, 6, 0, 2, 5, 1, 4])
    for chunk, rows in ((3, slice(None)), (2, order)):
        transform = wavelet(**SETTINGS, **options)
        transform.chunk = chunk
        assert close(transform(signal[rows]), whole[rows])
    assert close(wavelet(**SETTINGS, **options)(signal[4:5]), whole[4:5])


def test_magnitude_is_that_of_the_complex_coefficients():
    for n_samples in (30, 300):
        signal = noise(2, n_samples)
        magnitude = MorletCWT(**SETTINGS, magnitude=True)(signal)
        assert magnitude.dtype == torch.float64
        assert close(magnitude, MorletCWT(**SETTINGS)(signal).abs())


def test_cone_of_influence_is_sqrt_two_scales_from_the_ends():
    transform = RickerCWT(**SETTINGS)
    mask = transform.cone_of_influence(200)
    assert mask.shape == (6, 200)
    assert mask.dtype == torch.bool
    for row, scale in zip(mask.tolist(), transform.scales, strict=True):
        assert row == [min(n, 199 - n) < 2**0.5 * scale for n in range(200)]
    assert mask.any(1).all()
    assert not mask.all(1).any()


def test_constant_shows_inside_the_cone():
    transform = RickerCWT(**SETTINGS)
    response = transform(torch.ones(1, 400, dtype=torch.float64))[0].abs()
    mask = transform.cone_of_influence(400)
    # The integral of the Ricker wavelet from t on is -2 / (sqrt(3) pi^(1/4)) t exp(-t^2 / 2).
    at_the_edge = 2 / (3**0.5 * pi**0.25) * 2**0.5 * exp(-1) * torch.tensor(transform.scales).sqrt()
    assert (response.masked_fill(mask, 0).amax(1) < at_the_edge).all()
    assert (response.masked_fill(~mask, 0).amax(1) > at_the_edge).all()
    # Scales above one sample have no mean; the last, of 0.63 samples, is sampled too coarsely for that.
    assert response[:5, 200].max() < 1e-8
    assert response[5, 200] > 1e-3


@pytest.mark.parametrize(("wavelet", "options"), KINDS)
def test_settings_rebuild_the_transform(wavelet, options):
    transform = wavelet(**SETTINGS, **options)
    again = wavelet(**json.loads(json.dumps(transform.settings)))
    assert again.settings == transform.settings
    assert torch.equal(again(noise(2, 50)), transform(noise(2, 50)))
    assert not transform.state_dict()
    assert again.frequencies_hz[0] == pytest.approx(20)
    assert again.frequencies_hz[-1] == 400


@pytest.mark.parametrize(("wavelet", "options"), KINDS)
@pytest.mark.parametrize("n_samples", [12, 80])
def test_gradient_reaches_the_signal(wavelet, options, n_samples):
    transform = wavelet(**SETTINGS | {"n_scales": 2}, **options)
    transform.chunk = 2
    with torch.inference_mode():  # as in a validation before the first training step
        transform(noise(3, n_samples))
    signal = noise(3, n_samples).requires_grad_()
    assert torch.autograd.gradcheck(transform, signal)


def test_few_operators_are_kept():
    transform = RickerCWT(**SETTINGS)
    for n_samples in (20, 30, 100, 110, 120, 130):
        transform(noise(1, n_samples))
    assert len(transform._operators) == 4


@pytest.mark.parametrize(("wavelet", "options"), KINDS)
def test_streaming_equals_the_whole(wavelet, options):
    transform = wavelet(**SETTINGS, **options)
    signals = noise(10, 100).requires_grad_()
    whole = transform(signals)
    out = torch.full_like(whole, float("nan"), requires_grad=False)
    assert transform_in_chunks(transform, signals, out=out, records=4) is out
    assert close(out, whole)
    assert close(transform_in_chunks(transform, signals, records=3, device="cpu"), whole)
    parts = list(iterate_coefficients(transform, signals, records=4))
    assert [(rows.start, rows.stop) for rows, _ in parts] == [(0, 4), (4, 8), (8, 10)]
    assert not any(part.requires_grad for _, part in parts)


def test_streaming_refuses_an_output_that_does_not_fit():
    with pytest.raises(ValueError, match="out must have shape"):
        transform_in_chunks(RickerCWT(**SETTINGS), noise(4, 100), out=torch.empty(4, 5, 100))
    with pytest.raises(ValueError, match="complex128"):
        transform_in_chunks(MorletCWT(**SETTINGS), noise(4, 100), out=torch.empty(4, 6, 100))


@pytest.mark.parametrize(
    ("signal", "message"),
    [
        (torch.zeros(10), r"signal\[None\]"),
        (torch.zeros(2, 10, 3), "select one channel"),
        (torch.zeros(2, 10, dtype=torch.int64), "float32 or float64"),
        (torch.zeros(2, 1), "at least 2 samples"),
    ],
)
def test_wrong_signals_are_refused(signal, message):
    with pytest.raises(ValueError, match=message):
        RickerCWT(**SETTINGS)(signal)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sampling_rate": 0.0}, "sampling_rate must be positive"),
        ({"frequency_max_hz": 501.0}, "at most sampling_rate / 2 = 500 Hz"),
        ({"frequency_min_hz": 0.0}, "frequency_min_hz must be positive"),
        ({"frequency_min_hz": 400.0}, "frequency_max_hz must exceed"),
        ({"n_scales": 1}, "n_scales must be at least 2"),
        ({"n_scales": None}, "give all three"),
        ({"frequencies_hz": [20.0]}, "give either"),
        ({"frequency_min_hz": None, "frequency_max_hz": None, "n_scales": None}, "give either"),
        ({"omega0": 4.0}, "omega0 must be at least 5"),
    ],
)
def test_wrong_arguments_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        MorletCWT(**SETTINGS | change)


def test_base_is_abstract():
    with pytest.raises(TypeError, match="abstract"):
        ContinuousWavelet(**SETTINGS)
