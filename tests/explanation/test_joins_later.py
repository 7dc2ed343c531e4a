"""What joins a fit later does so where the rest has come half of the way to what is to be reached; made-up fits."""

from math import inf
from types import SimpleNamespace
from unittest.mock import patch

import pytest

from gear_damping.explanation.trials import refit as module


@pytest.mark.parametrize(
    ("cost", "reach", "joins"), [(90.0, inf, True), (60.0, 20.0, True), (61.0, 20.0, False), (30.0, -1.0, True)]
)
def test_it_joins_half_way(cost, reach, joins):
    candidate = SimpleNamespace(hypothesis="first", later=("width",), non_nested=False)
    fitted = []

    def fit(hypothesis, *_, **__):
        fitted.append(hypothesis)
        return SimpleNamespace(fitted=SimpleNamespace(cost=cost), is_finite=True)

    score = SimpleNamespace(candidate=candidate, own={})
    with (
        patch.object(module, "fit_hypothesis", fit),
        patch.object(module, "_starts", lambda score: None),
        patch.object(module, "_freed", lambda found, candidate: "freed"),
        patch.object(module, "compared", lambda *_: "compared"),
    ):
        base = SimpleNamespace(fitted=SimpleNamespace(cost=100.0))
        assert module.refitted(score, base, SimpleNamespace(duration=1.0), reach=reach) == "compared"
    assert fitted == (["first", "freed"] if joins else ["first"])
