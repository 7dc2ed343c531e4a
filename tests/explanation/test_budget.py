"""The time of a search: a part of it is kept for what is under way and for the records that are opened at the end."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace

import pytest

from gear_damping.explanation.budget import Budget
from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.explain import _with_the_last_time
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.steps import pairs
from gear_damping.explanation.trials import bench as benches
from gear_damping.explanation.trials.bench import Bench
from tests.explanation.decisions.made_up import bench, fit


@dataclass(frozen=True)
class Named:
    """A candidate of one strength."""

    name: str
    strengths: Sequence[int] = (0,)


class Clock:
    """A clock that is set by hand."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_the_search_is_over_before_the_time_is():
    clock = Clock()
    made = Budget(5.0, clock)
    for second, is_over in ((240.0, False), (260.0, True)):
        clock.now = second
        assert made.spent is is_over
        assert made.refuses("pairs of effects") is is_over
    assert "5 minutes" in made.sentence
    assert made.sentence.endswith("explain.minutes=20 gives it more.")
    assert made.not_tried == ["pairs of effects"]


def test_what_comes_last_has_time_when_the_search_is_over():
    clock = Clock()
    made = Budget(5.0, clock)
    for second, is_over in ((260.0, False), (289.0, False), (293.0, True)):
        clock.now = second
        assert made.refuses("what it stands in for", is_last=True) is is_over
        assert made.all_spent is is_over


def test_what_promises_little_waits_from_half_of_the_time_on_and_is_noted_until_it_is_asked_for_again():
    clock = Clock()
    made = Budget(5.0, clock)
    for second, is_late in ((149.0, False), (151.0, True)):
        clock.now = second
        assert made.postpones("shaft_torsion") is is_late
        assert made.postpones("tip_relief", at_once=True)
    made.postpones("sensor_lowpass")
    clock.now = 260.0
    assert made.refuses("tooth_crack")
    assert made.refuses("sensor_lowpass")
    made.asks_again(["shaft_torsion", "tip_relief", "profile_error", "tooth_crack", "sensor_lowpass"])
    assert made.not_tried == ["sensor_lowpass", "tooth_crack"]  # there was no time for these at all


def test_effects_are_scored_until_what_scores_are_for_needs_the_time():
    clock = Clock()
    made = Budget(5.0, clock)
    for second, is_over in ((260.0, False), (274.0, False), (278.0, True), (279.0, True)):
        clock.now = second
        assert made.refuses_score("tooth_crack") is is_over
    assert made.not_tried == ["tooth_crack"]


def test_the_first_cause_is_tried_in_the_time_that_is_kept_too():
    clock = Clock()
    made = Budget(5.0, clock)
    with made.looking():
        clock.now = 100.0
    cases = ((140.0, False, False), (160.0, False, True), (250.0, False, True), (260.0, True, True))
    for second, first, further in cases:
        clock.now = second
        with made.trying(is_first=True):
            assert made.spent is first
        with made.trying(is_first=False):
            assert made.spent is further
        assert made.spent is further


def test_the_last_fits_go_on_in_the_time_that_was_kept_for_them():
    clock = Clock()
    budget = Budget(5.0, clock)
    evidence = Evidence("oscillator", (), (), {}, None, one_record=True, is_over=lambda: budget.spent)
    bench = Bench(evidence, None, print, None, None, budget=budget)
    later = _with_the_last_time(State(bench, None, None)).bench.evidence
    for second, search, last in ((200.0, False, False), (260.0, True, False), (293.0, True, True)):
        clock.now = second
        assert (evidence.is_over(), later.is_over()) == (search, last)


def test_time_is_kept_for_the_last_looks_where_one_takes_long():
    """Of 300 s two and a half looks of 40 s leave 200; of 10 s the usual share is more; half is for the search."""
    for look, last in ((40.0, 200.0), (10.0, 255.0), (100.0, 150.0)):
        clock = Clock()
        made = Budget(5.0, clock)
        with made.looking():
            clock.now = look
        with made.looking():
            clock.now += 1.0  # the longest counts
        for second, is_over in ((last - 1, False), (last + 1, True)):
            clock.now = second
            assert made.spent is is_over


def test_no_second_effect_is_fitted_once_the_time_is_over():
    """Whether there is time is asked before each fit, and not before the first one for all of them."""
    clock, fitted = Clock(), []
    budget = Budget(5.0, clock)

    def full_fit(score, *_):
        fitted.append(score.candidate.name)
        clock.now = 290.0

    candidates = [SimpleNamespace(name=name, own_levels=False) for name in ("a", "b", "c")]
    scores = [SimpleNamespace(gain=1.0, candidate=candidate) for candidate in candidates]
    cause = SimpleNamespace(cause=SimpleNamespace(simpler=None))
    evidence = SimpleNamespace(library=dict.fromkeys("abc", cause))
    bench = SimpleNamespace(
        budget=budget, full_fit=full_fit, evidence=evidence, settings=SearchSettings(), goal=lambda _: 0.0,
        ranked=lambda _: scores, worth=lambda ranked, *_: ranked,
    )  # fmt: skip
    state = SimpleNamespace(bench=bench, outcome=None, accepted=("one",))
    assert pairs._seconds(SimpleNamespace(name="base", outcome=None), state) == []
    assert fitted == ["a"]
    assert budget.not_tried[0] == "base with b"


@pytest.mark.parametrize(
    ("t", "ends", "tried"), [(1.0, 200.0, ["a", "b", "c"]), (1.0, 245.0, ["a"]), (50.0, 200.0, ["a"])]
)
def test_until_something_is_found_time_is_kept_for_one_look(t, ends, tried, monkeypatch):
    """A null was said to hide something, as two of five minutes were kept for looks at causes that there were not."""
    clock, fitted = Clock(), []
    budget = Budget(5.0, clock)
    with budget.looking():
        clock.now = 60.0  # of which two and a half are kept where there is something to look at

    def full_fit(self, score, *_):
        fitted.append(score.candidate.name)
        clock.now = ends
        return fit(score.candidate.name, cost=9.0, t=t)

    monkeypatch.setattr(benches, "chosen", lambda ranked, *_, **__: ranked)
    monkeypatch.setattr(Bench, "full_fit", full_fit)
    ranked = [SimpleNamespace(candidate=Named(name), gain=0.5 - 0.1 * place) for place, name in enumerate("abc")]
    base = SimpleNamespace(fitted=SimpleNamespace(cost=10.0, converged=True), hypothesis=SimpleNamespace(causes=()))
    monkeypatch.setattr(Bench, "_is_enough", lambda *_: False)
    monkeypatch.setattr(Bench, "waits", lambda *_: False)
    replace(bench(SearchSettings()), budget=budget).full_fits(ranked, base, base)
    assert fitted == tried
