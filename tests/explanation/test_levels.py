"""How well a record's own level is known where the data tell only its product with something that the file states."""

from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.answer import levels


def outcome_of(deviation, noise, seed=3):
    """Two records of level 1 and 2, whose motion one stated figure scales: masses, stiffness and damping of a speed.

    Its column is what the mean of the damping does too: without the statement all levels may grow together.
    """
    drawn = torch.Generator().manual_seed(seed)
    waves = torch.randn(2, 4000, generator=drawn, dtype=torch.float64)
    names = ["d.spread", "d.level@a", "d.level@b", "scale"]
    sizes = {"d.spread": 1.0, "d.level@a": 2.0, "d.level@b": 1.0, "scale": 0.0}
    columns = torch.zeros(2, 4000, 4, dtype=torch.float64)
    columns[0, :, 1], columns[1, :, 2] = waves
    columns[..., 0] = 2.0 * columns[..., 1] + columns[..., 2]
    columns[..., 3] = 2.0 * columns[..., 1] + columns[..., 2] + 0.02 * torch.randn(2, 4000, generator=drawn)
    residual = noise * torch.randn(2, 4000, generator=drawn, dtype=torch.float64)
    free = [SimpleNamespace(name=name) for name in names]
    slope = torch.tensor([0.0, 0.0, 0.0, noise / deviation], dtype=torch.float64)
    problem = SimpleNamespace(
        free=free, n_shared=4, expectation=lambda *_: (0 * slope, slope), level=lambda _: torch.tensor(noise)
    )
    linear = SimpleNamespace(sensitivity=columns[None], residual=residual[None])
    fitted = SimpleNamespace(shared=torch.zeros(4))
    return SimpleNamespace(problem=problem, linearisation=linear, values=sizes, fitted=fitted)


@pytest.mark.parametrize("deviation", [0.05, 0.1])
def test_what_is_stated_of_a_common_scale_counts(deviation, monkeypatch):
    """The level of the first record moves by 2 with the scale, that of the second by 1."""
    monkeypatch.setattr(levels, "own_levels", lambda _: {"d": ("d.spread", "d.level")})
    monkeypatch.setattr(levels, "block_of", lambda *_: 4)
    monkeypatch.setattr(levels, "nuisance_basis", lambda sensitivity, n: torch.zeros(2, 4000, 1, dtype=torch.float64))
    rows = levels.levels_by_record(outcome_of(deviation, 0.5), "d", None)
    halves = [(row["interval95"][1] - row["interval95"][0]) / 2 / 1.96 for row in rows]
    assert halves == pytest.approx([2 * deviation, deviation], rel=0.1)


def test_an_error_is_that_of_noise_and_of_what_is_known():
    """By (A'A)^-1 (A' s^2 A + variance K' K) (A'A)^-1 for one column."""
    drawn = torch.Generator().manual_seed(1)
    seen, known, sigma = (
        torch.randn(8000, 1, generator=drawn, dtype=torch.float64),
        torch.tensor([[30.0]]).double(),
        0.3,
    )
    residual = sigma * torch.randn(8000, generator=drawn, dtype=torch.float64)
    energy, stated = float(seen.square().sum()), 900.0
    found = levels._errors(torch.cat([seen, known]), residual, 4, 0.5)
    expected = (sigma**2 * energy + 0.5 * stated) ** 0.5 / (energy + stated)
    assert float(found[0]) == pytest.approx(expected, rel=0.05)
