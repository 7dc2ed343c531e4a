"""What a search does next, on made-up models: nothing more, a faint cause, or a further one."""

from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import patch

import pytest

from gear_damping.explanation import search
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from tests.explanation.decisions.made_up import bench, left, outcome


def step_after(rest, accepted=True, first=10.0):
    """The step that is taken where the nominal model leaves `first` % and the present one `rest`."""
    nominal, present = outcome(), outcome()
    known = bench(SearchSettings(), [(nominal, left(first, 40.0)), (present, rest)])
    state = State(known, nominal, present, accepted=(SimpleNamespace(name="a"),) if accepted else ())
    state = replace(state, left=SimpleNamespace(visible=True))
    taken = []
    none = {
        name: patch.object(search, name, lambda s, name=name: taken.append(name) or (s, None, ()))
        for name in ("faint_cause", "single_cause")
    }
    pairs = (patch.object(search, name, lambda s: None) for name in ("with_pair", "with_pair_of_as_many"))
    with none["faint_cause"], none["single_cause"], next(pairs), next(pairs):
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
