"""The long-run variance of scores, against its definition lag by lag."""

import pytest
import torch

from gear_damping.identification.output_error.uncertainty import long_run


def lag_by_lag(scores: torch.Tensor, lags: int) -> torch.Tensor:
    """Newey & West (1987): autocovariances weighted by 1 - lag / (lags + 1)."""
    total = torch.zeros(scores.shape[1], scores.shape[1], dtype=scores.dtype)
    for first in range(len(scores)):
        for second in range(len(scores)):
            weight = max(0.0, 1 - abs(first - second) / (lags + 1))
            total += weight * torch.outer(scores[first], scores[second])
    return total


@pytest.mark.parametrize(
    ("samples", "lags"), [(40, 0), (40, 1), (40, 7), (40, 39), (40, 40), (40, 41), (40, 900), (1, 5)]
)
def test_it_is_the_weighted_sum_of_autocovariances(samples: int, lags: int) -> None:
    """Within a record, at its length, and far beyond it."""
    scores = torch.randn(samples, 3, generator=torch.Generator().manual_seed(samples + lags), dtype=torch.float64) + 0.4
    before = scores.clone()
    assert torch.allclose(long_run(scores, lags), lag_by_lag(scores, lags), rtol=1e-11, atol=1e-12)
    assert torch.equal(scores, before)
