"""A cause that takes little of what is left, as most of that is a noise of another colour, is looked for beside it."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.steps.hidden import cause_beside_random
from tests.explanation.decisions.made_up import NAMES, bench, fit, left, outcome

FRICTION, POWER = NAMES[:2]
QUIET, SHOWS = SimpleNamespace(visible=False), SimpleNamespace(visible=True)


def found(monkeypatch, fits, *, seen=SHOWS, beside=QUIET, refused=False):
    """What is accepted of these fits beside a nominal model that leaves .13 %, of which most is noise."""
    nominal = outcome()
    made = bench(SearchSettings(), [(nominal, left(0.13))])
    quieter = bench(SearchSettings(), [(nominal, left(0.03)), *((one.outcome, left(0.003)) for one in fits)])
    monkeypatch.setattr(type(made), "ranked", lambda *_: [])
    monkeypatch.setattr(type(made), "assessed", lambda *_: beside)
    monkeypatch.setattr(type(made), "knowing", lambda *_: quieter)
    monkeypatch.setattr(type(made), "simplest", lambda self, best, others: (best, ()))
    monkeypatch.setattr(type(made.budget), "refuses", lambda *_: refused)
    state, best, _ = cause_beside_random(State(made, nominal, nominal, rejected=tuple(fits), left=seen))
    return best and (best.name, state.bench is quieter)


def test_the_best_fit_beside_which_nothing_shows_is_one(monkeypatch):
    """A friction took a quarter of what a decay left, and a noise of the first order the rest."""
    assert found(monkeypatch, [fit(FRICTION, t=3.4), fit(POWER, t=3.1)]) == (FRICTION, True)
    assert found(monkeypatch, [fit(FRICTION, t=3.4, is_seen_in_fit=False), fit(POWER, t=3.1)]) == (POWER, True)


@pytest.mark.parametrize(
    "said",
    [
        {"seen": QUIET},  # nothing was visible
        {"seen": None},
        {"beside": SHOWS},  # and something still is
        {"beside": None},
        {"refused": True},
    ],
)
def test_there_is_none_otherwise(said, monkeypatch):
    assert found(monkeypatch, [fit(FRICTION, t=3.4)], **said) is None


def test_it_is_born_out_by_what_is_left_out_and_one_for_all(monkeypatch):
    assert found(monkeypatch, [fit(FRICTION, t=2.9), fit(POWER, t=3.1)]) is None
    assert found(monkeypatch, [fit(FRICTION, t=3.4, differs=True)]) is None
    assert found(monkeypatch, []) is None
