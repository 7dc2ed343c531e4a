"""What a search does next, on made-up models: nothing more, a faint cause, or a further one."""

from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import patch

import pytest

from gear_damping.explanation import search
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from tests.explanation.decisions.made_up import bench, left, outcome


def step_after(rest, accepted=True, first=10.0, visible=True, beyond=None, alone=""):
    """The step that is taken where the nominal model leaves `first` % and the present one `rest`.

    Args:
        rest: What the present model leaves beyond the noise as it is known now.
        accepted: Whether a cause is.
        first: What the nominal model leaves.
        visible: Whether what is left is not random.
        beyond: % that the present model leaves beyond the noise of the sensor, where that is another one.
        alone: What is said of records that a model of its own follows each.
    """
    nominal, present = outcome(), outcome()
    known = bench(SearchSettings(), [(nominal, left(first, 40.0)), (present, rest)])
    state = State(known, nominal, present, accepted=(SimpleNamespace(name="a"),) if accepted else ())
    state = replace(state, left=SimpleNamespace(visible=visible))
    of_sensor = left(rest.percent if beyond is None else beyond, 1.0)
    taken = []
    none = {
        name: patch.object(search, name, lambda s, name=name: taken.append(name) or (s, None, ()))
        for name in ("faint_cause", "single_cause")
    }
    pairs = (patch.object(search, name, lambda s: None) for name in ("with_pair", "with_pair_of_as_many"))
    measured = patch.object(State, "beyond_sensor", lambda *_: of_sensor)
    each = patch.object(search, "followed_one_by_one", lambda _: alone)
    with measured, each, none["faint_cause"], none["single_cause"], next(pairs), next(pairs):
        search._with_more(state)
    return taken


@pytest.mark.parametrize(
    ("rest", "accepted", "step"),
    [
        (left(0.05, 1.1), True, []),  # the form of a cause that is right: a name for it would be one for nothing
        (left(0.05, 1.1, threshold=5.0), False, ["faint_cause"]),  # held-out power is blind, the score may not be
        (left(1.0, 1.5, threshold=5.0), True, ["faint_cause"]),
        (left(3.0, 12.0), True, ["single_cause"]),
    ],
)
def test_what_is_done_next(rest, accepted, step):
    assert step_after(rest, accepted) == step


@pytest.mark.parametrize(
    ("visible", "beyond", "step"),
    [
        (False, 49.0, ["single_cause"]),  # a hardening spring whose linear model misses half of the motion
        (True, 68.0, ["single_cause"]),
        (False, 2.0, []),  # what a random load may do
        (True, 2.0, ["faint_cause"]),
    ],
)
def test_what_is_missed_grossly_is_looked_for_however_random_it_looks(visible, beyond, step):
    """So much coloured noise hides it, and few held-out records tell little of it."""
    rest = left(30.0, 1.3, threshold=73.0)
    assert step_after(rest, accepted=False, first=30.0, visible=visible, beyond=beyond) == step
    one_by_one = step_after(rest, accepted=False, first=30.0, visible=visible, beyond=beyond, alone="each its own")
    assert one_by_one == (["faint_cause"] if visible else [])


@pytest.mark.parametrize(("leaves", "at_once"), [(0.2, False), (0.9, True)])
def test_second_thoughts_about_causes_that_take_nearly_all_wait(leaves, at_once, monkeypatch):
    """Two right causes took 96 % after 108 s, and second thoughts the rest of five minutes."""
    thought, nominal, after = [], outcome(1.0), outcome(0.1)
    known = bench(SearchSettings(taken_by_all=0.9), [(nominal, left(5.0, 12.0)), (after, left(leaves, 3.0))])
    in_time, late = (replace(known, budget=SimpleNamespace(postpones=lambda _, late=late: late)) for late in (0, 1))
    best = SimpleNamespace(outcome=after)
    monkeypatch.setattr(State, "accepting", lambda state, *_: replace(state, outcome=after, accepted=(None, None)))
    monkeypatch.setattr(search, "_calibrated_anew", lambda *_: None)
    monkeypatch.setattr(search, "with_pair_of_a_nearer", lambda state: None)
    monkeypatch.setattr(search, "single_cause", lambda state: (state, best, ()))
    monkeypatch.setattr(search, "_of_records_instead", lambda *found: found)
    monkeypatch.setattr(search, "exchanged", lambda state: thought.append(state) or state)
    monkeypatch.setattr(search, "with_pair_instead", lambda state: state)
    state, goes_on = search._with_more(State(in_time, nominal, nominal))
    assert (goes_on, len(thought)) == (True, at_once)
    for known, times in ((late, at_once), (in_time, 1)):
        search._thought_over(replace(state, bench=known))
        assert len(thought) == times
