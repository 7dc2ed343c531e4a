"""What a signal holds beside the parameters of a fit, against plain least squares."""

import numpy as np
import pytest
import torch

from gear_damping.explanation.statistics.projector import Projector

RECORDS, TIME, SHARED, OWN = 3, 12, 4, 2


@pytest.fixture
def drawn():
    generator = torch.Generator().manual_seed(4)
    sensitivity = torch.randn(RECORDS, TIME, SHARED + OWN, generator=generator, dtype=torch.float64)
    return sensitivity, torch.randn(RECORDS * TIME + SHARED, 1, generator=generator, dtype=torch.float64)


def whole(sensitivity: torch.Tensor, slope: torch.Tensor) -> np.ndarray:
    """Every column side by side: shared ones, then those of each record in its rows alone."""
    shared = np.concatenate([sensitivity[..., :SHARED].reshape(-1, SHARED).numpy(), np.diag(slope.numpy())])
    own = np.zeros((RECORDS * TIME + SHARED, RECORDS * OWN))
    for i in range(RECORDS):
        own[i * TIME : (i + 1) * TIME, i * OWN : (i + 1) * OWN] = sensitivity[i, :, SHARED:].numpy()
    return np.concatenate([shared, own], 1)


def test_what_is_left_is_that_of_least_squares_over_all_columns(drawn):
    sensitivity, signal = drawn
    slope = torch.tensor([0.5, 0.0, 2.0, 0.0], dtype=torch.float64)
    found = Projector(sensitivity, torch.zeros(SHARED), slope)(signal)
    columns = whole(sensitivity, slope)
    expected = signal.numpy() - columns @ np.linalg.lstsq(columns, signal.numpy(), rcond=None)[0]
    np.testing.assert_allclose(found.numpy(), expected, atol=1e-12)


def test_the_nuisance_is_an_orthonormal_basis_of_what_is_taken_out(drawn):
    sensitivity, signal = drawn
    project = Projector(sensitivity, torch.zeros(SHARED), torch.zeros(SHARED, dtype=torch.float64))
    basis = project.nuisance
    torch.testing.assert_close(basis.T @ basis, torch.eye(SHARED + RECORDS * OWN, dtype=torch.float64))
    torch.testing.assert_close(signal - basis @ (basis.T @ signal), project(signal))


@pytest.mark.parametrize("count", [1, 2])
def test_more_columns_of_the_records_own_are_taken_out_too(drawn, count):
    """Fewer than are shared, and more."""
    sensitivity, signal = drawn
    more = torch.randn(RECORDS, TIME, count, generator=torch.Generator().manual_seed(5), dtype=torch.float64)
    project = Projector(sensitivity, torch.zeros(SHARED), torch.zeros(SHARED, dtype=torch.float64))
    alone = torch.zeros(RECORDS * TIME + SHARED, 1, dtype=torch.float64)
    alone[:TIME] = more[0, :, :1]
    found = project.with_nuisance(more)(signal).numpy()
    own = np.concatenate([np.kron(np.eye(RECORDS)[:, [i]], more[i].numpy()) for i in range(RECORDS)], 1)
    columns = np.concatenate([whole(sensitivity, torch.zeros(SHARED)), np.pad(own, ((0, SHARED), (0, 0)))], 1)
    expected = signal.numpy() - columns @ np.linalg.lstsq(columns, signal.numpy(), rcond=None)[0]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    taken = project.taken_by_own(more, project(signal))
    assert taken == pytest.approx(float(project(signal).square().sum()) - float((expected**2).sum()))
    assert float(project.with_nuisance(more)(alone).norm()) < 1e-12 < float(project(alone).norm())
    assert project.with_nuisance(more[..., :0]) is project


def test_what_single_records_have_is_projected_as_with_zeros_in_the_others(drawn):
    sensitivity, _ = drawn
    slope = torch.tensor([0.5, 0.0, 2.0, 0.0], dtype=torch.float64)
    signals = torch.randn(2, RECORDS * TIME, generator=torch.Generator().manual_seed(6), dtype=torch.float64)
    reach = torch.tensor([[1, 0, 1], [0, 1, 0]], dtype=torch.float64)  # two segments of one record, and another
    found = Projector(sensitivity, torch.zeros(SHARED), slope).by_record(signals, reach).numpy()
    split = np.einsum("nrt,mr->nmrt", signals.reshape(2, RECORDS, TIME).numpy(), reach.numpy()).reshape(4, -1)
    padded, columns = np.pad(split.T, ((0, SHARED), (0, 0))), whole(sensitivity, slope)
    expected = padded - columns @ np.linalg.lstsq(columns, padded, rcond=None)[0]
    np.testing.assert_allclose(found, expected, atol=1e-12)
