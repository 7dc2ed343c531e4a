"""The decomposition of few columns of many samples, against the general one."""

import pytest
import torch

from gear_damping.explanation.statistics.tall import tall_svd


def columns(samples, n, dependent):
    found = torch.randn(samples, n, generator=torch.Generator().manual_seed(n), dtype=torch.float64)
    found[:, -1] = found[:, 0] + dependent * found[:, -1] if n > 1 else found[:, -1]
    return found


def test_of_no_columns_there_is_nothing():
    basis, sizes, turned = tall_svd(torch.zeros(9, 0, dtype=torch.float64))
    assert (basis.shape, sizes.shape, turned.shape) == ((9, 0), (0,), (0, 0))


@pytest.mark.parametrize("dependent", [1.0, 1e-3, 1e-6, 0.0])
@pytest.mark.parametrize("n", [1, 2, 7, 40])
def test_it_is_that_of_the_general_one(n, dependent):
    given = columns(500, n, dependent)
    basis, sizes, turned = tall_svd(given)
    expected = torch.linalg.svdvals(given)
    assert torch.allclose(sizes, expected, rtol=1e-7, atol=1e-13 * float(expected[0]))
    assert torch.allclose(basis @ torch.diag(sizes) @ turned, given, atol=1e-11)
    kept = sizes > 1e-7 * sizes[0]
    gram = basis[:, kept].T @ basis[:, kept]
    assert torch.allclose(gram, torch.eye(len(gram), dtype=torch.float64), atol=1e-7)
