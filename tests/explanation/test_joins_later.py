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
    candidate = SimpleNamespace(hypothesis="first", settled=(), later=("width",), non_nested=False, own_levels=False)
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


@pytest.mark.parametrize(("apart", "is_finite", "taken"), [(40.0, True, 40.0), (90.0, True, 60.0), (40.0, False, 60.0)])
def test_a_second_beginning_is_taken_where_it_leads_to_less(apart, is_finite, taken):
    """As springs of single records do, which no mean one leads to."""
    candidate = SimpleNamespace(hypothesis="first", settled=(), later=(), non_nested=False)
    begun = object()

    def fit(hypothesis, evidence, initial, *_):
        cost, finite = (apart, is_finite) if initial is begun else (60.0, True)
        return SimpleNamespace(fitted=SimpleNamespace(cost=cost), is_finite=finite)

    base = SimpleNamespace(fitted=SimpleNamespace(cost=100.0))
    with (
        patch.object(module, "fit_hypothesis", fit),
        patch.object(module, "_starts", lambda score: None),
        patch.object(module, "levels_alone", lambda *_: begun),
        patch.object(module, "compared", lambda score, found, *_: found.fitted.cost),
    ):
        assert (
            module.refitted(SimpleNamespace(candidate=candidate, own={}), base, SimpleNamespace(duration=1.0)) == taken
        )
