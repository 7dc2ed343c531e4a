"""Laws of an oscillator that converged far off are tried again from where the best one lies; on made-up fits."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.steps import single
from gear_damping.explanation.steps.single import FAR
from gear_damping.physics.systems.known import SYSTEMS

NOMINAL = ("stiffness", "force_gain")


def fit(name, cost, non_nested=True, **values):
    candidate = SimpleNamespace(name=name, non_nested=non_nested)
    outcome = SimpleNamespace(fitted=SimpleNamespace(cost=cost), values=values)
    return SimpleNamespace(name=name, outcome=outcome, score=SimpleNamespace(candidate=candidate))


def tried(monkeypatch, fits, found, system="oscillator", spent=False):
    """The fits afterwards, and the values that the model was settled at (None: nowhere)."""
    settled = []
    monkeypatch.setattr(single, "settled_at", lambda hypothesis, values: settled.append(values))
    monkeypatch.setattr(single, "fit_hypothesis", lambda *a, **k: SimpleNamespace(is_finite=True))
    bench = SimpleNamespace(
        evidence=SimpleNamespace(has=SYSTEMS[system].has),
        budget=SimpleNamespace(refuses=lambda what: spent),
        solver=None,
        ranked=lambda outcome, names: [one.score for one in fits if one.name in names],
        full_fit=lambda score, place, against: found.get(score.candidate.name),
    )
    free = [SimpleNamespace(name=name) for name in NOMINAL]
    nominal = SimpleNamespace(hypothesis=None, problem=SimpleNamespace(free=free))
    kept = single._from_the_best(fits, SimpleNamespace(bench=bench, nominal=nominal))
    return kept, settled[0] if settled else None


def laws(**more):
    best = fit("cubic_stiffness", 3.0, stiffness=19.4, force_gain=4.9, **{"cubic_stiffness.coefficient": -2.4})
    return [best, fit("sine_restoring", 2 * FAR * 3.0, **more)]


def test_a_law_that_lies_far_off_is_tried_again_from_the_best(monkeypatch):
    better = fit("sine_restoring", 2.9)
    kept, settled = tried(monkeypatch, laws(), {"sine_restoring": better})
    assert [one.outcome.fitted.cost for one in kept] == [3.0, 2.9]
    assert settled == {"stiffness": 19.4, "force_gain": 4.9}  # what the nominal model shares with it, and no more


def test_what_is_no_better_from_there_stays(monkeypatch):
    fits = laws()
    for found in ({"sine_restoring": fit("sine_restoring", 1e9)}, {"sine_restoring": None}):
        assert tried(monkeypatch, fits, found)[0] == fits


@pytest.mark.parametrize(("system", "spent"), [("gear_pair", False), ("oscillator", True)])
def test_a_gear_pair_and_a_search_without_time_try_nothing(monkeypatch, system, spent):
    fits = laws()
    assert tried(monkeypatch, fits, {"sine_restoring": fit("sine_restoring", 1.0)}, system, spent) == (fits, None)


def test_what_lies_near_is_left(monkeypatch):
    fits = [fit("cubic_stiffness", 3.0, stiffness=1.0), fit("sine_restoring", 0.9 * FAR * 3.0)]
    assert tried(monkeypatch, fits, {"sine_restoring": fit("sine_restoring", 1.0)}) == (fits, None)
