"""The variance of what is random, beside many effects that take their share of noise."""

import pytest
import torch

from gear_damping.explanation.trials.assess import _without_what_shows

SAMPLES, BASES, WIDTH = 2000, 80, 8
FREE = float(SAMPLES)


def bases(generator):
    return [
        torch.linalg.qr(torch.randn(SAMPLES, WIDTH, generator=generator, dtype=torch.float64)).Q for _ in range(BASES)
    ]


def variance_of(signal, found):
    left, taken = _without_what_shows(signal, found, FREE)
    return float(left.square().sum()) / (FREE - taken), taken


@pytest.mark.parametrize("size", [0.0, 10.0, 1000.0])
def test_noise_beside_many_effects_keeps_its_variance(size):
    """Without the bases that took most of it, noise had 0.86 of its variance, and a line stood out of nothing."""
    generator = torch.Generator().manual_seed(3)
    found = bases(generator)
    noise = torch.randn(SAMPLES, 1, generator=generator, dtype=torch.float64)
    hidden = found[17] @ torch.full((WIDTH, 1), size, dtype=torch.float64)
    variance, taken = variance_of(noise + hidden, found)
    assert variance == pytest.approx(float(noise.square().mean()), rel=0.02)
    assert taken == (WIDTH if size else 0)


def test_what_hides_behind_something_large_is_taken_out_after_it():
    generator = torch.Generator().manual_seed(4)
    found = bases(generator)
    noise = torch.randn(SAMPLES, 1, generator=generator, dtype=torch.float64)
    large, small = (found[k] @ torch.full((WIDTH, 1), size, dtype=torch.float64) for k, size in ((5, 400.0), (9, 4.0)))
    variance, taken = variance_of(noise + large + small, found)
    assert taken >= 2 * WIDTH
    assert variance == pytest.approx(float(noise.square().mean()), rel=0.03)
