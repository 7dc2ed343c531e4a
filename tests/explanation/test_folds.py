"""Residuals of folds that are left out, against fits that really leave them out (numpy)."""

import numpy as np
import pytest
import torch

from gear_damping.explanation.statistics.folds import left_out

SAMPLES, PARAMETERS, FOLDS = 240, 5, 4


def problem(seed, strength=1.0):
    """Columns, residuals and folds; the first column is strong in the first fold by `strength`."""
    random = np.random.default_rng(seed)
    columns, residual = random.normal(size=(SAMPLES, PARAMETERS)), random.normal(size=SAMPLES)
    folds = np.arange(SAMPLES) * FOLDS // SAMPLES
    columns[folds == 0, 0] *= strength
    return columns, residual, folds


def refitted(columns, residual, folds, slope, expected):
    """The same by a fit for every fold to the samples of the others."""
    found = np.empty_like(residual)
    for fold in range(FOLDS):
        other = folds != fold
        matrix = np.vstack([columns[other], np.diag(slope)])
        solved = np.linalg.lstsq(matrix, np.concatenate([residual[other], expected]), rcond=None)[0]
        found[~other] = residual[~other] - columns[~other] @ solved
    return found


def as_tensors(*arrays):
    return [torch.as_tensor(array) for array in arrays]


@pytest.mark.parametrize("seed", range(5))
def test_they_are_those_of_fits_that_leave_the_fold_out(seed):
    columns, residual, folds = problem(seed)
    random = np.random.default_rng(100 + seed)
    slope, expected = random.uniform(0, 3, PARAMETERS), random.normal(size=PARAMETERS)
    found = left_out(*as_tensors(columns, residual, folds, slope, expected))
    np.testing.assert_allclose(found.residuals, refitted(columns, residual, folds, slope, expected), rtol=1e-8)


def test_scale_and_rank_of_the_columns_do_not_matter():
    columns, residual, folds = problem(7)
    slope, none = np.zeros(PARAMETERS + 2), np.zeros(PARAMETERS)
    wider = np.column_stack([columns * 10.0 ** np.arange(-8, 2, 2), columns[:, 0] + columns[:, 1], np.zeros(SAMPLES)])
    found = left_out(*as_tensors(wider, residual, folds, slope, slope))
    np.testing.assert_allclose(found.residuals, refitted(columns, residual, folds, none, none), rtol=1e-6)


def test_noise_adds_as_much_as_is_stated():
    columns, _, folds = problem(3)
    none, random = np.zeros(PARAMETERS), np.random.default_rng(9)
    added = []
    for _ in range(2000):
        residual = random.normal(size=SAMPLES)
        found = left_out(*as_tensors(columns, residual, folds, none, none))
        added.append(float(((found.residuals.numpy() - residual) ** 2).sum()))
    error = np.std(added) / len(added) ** 0.5
    assert found.expected == pytest.approx(np.mean(added), abs=4 * error)
    assert np.std(added) <= found.deviation < 2 * np.std(added)


def test_what_one_fold_alone_tells_is_not_foretold_from_the_others():
    """A column that lives in one fold: its fold is judged by itself, and nothing runs away."""
    columns, residual, folds = problem(11)
    columns[folds != 2, 0] = 0.0
    residual += 50 * columns[:, 0]
    none = np.zeros(PARAMETERS)
    fitted = residual - columns @ np.linalg.lstsq(columns, residual, rcond=None)[0]
    found = left_out(*as_tensors(columns, fitted, folds, none, none)).residuals.numpy()
    others = refitted(columns, fitted, folds, none, none)
    alone = columns[folds == 2, 0] / np.linalg.norm(columns[folds == 2, 0])
    assert abs(alone @ found[folds == 2]) < 5.0
    np.testing.assert_allclose(found[folds != 2], others[folds != 2], rtol=1e-6)
