"""Which pair of effects is taken, on made-up fits: inside the bounds before outside, then the smaller of equals."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace
from unittest.mock import patch

import pytest
import torch

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.steps import pairs as steps
from gear_damping.explanation.steps.pairs import Pair, _accepted
from gear_damping.explanation.trials.bench import Bench
from gear_damping.explanation.trials.refit import Refit
from tests.explanation.decisions.made_up import NAMES, bench, fit, left, outcome, scored

BOUNDS = {"a.force": (0.0, 100.0), "a.width": (0.02, 0.5), "b.share": (-1.0, 1.0)}
MIDDLE = {"a.force": 10.0, "a.width": 0.1, "b.share": 0.3}


def model(cost, **values):
    """A model of the effects a and b that costs so much on records left out, with these values."""
    found = MIDDLE | {name.replace("_", ".", 1): value for name, value in values.items()}
    free = [SimpleNamespace(name=name) for name in BOUNDS]
    low, high = torch.tensor(list(BOUNDS.values())).T
    unknowns = SimpleNamespace(at_bound=lambda shared: (shared >= high).long() - (shared <= low).long())
    made = outcome(
        cost, cost, problem=SimpleNamespace(free=free, unknowns=unknowns), hypothesis=SimpleNamespace(free=free)
    )
    made.fitted.shared = torch.tensor([found[name] for name in BOUNDS])
    return made


def pair(cost, resting=(), t=50.0, **values):
    """A pair whose model costs so much; the first effect was fitted alone before, well inside its bounds."""
    score = SimpleNamespace(candidate=SimpleNamespace(name="a", resting=resting))
    first = Refit(score, model(0.5), 1.0, t, 1.0, True)
    second = replace(
        first, score=SimpleNamespace(candidate=SimpleNamespace(name="b", resting=())), outcome=model(cost, **values)
    )
    return Pair(first, second, False)


@pytest.mark.parametrize(
    ("values", "resting", "inside"),
    [
        ({}, (), True),
        ({"a_width": 0.02}, (), False),
        ({"a_width": 0.02}, (("a.width", -1),), True),  # finer steps would show no more: no bound of what is there
        ({"a_width": 0.5}, (("a.width", -1),), False),
        ({"a_width": 0.5}, (("a.width", 1),), True),  # a share of all there is
        ({"b_share": -1.0}, (("a.width", -1),), False),  # of the second effect
        ({"a_force": 0.0}, (("a.width", -1),), False),  # a law of which a part is nothing stands in for a simpler one
    ],
)
def test_a_pair_is_inside_its_bounds_as_each_of_its_effects_is(values, resting, inside):
    assert pair(0.1, resting, **values).is_inside is inside


@pytest.mark.parametrize(
    ("best_is_inside", "t", "taken"),
    [
        (True, 50.0, 0),
        (False, 50.0, 1),  # a law at its bound bends to what it is not
        (False, 0.5, 0),  # ... but comes before one that is not validated
    ],
)
def test_a_pair_at_a_bound_is_the_last_choice(best_is_inside, t, taken):
    pairs = [pair(0.10) if best_is_inside else pair(0.10, b_share=1.0), pair(0.15, t=t)]
    leaves = [(each.second.outcome, left(100 * each.second.outcome.left_out_cost)) for each in pairs]
    state = State(bench(SearchSettings(), leaves), outcome(), outcome())
    with patch.object(Bench, "is_as_good", lambda *_: False), patch.object(steps, "_is_told", lambda *_: True):
        assert _accepted(pairs, left(100.0), state) is pairs[taken]


@pytest.mark.parametrize(("told", "taken"), [((True, True), 0), ((False, True), 1), ((False, False), 0)])
def test_a_pair_with_a_law_of_no_known_size_takes_the_place_of_none_that_is_told(told, taken):
    """Such a law would be dropped, and the other one of the pair stay alone; where none is told the best stands."""
    pairs = [pair(0.10), pair(0.15)]
    leaves = [(each.second.outcome, left(100 * each.second.outcome.left_out_cost)) for each in pairs]
    state = State(bench(SearchSettings(), leaves), outcome(), outcome())
    of = {id(each): one for each, one in zip(pairs, told, strict=True)}
    with (
        patch.object(Bench, "is_as_good", lambda *_: False),
        patch.object(steps, "_is_told", lambda each, _: of[id(each)]),
    ):
        assert _accepted(pairs, left(100.0), state) is pairs[taken]


@pytest.mark.parametrize(
    ("replaces", "causes", "parameters", "t", "is_taken"),
    [
        (True, 2, 3, 50.0, True),  # two that had come near give way to two that predict better
        (True, 2, 2, 50.0, False),  # with more parameters it has to take a good part of what is left
        (True, 2, 3, 0.5, False),
        (True, 1, 3, 50.0, False),  # one gives way to two as one is joined by a further cause
        (False, 2, 3, 50.0, False),
    ],
)
def test_a_pair_in_the_place_of_one_of_as_many_parameters_has_to_predict_better(
    replaces, causes, parameters, t, is_taken
):
    better = replace(pair(0.9, t=t), replaces=replaces)
    present = outcome(1.0, 1.0, hypothesis=SimpleNamespace(free=[None] * parameters))
    leaves = [(better.second.outcome, left(90.0))]
    state = State(bench(SearchSettings(), leaves), outcome(), present, accepted=(SimpleNamespace(),) * causes)
    with patch.object(Bench, "is_as_good", lambda *_: False), patch.object(steps, "_is_told", lambda *_: True):
        assert (_accepted([better], left(100.0), state) is better) is is_taken


@pytest.mark.parametrize(("first", "second", "finite"), [(True, True, True), (False, True, True), (True, True, False)])
def test_a_pair_is_told_where_both_of_its_effects_are(first, second, finite):
    made = pair(0.1)
    made.second.outcome.is_finite = finite
    sizes = {"a": first, "b": second}
    with patch.object(steps, "is_told", lambda outcome, fit, evidence: sizes[fit.name]):
        state = State(bench(SearchSettings()), outcome(), outcome())
        assert steps._is_told(made, state) is (first and second and finite)


@pytest.mark.parametrize(
    ("cost", "parameters", "causes", "is_asked"),
    [
        (0.3, 3, 1, True),  # a stiffness that turns, beside which another effect is missing
        (0.6, 3, 1, False),  # it fits no better
        (0.3, 4, 1, False),  # with more parameters anything does
        (0.3, 3, 2, False),
        (0.3, 3, 0, False),
    ],
)
def test_a_pair_is_asked_for_with_what_fits_better_than_the_one_cause(cost, parameters, causes, is_asked):
    """What predicts the left-out records best may be neither of two that are missing."""
    first, other = fit(NAMES[0], cost=0.5), fit(NAMES[1], cost=cost)
    first.outcome.hypothesis, other.outcome.hypothesis = (SimpleNamespace(free=[None] * n) for n in (3, parameters))
    accepted, asked = (SimpleNamespace(name=NAMES[0]), SimpleNamespace(name=NAMES[2]))[:causes], []
    known = bench(SearchSettings(), [(first.outcome, left(10.0))])
    state = State(known, outcome(), first.outcome, accepted, (scored(3, 0.2),), first_fits=(first, other))
    with patch.object(steps, "_seconds", lambda base, _, promised: asked.append((base, promised)) or []):
        assert steps.with_pair_of_a_nearer(state) is None
    assert asked == ([(other, 0.5 * 0.8)] if is_asked else [])


@pytest.mark.parametrize(("promised", "fitted"), [(inf, 3), (0.41, 2), (0.21, 1), (0.15, 0)])
def test_beside_a_nearer_cause_only_what_promises_to_leave_less_is_fitted(promised, fitted):
    """The base leaves 1, and of three effects two promise to take .8 and .75 of it, the third .3."""
    plain = SimpleNamespace(cause=SimpleNamespace(simpler=None))
    state = State(bench(SearchSettings(), library=dict.fromkeys(NAMES, plain)), outcome(), outcome())
    ranked = [scored(place, gain) for place, gain in enumerate((0.8, 0.75, 0.3))]
    kind = type(state.bench)
    with patch.object(kind, "ranked", lambda *_: ranked), patch.object(kind, "full_fit", lambda *_: fit(cost=0.1)):
        assert len(steps._seconds(fit(cost=1.0), state, promised)) == fitted


def test_no_pair_begins_with_what_was_dropped_as_of_no_known_size():
    """It would take the place of the cause that was found without it, and be dropped again with that."""
    first, other = fit(NAMES[0], cost=0.5), fit(NAMES[1], cost=0.3)
    plain, found = SimpleNamespace(cause=SimpleNamespace(simpler=None)), []
    for names in (NAMES[:2], NAMES[:1]):
        known = bench(SearchSettings(), [], library=dict.fromkeys(names, plain))
        state = State(known, outcome(), first.outcome, (SimpleNamespace(name=NAMES[0]),), first_fits=(first, other))
        with patch.object(steps, "_bases", lambda fits, _: found.append([one.name for one in fits]) or []):
            assert steps._instead(state) == []
    assert found == [list(NAMES[:2]), list(NAMES[:1])]
