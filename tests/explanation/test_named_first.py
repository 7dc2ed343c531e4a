"""Which of several effects that the data do not tell apart is named first, on made-up fits."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.trials import bench as benches
from tests.explanation.decisions.made_up import NAMES, bench, fit, left

SATURATION, POWER, CRACK = NAMES[9], NAMES[1], NAMES[11]


def tried(name, parameters, gain):
    one = fit(name, squares=1.0 / gain, gain=gain)
    one.outcome.hypothesis = SimpleNamespace(free=range(parameters))
    one.outcome.is_finite = True
    return one


@pytest.fixture
def named_first(monkeypatch):
    """Of fits, none of which is told apart or contains another."""
    monkeypatch.setattr(benches.Bench, "_is_rival", lambda *_: True)
    monkeypatch.setattr(benches, "contains", lambda *_: False)
    monkeypatch.setattr(benches.Bench, "_not_encompassed", lambda self, best, alike: list(alike))
    monkeypatch.setattr(benches.Bench, "_plain_form", lambda self, one, fits: one)
    untold, bending = [], []
    monkeypatch.setattr(benches, "is_told", lambda outcome, refit, evidence: refit.name not in untold)
    monkeypatch.setattr(benches, "has_figure", lambda outcome, refit, evidence: refit.name not in bending)

    def first(*fits, of_any_size=(), without_figure=()):
        untold[:], bending[:] = of_any_size, without_figure
        leaves = [(one.outcome, left(1.0)) for one in fits]
        best, others = bench(SearchSettings(), leaves).simplest(max(fits, key=lambda one: one.gain), fits)
        assert {best.name, *others} == {one.name for one in fits}
        return best.name

    return first


def with_scores(*fits):
    for one in fits:
        one.score = None
    return fits


def test_the_simpler_of_two_that_take_as_much(named_first):
    assert named_first(*with_scores(tried(POWER, 3, 1.0), tried(SATURATION, 2, 0.97))) == SATURATION


def test_not_the_simpler_where_it_takes_far_less_and_records_are_few(named_first):
    """A coasting car: saturation took 42 % of what was missing, a power law 68 %; one record told neither away."""
    assert named_first(*with_scores(tried(POWER, 3, 0.68), tried(SATURATION, 2, 0.42))) == POWER
    three = with_scores(tried(POWER, 3, 0.68), tried(SATURATION, 2, 0.42), tried(CRACK, 2, 0.66))
    assert named_first(*three) == CRACK


def test_one_of_any_size_comes_last(named_first):
    """An arm in presliding took a second mode for its hysteresis, which was dropped after three more causes."""
    fits = with_scores(tried(POWER, 3, 1.0), tried(SATURATION, 2, 0.97))
    assert named_first(*fits, of_any_size=(SATURATION,)) == POWER
    assert named_first(*fits, of_any_size=(SATURATION, POWER)) == SATURATION


def test_one_without_a_figure_comes_last_and_gives_way_to_what_takes_less(named_first):
    """A friction took four fifths of what an exponent and a coefficient did of which neither was known."""
    fits = with_scores(tried(POWER, 2, 1.0), tried(SATURATION, 2, 0.8))
    assert named_first(*fits) == POWER
    assert named_first(*fits, without_figure=(POWER,)) == SATURATION
    assert named_first(*fits, without_figure=(POWER, SATURATION)) == POWER


@pytest.mark.parametrize(("of_any_size", "first"), [((), SATURATION), ((SATURATION,), POWER)])
def test_what_has_run_into_a_bound_gives_way_to_none_of_any_size(of_any_size, first, named_first):
    fits = with_scores(tried(POWER, 2, 1.0), tried(SATURATION, 3, 0.97))
    fits[0].is_at_bound = True
    assert named_first(*fits, of_any_size=of_any_size) == first


@pytest.mark.parametrize(
    ("sized", "first"), [({"coulomb_friction"}, "coulomb_friction"), (set(), "asymmetric_friction")]
)
def test_the_simpler_law_is_named_where_the_richer_one_takes_more_and_has_no_figure(sized, first, monkeypatch):
    """A decay of little noise told two frictions from one by a thousandth of what was missing, and neither of both."""
    made, fits = bench(SearchSettings()), [fit("asymmetric_friction"), fit("coulomb_friction")]
    monkeypatch.setattr(benches.Bench, "is_further", lambda *_: True)
    monkeypatch.setattr(benches.Bench, "_is_sized", lambda self, one: one.name in sized)
    assert made._plain_form(fits[0], fits).name == first
    monkeypatch.setattr(benches.Bench, "is_further", lambda *_: False)
    assert made._plain_form(fits[0], fits).name == "coulomb_friction"


def test_what_contains_one_that_does_as_well_is_no_rival_of_it():
    """A friction of one size was found beside a profile error, and with it one of two sizes that says the same."""
    names = ["coulomb_friction", "asymmetric_friction", POWER, POWER]
    assert bench(SearchSettings()).rivals("coulomb_friction", names) == (POWER,)
    assert bench(SearchSettings()).rivals("asymmetric_friction", names) == ("coulomb_friction", POWER)


def test_what_is_no_candidate_any_more_is_no_rival():
    made = bench(SearchSettings())
    left = {name: kind for name, kind in made.evidence.library.items() if name != "coulomb_friction"}
    made.evidence.library = left
    assert made.rivals("cubic_stiffness", ["coulomb_friction", POWER]) == (POWER,)
