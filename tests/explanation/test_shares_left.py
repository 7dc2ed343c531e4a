"""What is left of several causes has the share of what all of them took that it takes by itself."""

import pytest

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import Accepted, State
from tests.explanation.decisions.made_up import NAMES, bench, fit, left, outcome


@pytest.mark.parametrize(("leaves", "share"), [(0.3, 0.97), (6.0, 0.4)])
def test_of_two_that_came_together(leaves, share):
    """A softening took 97 % by itself; a hysteresis came with it, of no known size, and went with half of that."""
    nominal, both, alone = outcome(), outcome(), outcome()
    bare = bench(SearchSettings(), [(nominal, left(10.0)), (both, left(0.2)), (alone, left(leaves))])
    causes = tuple(Accepted(name, fit(name), 0.98 / 2, ()) for name in NAMES[:2])
    state = State(bare, nominal, both, accepted=causes)
    (kept,) = state.left_of({NAMES[0]}, alone)
    assert kept.name == NAMES[1]
    assert kept.share == pytest.approx(share)
    assert state.left_of(NAMES[:2], nominal) == ()
