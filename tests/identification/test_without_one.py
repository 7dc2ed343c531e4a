"""What a fit would be without one of its records, against the fit without it."""

from types import SimpleNamespace

import torch
from torch import Tensor

from gear_damping.identification.output_error.uncertainty import without_one

RECORDS, TIME, SHARED, OWN = 5, 60, 3, 2
PRIOR = torch.tensor([0.0, 4.0, 0.0], dtype=torch.float64)  # slopes of what is expected of the shared coordinates


def linear_fit(sensitivity: Tensor, target: Tensor, prior: Tensor) -> Tensor:
    """Shared coordinates of least squares with every record's own ones beside them."""
    shared = sensitivity[..., :SHARED].reshape(-1, SHARED)
    own = torch.block_diag(*sensitivity[..., SHARED:])
    rows = torch.cat([torch.cat([shared, own], 1), torch.nn.functional.pad(torch.diag(prior), (0, own.shape[1]))])
    right = torch.cat([target.reshape(-1), torch.zeros(SHARED, dtype=torch.float64)])
    return torch.linalg.lstsq(rows, right.unsqueeze(1), driver="gelsd").solution[:SHARED, 0]


def made_up(silent_elsewhere: bool = False) -> tuple[Tensor, Tensor]:
    """Sensitivities of the prediction, and targets that differ from record to record by more than noise."""
    draw = torch.Generator().manual_seed(7)
    sensitivity = torch.randn(RECORDS, TIME, SHARED + OWN, generator=draw, dtype=torch.float64)
    if silent_elsewhere:
        sensitivity[1:, :, 2] = 0.0
    truth = 1 + 0.3 * torch.randn(RECORDS, 1, SHARED + OWN, generator=draw, dtype=torch.float64)
    noise = 0.1 * torch.randn(RECORDS, TIME, generator=draw, dtype=torch.float64)
    return sensitivity, (sensitivity * truth).sum(-1) + noise


def moves(sensitivity: Tensor, target: Tensor, groups: list[int]) -> tuple[Tensor, Tensor]:
    """The fit to all, and what the function says of it."""
    fit = linear_fit(sensitivity, target, PRIOR)
    left = target - sensitivity[..., :SHARED] @ fit
    own = sensitivity[..., SHARED:]
    left = left - (own @ torch.linalg.lstsq(own, left.unsqueeze(-1)).solution)[..., 0]
    # residuals have the sign of measured less predicted, and their sensitivities that of what is predicted
    prediction = SimpleNamespace(sensitivity=sensitivity.unsqueeze(0), residual=left.unsqueeze(0))
    problem = SimpleNamespace(n_shared=SHARED, expectation=lambda shared, left: (PRIOR * shared, PRIOR))
    return fit, without_one(problem, SimpleNamespace(prediction=prediction, shared=fit), groups)


def test_it_is_the_fit_without_each_of_the_groups():
    """The second and the fourth record are one group."""
    sensitivity, target = made_up()
    groups = [0, 1, 2, 1, 3]
    fit, found = moves(sensitivity, target, groups)
    assert found.shape == (4, SHARED)
    for group in range(4):
        kept = [place for place, one in enumerate(groups) if one != group]
        rest = linear_fit(sensitivity[kept], target[kept], PRIOR)
        assert torch.allclose(found[group].abs(), (rest - fit).abs(), rtol=1e-8)
        assert torch.allclose(found[group] / found[group, 0], (rest - fit) / (rest - fit)[0], rtol=1e-7)


def test_what_one_record_alone_tells_stays_without_it():
    """The third coordinate acts in the first record only."""
    sensitivity, target = made_up(silent_elsewhere=True)
    fit, found = moves(sensitivity, target, list(range(RECORDS)))
    assert abs(float(found[0, 2])) < 1e-9
    moved = linear_fit(sensitivity[1:], target[1:], PRIOR)[:2] - fit[:2]
    assert torch.allclose(found[0, :2].abs(), moved.abs(), rtol=1e-7)
