"""What differs from record to record is the last explanation: only where what is one for all leaves far more."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.steps import pairs, single
from gear_damping.explanation.trials.bench import smallest
from gear_damping.explanation.trials.refit import chosen
from tests.explanation.decisions.made_up import bench, fit, left, outcome, scored


def searched(*fits):
    """A state whose nominal model leaves 10 %, and every fit as much less as it leaves fewer squares."""
    nominal = outcome()
    leaves = [(one.outcome, left(10.0 * one.outcome.left_out_cost)) for one in fits]
    known = bench(SearchSettings(), [(nominal, left(10.0)), *leaves])
    return State(known, nominal, nominal, rejected=fits)


@pytest.mark.parametrize(
    ("leaves", "t", "taken"),
    [(0.30, 50.0, "levels"), (0.15, 50.0, "law"), (0.30, 1.0, None), (None, 50.0, None)],
    ids=["a law leaves far more", "a law leaves hardly more", "the law is not validated", "no law"],
)
def test_what_is_one_for_all_goes_first(leaves, t, taken):
    levels = fit("levels", squares=0.1, differs=True)
    fits = [levels] if leaves is None else [levels, fit("law", squares=leaves, t=t)]
    best = single._best(fits, searched(*fits))
    assert (best and best.name) == taken


@pytest.mark.parametrize(("leaves", "taken"), [(0.09, "law"), (0.11, "levels")])
def test_a_law_that_foretells_nearly_all_goes_before_figures_that_left_out_records_are_fitted_with(leaves, taken):
    """Four motions of a screw against dry friction: 97.1 % is foretold, and 99.7 % fitted."""
    fits = [fit("levels", squares=0.02, differs=True), fit("law", squares=leaves)]
    assert single._best(fits, searched(*fits)).name == taken


def test_a_figure_of_each_record_is_no_simpler_law():
    fits = [fit("levels", squares=0.02, differs=True), fit("law", squares=0.09)]
    for one in fits:
        one.outcome.hypothesis = SimpleNamespace(free=(None,) * 5)
    assert smallest(fits).name == "law"


@pytest.mark.parametrize(("t", "is_taken"), [(50.0, True), (1.0, False)])
def test_it_is_taken_last_of_all(t, is_taken, monkeypatch):
    state = searched(fit("law", t=1.0), fit("levels", t=t, differs=True))
    monkeypatch.setattr(State, "accepting", lambda self, best, rivals: best)
    found = single.cause_of_records(state)
    assert (found is not None) == is_taken
    assert found is None or found.name == "levels"


@pytest.mark.parametrize(("gain", "is_tried"), [(0.9, True), (0.46, True), (0.4, False)])
def test_it_is_fitted_where_it_promises_as_much_as_any(gain, is_tried):
    scores = [scored(0, 0.5), scored(1, gain), scored(2, 0.3)]
    scores[1].candidate.own_levels = True
    ranked = sorted(scores, key=lambda score: -score.gain)
    assert (scores[1] in chosen(ranked, SearchSettings())) == is_tried


def test_it_is_no_part_of_a_pair():
    found = [fit("levels", differs=True), fit("law")]
    state = SimpleNamespace(names=(), bench=SimpleNamespace(settings=SearchSettings()))
    assert [one.name for one in pairs._bases(found, state)] == ["law"]
