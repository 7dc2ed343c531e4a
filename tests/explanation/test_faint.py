"""What is tried where left-out residuals are too blunt, on made-up scores."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation import search
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.steps import faint
from gear_damping.explanation.steps.faint import faint_cause
from gear_damping.explanation.trials.refit import chosen
from gear_damping.physics.systems.traits import Trait
from tests.explanation.decisions.made_up import NAMES, bench, fit, left, outcome, scored
from tests.explanation.decisions.of_trials import is_determined_within

SHOWING, LARGE, SMALL = NAMES[:3]
KIND = SimpleNamespace(cause=SimpleNamespace(simpler=None))
OTHER, OF_RECORDS = (
    SimpleNamespace(name=name, candidate=SimpleNamespace(own_levels=own)) for name, own in (("other", 0), ("own", 1))
)


def tried(gains, shows, refused=(), cheap=False, accepted=(), waiting=(), many=()):
    """The effects that get a full fit, in order: of these predicted gains, where these show beyond chance.

    Some wait for another round, and some have many numbers.
    """
    fitted = []
    bench = SimpleNamespace(
        settings=SearchSettings(),
        evidence=SimpleNamespace(has=lambda trait: trait is Trait.REST and cheap),
        budget=SimpleNamespace(refuses=lambda name: name in refused),
        full_fit=lambda score, *_, **__: fitted.append(score.candidate.name),
        waits=lambda score, *_: score.candidate.name in waiting,
    )
    visible = SimpleNamespace(shows=lambda name: name in shows, by_name=dict.fromkeys(shows, 10.0))
    scores = tuple(scored(place, gain) for place, gain in enumerate(gains))
    for score in scores:
        score.candidate.strengths = range(30 if score.candidate.name in many else 1)
    left = SimpleNamespace(visible=visible)
    state = State(bench, outcome(), outcome(), accepted=accepted, ranked=scores, left=left)
    assert faint_cause(state)[1:] == (None, ())
    return fitted


@pytest.mark.parametrize(
    ("gains", "shows", "expected"),
    [
        ((0.01, 0.9, 0.01), (SHOWING,), [SHOWING, LARGE]),  # a large promise is tried though noise hides it
        ((0.01, 0.2, 0.01), (SHOWING,), [SHOWING]),  # less than a quarter of what is left
        ((0.01, 0.2, 0.01), (), []),
        ((0.0, 0.2, 0.01), (SHOWING,), []),
    ],
)
def test_what_is_worth_a_full_fit(gains, shows, expected):
    assert tried(gains, shows) == expected


def test_what_shows_keeps_no_large_promise_from_being_tried():
    """Four show, as shadows of a soft bearing may; the fifth promises most, and the sixth less than a quarter."""
    assert tried((0.1, 0.1, 0.1, 0.1, 0.9, 0.2), NAMES[:4]) == [*NAMES[:4], NAMES[4]]


def test_errors_of_every_tooth_come_last_and_what_promises_little_beside_a_fit_waits():
    """Of 68 s for errors of 38 teeth that promised a tenth of what a low-pass took."""
    gains = (0.5, 0.9, 0.6)
    assert tried(gains, NAMES[:3], many=(SHOWING,)) == [LARGE, SMALL, SHOWING]
    assert tried(gains, NAMES[:3], waiting=(SMALL,)) == [SHOWING, LARGE]


def test_a_budget_refuses_by_name():
    assert tried((0.01, 0.9, 0.5), (SHOWING,), refused=(LARGE,)) == [SHOWING, SMALL]


@pytest.mark.parametrize(
    ("gains", "shows", "expected"),
    [
        ((0.01, 0.2, 0.1), (SHOWING,), [SHOWING, LARGE, SMALL]),
        ((0.01, 0.2, 0.1), (), []),  # nothing is sought where nothing shows
    ],
)
def test_where_fits_are_cheap_whatever_may_be_meant_is_tried(gains, shows, expected):
    assert tried(gains, shows, cheap=True) == expected


@pytest.mark.parametrize(("cheap", "expected"), [(False, [SHOWING]), (True, [SHOWING, LARGE, SMALL])])
def test_what_is_tried_beside_a_cause(cheap, expected):
    """A law of damping takes its part from what another one was fitted to, and no linear score foresees it."""
    assert tried((0.01, 0.2, 0.1), (SHOWING,), cheap=cheap, accepted=(OTHER,)) == expected


@pytest.mark.parametrize(
    ("accepted", "is_tried"), [((), True), ((OF_RECORDS,), True), ((OTHER,), False), ((OF_RECORDS, OTHER), False)]
)
def test_what_differs_between_records_is_tried_beside_nothing_that_is_one_for_all(accepted, is_tried, monkeypatch):
    asked = []
    monkeypatch.setattr(faint, "_of_records", lambda scores, state: asked.append(len(scores)) or (state, None, ()))
    differing = scored(0, 0.9)
    differing.candidate.own_levels = True
    bench = SimpleNamespace(
        settings=SearchSettings(),
        evidence=SimpleNamespace(has=lambda trait: False),
        budget=SimpleNamespace(refuses=lambda name: False),
    )
    visible = SimpleNamespace(shows=lambda name: True, by_name={differing.candidate.name: 10.0})
    left = SimpleNamespace(visible=visible)
    faint_cause(State(bench, outcome(), outcome(), accepted=accepted, ranked=(differing,), left=left))
    assert asked == [int(is_tried)]


def kept(gains, shows, most, monkeypatch, cheap):
    """The effects whose fits are kept beside a cause, of these predicted gains, where these take most."""
    bench = SimpleNamespace(
        settings=SearchSettings(),
        evidence=SimpleNamespace(has=lambda trait: trait is Trait.REST and cheap),
        budget=SimpleNamespace(refuses=lambda name: False),
        waits=lambda *_: False,
        full_fit=lambda score, *_, **__: SimpleNamespace(name=score.candidate.name, gain=1.0, fit_gain=1.0),
        converged=lambda fit, _: fit,
        takes_most=lambda fit, _: fit.name in most,
    )
    monkeypatch.setattr(faint, "_is_worth", lambda *_: False)
    monkeypatch.setattr(State, "is_validated", lambda *_: False)
    visible = SimpleNamespace(shows=lambda name: name in shows, by_name=dict.fromkeys(shows, 10.0))
    scores = tuple(scored(place, gain) for place, gain in enumerate(gains))
    accepted = (OTHER,)
    state = State(bench, outcome(), outcome(), accepted=accepted, ranked=scores, left=SimpleNamespace(visible=visible))
    return [fit.name for fit in faint_cause(state)[0].rejected]


@pytest.mark.parametrize("most", [(), (SMALL,)])
def test_beside_a_cause_what_no_score_foresaw_has_to_take_most_of_what_is_left(most, monkeypatch):
    """The second promises a third, the third a tenth, and neither shows."""
    assert kept((0.01, 0.3, 0.1), (SHOWING,), most, monkeypatch, cheap=True) == [SHOWING, LARGE, *most]


@pytest.mark.parametrize("most", [(), (NAMES[4],)])
def test_beside_a_cause_a_promise_after_the_first_few_has_to_take_most_of_what_is_left(most, monkeypatch):
    """Otherwise a power law with an exponent of 1.02 halved the .003 % that a cubic spring leaves."""
    assert kept((0.1, 0.1, 0.1, 0.1, 0.9), NAMES[:4], most, monkeypatch, cheap=False) == [*NAMES[:4], *most]


@pytest.mark.parametrize(
    ("gain", "fit_gain", "rivals"),
    [
        (0.1, 60.0, (LARGE, SMALL)),
        (0.1, 38.0, (SMALL,)),  # by less than the odds of 100 to 1
        (-0.1, 60.0, (SMALL,)),  # left-out records refute it
    ],
)
def test_what_tells_the_fitted_records_far_better_is_a_rival_though_nothing_confirms_it(
    gain, fit_gain, rivals, monkeypatch
):
    """Of a friction in a rounded decay a hysteresis was named that left twenty noise variances more."""
    fits = [fit(SHOWING, fit_gain=30.0), fit(LARGE, gain=gain, fit_gain=fit_gain), fit(SMALL, fit_gain=28.0)]
    made = SimpleNamespace(
        settings=SearchSettings(),
        evidence=SimpleNamespace(has=lambda trait: False, library={SHOWING: KIND}),
        encompasses=lambda *_: False,
        converged=lambda one, _: one,
        named_first=lambda first, others: (first, list(others)),
    )
    monkeypatch.setattr(faint, "_fitted", lambda *_: fits)
    monkeypatch.setattr(faint, "_is_worth", lambda one, *_: one.name != LARGE)
    monkeypatch.setattr(State, "is_validated", lambda *_: False)
    visible = SimpleNamespace(shows=lambda name: True, by_name=dict.fromkeys(NAMES, 10.0))
    scores = tuple(scored(place, 0.1) for place in range(3))
    state = State(made, outcome(), outcome(), ranked=scores, left=SimpleNamespace(visible=visible))
    assert faint_cause(state)[1:] == (fits[0], rivals)


@pytest.mark.parametrize(("every", "kept"), [(False, 4), (True, 6)])
def test_laws_that_do_not_resemble_the_first_are_chosen_where_every_one_is_asked_for(every, kept):
    """Seven along axes of their own: four come first, two more promise a third of the first one's gain."""
    ranked = [scored(place, gain) for place, gain in enumerate((0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.1))]
    assert len(chosen(ranked, SearchSettings(), every=every)) == kept


@pytest.mark.parametrize(("before", "counts"), [(100.0, True), (50.0, False)])
def test_a_law_of_no_known_size_counts_where_it_takes_most_of_what_was_left(before, counts):
    found, beside = fit("a"), outcome()
    tried_on = bench(SearchSettings(), [(found.outcome, left(40.0, 100.0)), (beside, left(before, 2.5 * before))])
    assert is_determined_within(2.0, tried_on, found, beside) is counts


@pytest.mark.parametrize(
    ("cost", "t", "is_taken_without_it"),
    [
        (0.9, 5.0, False),
        (0.5, 5.0, True),  # the fit without it had not converged: it comes as far
        (0.9, 0.5, True),  # left-out records are foretold as well by it
    ],
)
def test_a_faint_cause_is_one_beside_the_model_without_it_too(cost, t, is_taken_without_it, monkeypatch):
    """An eccentricity of .04 um was established in a null whose nominal model had not converged."""
    best, settled = fit(SHOWING, cost=0.5, score=None), outcome(cost)
    bench = SimpleNamespace(
        settings=SearchSettings(), evidence=None, log=lambda said: None, spared=lambda found: found.fitted.cost,
        without=lambda *_: settled, confirmation=lambda before, after: t if before is settled else 9.0,
    )  # fmt: skip
    monkeypatch.setattr(faint, "compared", lambda *_: best)
    monkeypatch.setattr(State, "is_validated_beside", lambda *_: False)
    state = State(bench, outcome(1.0), outcome(1.0), left=SimpleNamespace(taken=0.5))
    anew = search._calibrated_anew(state, best, is_faint=True)
    assert (anew is not None and anew.outcome is anew.nominal is settled) == is_taken_without_it
