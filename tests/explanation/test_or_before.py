"""A search does not end with less than it had on the way, on made-up states."""

from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import patch

import pytest

from gear_damping.explanation import search
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from tests.explanation.decisions.made_up import bench, left, outcome

UNTOLD = "of no known size"
AT_BOUND = "at a bound"


def states(*found):
    """Where a search ended by way of others: causes by name, and what they leave in %, the last ones at its end."""
    models = [outcome() for _ in found]
    where = bench(SearchSettings(), [(m, left(leaves)) for m, (_, leaves) in zip(models, found, strict=True)])
    accepted = [tuple(SimpleNamespace(name=name) for name in names) for names, _ in found]
    *passed, last = (State(where, models[0], m, a) for m, a in zip(models, accepted, strict=True))
    return replace(last, passed=tuple(passed))


def chosen(found, is_as_good=False):
    last = states(*found)
    kept = lambda state: state if UNTOLD not in state.names else SimpleNamespace(names=frozenset())  # noqa: E731
    with (
        patch.object(search, "told", kept),
        patch.object(type(last.bench), "is_as_good", lambda *_: is_as_good),
        patch.object(State, "is_at_bound", lambda _, cause: cause.name == AT_BOUND),
    ):
        return [cause.name for cause in search._or_before(last).accepted]


@pytest.mark.parametrize(
    ("found", "named"),
    [
        ([(["a"], 1.4), (["a", "b"], 0.5), (["b"], 4.0)], ["a"]),  # no more causes, and less is left
        ([(["a"], 1.4), (["b"], 0.5)], ["b"]),
        ([(["a", "b"], 0.5), (["c"], 4.0)], ["c"]),  # more causes are no better for that
        ([(["a"], 1.4), ([], 9.0)], ["a"]),  # one is better than none
        ([([UNTOLD], 1.0), (["a"], 2.0), (["b"], 4.0)], ["a"]),
        ([([UNTOLD], 1.0), (["b"], 4.0)], ["b"]),
        ([([AT_BOUND], 1.0), (["b"], 4.0)], ["b"]),
        ([([AT_BOUND], 1.0), (["a"], 2.0), (["b"], 4.0)], ["a"]),
        ([([AT_BOUND], 1.0), ([], 4.0)], [AT_BOUND]),
    ],
)
def test_what_leaves_least_of_no_more_causes_is_taken(found, named):
    assert chosen(found) == named


def test_what_predicts_no_better_by_the_paired_test_is_left():
    assert chosen([(["a"], 1.4), (["b"], 4.0)], is_as_good=True) == ["b"]
