"""A cause that is none does not take the others along; verdicts on made-up searches."""

from types import SimpleNamespace
from unittest.mock import patch

import pytest

from gear_damping.explanation.answer import judged as module
from gear_damping.explanation.answer.judged import judged
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import Accepted, State
from gear_damping.explanation.trials.refit import Refit
from gear_damping.physics.catalogue import effect_class


class Cause(str):
    """A cause that is nothing but its name."""

    __slots__ = ()

    @property
    def name(self):
        return str(self)


def search_of(*names):
    return SimpleNamespace(state=SimpleNamespace(accepted=tuple(map(Cause, names))))


def without(found, name):
    return search_of(*(other for other in found.state.accepted if other != name))


@pytest.fixture
def waves_as_they_are():
    with (
        patch.object(module, "_reported", lambda said: said),
        patch.object(module, "_without_form", lambda found: (found, ())),
    ):
        yield


def judge(words, doubts):
    """A judge with a word for every set of causes, and the cause that it doubts."""

    def one(found, notes, is_short):
        names = found.state.accepted
        verdict = SimpleNamespace(word=words.get(names, "unexplained"), notes=notes)
        return SimpleNamespace(verdict=verdict, found=found.state), (doubts.get(names, ""), "but it has no size.")

    return one


@pytest.mark.parametrize(
    ("words", "doubts", "kept"),
    [
        ({("ripple",): "partly_explained"}, {("ripple", "pitch"): "pitch"}, ("ripple",)),
        ({("ripple",): "partly_explained"}, {("ripple", "pitch"): "ripple"}, ("ripple", "pitch")),
        ({("ripple",): "partly_explained"}, {}, ("ripple",)),
        ({}, {}, ("ripple", "pitch")),
        ({("ripple", "pitch"): "explained"}, {("ripple", "pitch"): "pitch"}, ("ripple", "pitch")),
    ],
    ids=["the rest is named", "the rest is none either", "one is enough by itself", "none is", "all is well"],
)
@pytest.mark.usefixtures("waves_as_they_are")
def test_what_is_left_without_a_cause_that_is_none_is_judged_by_itself(words, doubts, kept):
    with patch.object(module, "_judged", judge(words, doubts)), patch.object(module, "without", without):
        found = judged(search_of("ripple", "pitch"), ())
    assert found.found.accepted == kept


@pytest.mark.usefixtures("waves_as_they_are")
def test_one_after_another_is_doubted():
    words = {("a",): "explained"}
    doubts = {("a", "b", "c"): "b", ("a", "c"): "c"}
    with patch.object(module, "_judged", judge(words, doubts)), patch.object(module, "without", without):
        found = judged(search_of("a", "b", "c"), ("Said before.",))
    assert found.found.accepted == ("a",)
    said = [f"`{name}` would take part of what is left too, but it has no size." for name in "bc"]
    assert list(found.verdict.notes) == ["Said before.", *said]


def test_a_cause_at_its_bound_is_doubted_where_nothing_else_is():
    refits = {name: SimpleNamespace(is_at_bound=name == "pitch") for name in ("a", "pitch")}
    bounded = [SimpleNamespace(name=name, refit=refit) for name, refit in refits.items()]
    state = SimpleNamespace(accepted=bounded, is_at_bound=lambda cause: cause.refit.is_at_bound)
    with (
        patch.object(module, "swinging_on", lambda _: iter(())),
        patch.object(module, "stand_ins", lambda _: iter(())),
    ):
        assert module._doubtful(state) == ("pitch", "")
    stand_in = SimpleNamespace(cause="a", sentence="but a line takes more.")
    with (
        patch.object(module, "swinging_on", lambda _: iter(())),
        patch.object(module, "stand_ins", lambda _: iter([stand_in])),
    ):
        assert module._doubtful(state) == ("a", "but a line takes more.")


@pytest.mark.parametrize(
    ("alone", "beside", "doubted"), [(2.0, 2.0, False), (4.0, 2.0, True), (2.0, 4.0, True), (2.0, 1.01, True)]
)
def test_a_cause_may_run_into_its_bound_beside_the_others_only(alone, beside, doubted):
    def outcome(size):
        free = [SimpleNamespace(name=name, lower=low, upper=4.0) for name, low in (("law.size", 1.0), ("gap", 2.0))]
        return SimpleNamespace(problem=SimpleNamespace(free=free), values={"law.size": size, "gap": 2.0})

    score = SimpleNamespace(candidate=SimpleNamespace(name="law", resting=()))
    cause = Accepted("law", Refit(score, outcome(alone), 1.0, 9.0, 9.0, is_seen_in_fit=True), 0.9, ())
    assert State(None, None, outcome(beside)).is_at_bound(cause) is doubted
    other = SimpleNamespace(candidate=SimpleNamespace(name="other", resting=()))
    first = Accepted("law", Refit(other, outcome(alone), 1.0, 9.0, 9.0, is_seen_in_fit=True), 0.5, (), score)
    assert State(None, None, outcome(beside)).is_at_bound(first) is doubted  # of a pair, by its own name
    both = State(None, None, outcome(beside), accepted=(cause, first))  # what bent it while the other was missing: none
    assert both.is_at_bound(cause) is (beside != 2.0)


@pytest.mark.parametrize(
    ("shares", "visible", "small"),
    [
        ((0.98, 0.009), True, ("b",)),
        ((0.98, 0.009), False, ()),
        ((0.9, 0.05), True, ()),
        ((0.009,), True, ()),
        ((0.001, 0.98, 0.009), True, ("c", "a")),
        ((), True, ()),
    ],
    ids=["little, and something is left", "nothing is left", "more than another form", "alone", "two", "none"],
)
def test_causes_as_small_as_the_form_of_another(shares, visible, small):
    assert module._small(searched_for(shares, visible).state) == small


def test_a_small_friction_is_no_other_form_of_a_stiffness():
    state = searched_for((0.98, 0.009, 0.005)).state
    state.accepted[1].effect = effect_class("coulomb_friction")()
    assert module._small(state) == ("c",)


@pytest.mark.parametrize(("third", "small"), [(5e-6, ("c",)), (5e-5, ())])
def test_a_friction_may_be_the_form_of_a_larger_one(third, small):
    """A pendulum's dry friction took .2 % beside its sine, and a power law of unknown exponent .0006 % more."""
    state = searched_for((0.998, 0.0018, third)).state
    state.accepted[1].effect = effect_class("coulomb_friction")()
    state.accepted[2].effect = effect_class("power_law_damping")()
    assert module._small(state) == small


def test_a_sensor_that_is_off_by_little_may_be_a_form_of_any_law():
    state = searched_for((0.98, 0.013)).state
    state.accepted[0].effect = effect_class("hysteretic_damping")()
    state.accepted[1].effect = effect_class("sensor_drift")()
    assert module._small(state) == ("b",)


def searched_for(shares, visible=True, left=1.0):
    spring = effect_class("cubic_stiffness")()
    accepted = tuple(
        SimpleNamespace(name=name, share=share, effect=spring) for name, share in zip("abc", shares, strict=False)
    )
    bench = SimpleNamespace(settings=SearchSettings())
    state = SimpleNamespace(accepted=accepted, bench=bench, left=SimpleNamespace(visible=visible))
    return SimpleNamespace(state=state, after=SimpleNamespace(percent=left))


@pytest.mark.parametrize(("left", "named"), [(0.2, ("a",)), (0.05, ("a", "b"))], ids=["a part", "all but noise"])
def test_they_are_named_where_they_take_nearly_all_that_the_others_leave(left, named):
    told = []

    def one(found, notes, is_short):
        told.extend(notes)
        return SimpleNamespace(verdict=SimpleNamespace(word="explained"), found=found.state), ("", "")

    with (
        patch.object(module, "_judged", one),
        patch.object(module, "_reported", lambda said: said),
        patch.object(module, "without", lambda found, name: searched_for((0.98,), left=1.0)),
    ):
        found = judged(searched_for((0.98, 0.009), left=left), ())
    assert tuple(cause.name for cause in found.found.accepted) == named
    assert told == ([] if "b" in named else [module.WITHIN_FORM.format("b")])
