"""What a sensor tried as a whole promises, on made-up columns: less than nothing of it is no promise."""

from types import SimpleNamespace
from unittest.mock import patch

import pytest
import torch

from gear_damping.explanation.trials import score
from gear_damping.physics.catalogue import effect_class

SAMPLES = 16
CHANGE = torch.sin(torch.arange(SAMPLES, dtype=torch.float64))
APART = torch.cos(3 * torch.arange(SAMPLES, dtype=torch.float64))


class NothingFree:
    """A projector beside which nothing is free."""

    slope = torch.zeros(0)

    def with_nuisance(self, columns):
        return self

    def __call__(self, signal):
        return signal


@pytest.mark.parametrize(
    ("name", "sign", "promises"),
    [
        ("sensor_lowpass", 1, True),
        ("sensor_lowpass", -1, False),
        ("sensor_saturation", -1, True),
        ("shaft_torsion", -1, True),
    ],
)
def test_a_lowpass_that_would_have_to_lead_promises_nothing(name, sign, promises):
    """A channel that is late beside it looks like less than none, which a size of it would have to be.

    What a shaft or a saturation does is another thing at every size, and its sign says nothing.
    """
    residual = sign * CHANGE + 0.1 * APART
    base = SimpleNamespace(project=NothingFree(), orthogonal=residual, residual=residual, outcome=None)
    hypothesis = SimpleNamespace(common=[SimpleNamespace(name=f"{name}.size")], effects=[effect_class(name)()])
    candidate = SimpleNamespace(non_nested=True, name=name, hypothesis=hypothesis)
    problem = SimpleNamespace(n_shared=1, local=[])
    slopes = CHANGE.reshape(1, SAMPLES, 1)  # another size changes as much of the same
    with patch.object(score, "_slopes", lambda *_: slopes), patch.object(score, "own_from", lambda *_: None):
        found = score._gain(candidate, problem, None, CHANGE.unsqueeze(1), base)
    assert found == (pytest.approx(0.99, abs=0.01) if promises else 0.0)
