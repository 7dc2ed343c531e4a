"""Whether a strength is told from none beside parameters of which something is stated, on made-up sensitivities."""

from math import inf
from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.trials import told_size

SAMPLES, SIZE = 2048, 40.0  # standard errors of the strength, were all else known


@pytest.mark.parametrize("unit", [1.0, 1e-7], ids=["sensors of order one", "metres of a mesh"])
@pytest.mark.parametrize(
    ("stated", "is_told"),
    [
        (inf, False),  # nobody knows the stiffness, and it does what the strength does
        (1.0, True),  # the strength is 40 +- 1 of what the stiffness may be off by
        (100.0, False),
    ],
)
def test_a_strength_that_does_what_a_stiffness_does_is_told_by_what_is_stated_of_it(stated, is_told, unit):
    """A ripple of the torque, 4.22 (4.12 to 4.32) N m beside inertias that are stated to 1 %, was dropped as none.

    So was a modulation of .0364 (.0356 to .0372), where what is stated counted in metres and not in their squares.
    """
    sign = unit * (1 - 2.0 * (torch.arange(SAMPLES) >> 3 & 1)).double() / SAMPLES**0.5
    residual = unit * (1 - 2.0 * (torch.arange(SAMPLES) & 1)).double().reshape(1, 1, -1)
    free = [SimpleNamespace(name=name, logarithmic=False, scale=1.0, start=0.0) for name in ("a.s", "stiffness")]
    for parameter in free:
        parameter.value = lambda shared: SIZE
    problem = SimpleNamespace(
        free=free, n_shared=2, records=[SimpleNamespace(sampling_rate=1.0)],
        response=SimpleNamespace(weights=torch.ones(SAMPLES)), level=lambda _: torch.tensor(unit),
        expectation=lambda *_: (torch.zeros(2), torch.tensor([0.0, unit / stated], dtype=torch.float64)),
    )  # fmt: skip
    own = torch.zeros(SAMPLES, dtype=torch.float64)  # of the records nothing is free
    sensitivity = torch.stack([sign, sign, own], 1).reshape(1, 1, SAMPLES, 3)
    fitted = SimpleNamespace(
        shared=torch.zeros(2), prediction=SimpleNamespace(residual=residual, sensitivity=sensitivity)
    )
    candidate = SimpleNamespace(non_nested=False, strengths=[0], hypothesis=SimpleNamespace(common=free[:1]))
    refit = SimpleNamespace(name="a", score=SimpleNamespace(candidate=candidate))
    evidence = SimpleNamespace(settings=SearchSettings(), noise=1.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(told_size, "time_scale", lambda *_: 0.0)
        model = SimpleNamespace(problem=problem, fitted=fitted, hypothesis=None)
        assert told_size.is_told(model, refit, evidence) == is_told
