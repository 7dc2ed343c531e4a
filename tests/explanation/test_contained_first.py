"""Of an effect of many numbers and one in it that takes most of the same, the smaller comes first; made-up fits."""

from types import SimpleNamespace
from unittest.mock import patch

import pytest
import torch

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.trials import bench as module
from tests.explanation.decisions.made_up import bench

AXES = torch.eye(5, dtype=torch.float64)
EVERY_TOOTH, ECCENTRIC, ELSEWHERE = AXES[:, :3], AXES[:, :1], AXES[:, 4:]


def score(columns, gain):
    return SimpleNamespace(columns=columns, direction=columns[:, 0], gain=gain)


def fit(columns, cost, **more):
    outcome = SimpleNamespace(fitted=SimpleNamespace(cost=cost))
    known = {"t": 50.0, "is_seen_in_fit": True, "is_at_bound": False} | more
    return SimpleNamespace(score=score(columns, 1 - cost / 8), outcome=outcome, **known)


@pytest.mark.parametrize(
    ("small", "waits"),
    [
        (fit(ECCENTRIC, 2.0), True),
        (fit(ECCENTRIC, 6.0), False),
        (fit(ELSEWHERE, 2.0), False),
        (fit(ECCENTRIC, 2.0, is_at_bound=True), False),
        (fit(ECCENTRIC, 2.0, t=1.0), False),
        (fit(ECCENTRIC, 2.0, is_seen_in_fit=False), False),
    ],
    ids=["takes most of it", "takes little", "is not in it", "at a bound", "not validated", "luck"],
)
def test_an_effect_of_many_numbers_waits_for_one_in_it_that_takes_most(small, waits):
    found = bench(SearchSettings())
    assert found._is_enough(small, score(EVERY_TOOTH, 0.9), 8.0) == waits
    assert not found._is_enough(fit(EVERY_TOOTH, 2.0), score(ECCENTRIC, 0.7), 8.0)


@pytest.mark.parametrize(
    ("promised", "order"),
    [
        ({"every": 0.8, "one": 0.5}, ["one", "every"]),
        ({"every": 0.8, "one": 0.3}, ["every", "one"]),
        ({"every": 0.8, "two": 0.5, "one": 0.3}, ["two", "every", "one"]),
    ],
)
def test_what_promises_too_little_to_spare_the_larger_one_is_fitted_after_it(promised, order):
    strengths, fitted = {"one": 1, "two": 2, "every": 30}, []
    ranked = [
        SimpleNamespace(candidate=SimpleNamespace(name=name, strengths=range(strengths[name]), replaced=()), gain=gain,
                        columns=AXES[:, place : place + 1], direction=AXES[:, place])
        for place, (name, gain) in enumerate(promised.items())
    ]  # fmt: skip
    found = bench(SearchSettings())
    base = SimpleNamespace(fitted=SimpleNamespace(cost=8.0, converged=True), hypothesis=SimpleNamespace(causes=()))
    with (
        patch.object(module, "chosen", lambda ranked, *_, **__: ranked),
        patch.object(module.Bench, "full_fit", lambda self, score, *_: fitted.append(score.candidate.name)),
    ):
        found.full_fits(ranked, base, base)
    assert fitted == order


@pytest.mark.parametrize(
    ("late", "name", "gain", "more", "waits"),
    [
        (True, "torsion", 0.1, {}, True),
        (False, "torsion", 0.1, {}, False),
        (True, "torsion", 0.3, {}, False),  # a quarter of what the best took is as much as a rival takes
        (True, "torsion", 0.1, {"t": 1.0}, False),
        (True, "lowpass", 0.5, {}, True),  # another form of it came to nothing
        (False, "torsion", 0.1, {"left": 0.7}, True),  # beside what takes nine tenths it could be no rival
        (False, "torsion", 0.3, {"left": 0.7}, False),
        (False, "torsion", 0.1, {"left": 0.7, "t": 1.0}, False),
    ],
)
def test_what_promises_little_beside_what_another_takes_waits_late_or_where_that_is_nearly_all(
    late, name, gain, more, waits
):
    left = (more := dict(more)).pop("left", 1.0)
    fits = [fit(ECCENTRIC, left, name="profile", **more), fit(ELSEWHERE, 7.99, name="lowpass", t=0.0)]
    fits[1].score.gain = 0.5
    asked = SimpleNamespace(candidate=SimpleNamespace(name=name, replaced=()), gain=gain)
    found = bench(SearchSettings())
    found.budget.postpones = lambda what, at_once: late or at_once
    assert found.waits(asked, fits, 8.0) is waits
