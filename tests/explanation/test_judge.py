"""The word for what was found, on made-up searches."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.answer.report_fields import _candidates
from gear_damping.explanation.evidence.excess import Excess
from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.steps.judge import (
    AMBIGUOUS,
    CONSISTENT,
    EXPLAINED,
    PARTLY,
    UNEXPLAINED,
    WITHIN_NOISE,
    Known,
)
from gear_damping.explanation.steps.judge import verdict as verdict_of


def verdict(found, before, after, **known):
    return verdict_of(found, before, after, Known(**known))


def excess_of(percent, misfit, threshold=0.1):
    return Excess(percent, threshold, threshold, misfit, {})


def search(visible=True, accepted=(), left=False, sensor=1.0, rest=1.0, not_random=0.05):
    """Made up: `sensor` and `rest` are the misfits beyond its noise of the nominal model and of the extended one."""
    seen = [SimpleNamespace(visible=one, taken=share) for one, share in ((visible, 0.8), (left, not_random))]
    bench = SimpleNamespace(settings=SearchSettings())
    found = SimpleNamespace(bench=bench, accepted=accepted, seen=seen[0], left=seen[1], nominal=sensor, outcome=rest)
    found.is_at_bound = lambda cause: cause.refit.is_at_bound
    found.beyond_sensor = lambda misfit: excess_of(0.1 * max(misfit - 1.0, 0.0), misfit)
    return found


def cause(name="coulomb_friction", at_bound=False, share=1.0):
    declared = SimpleNamespace(sentence="a law", one_class=())
    refit = SimpleNamespace(is_at_bound=at_bound)
    own = {"confusable": (), "looks_like": (), "refit": refit, "share": share}
    return SimpleNamespace(name=name, effect=SimpleNamespace(cause=declared), **own)


NOTHING, MUCH = excess_of(0.0, 1.0), excess_of(8.0, 40.0)


@pytest.mark.parametrize(
    ("visible", "before", "fitted", "word"),
    [
        (False, NOTHING, 0.0, CONSISTENT),
        (True, NOTHING, 0.0, CONSISTENT),  # visible, but far below what could matter
        (True, MUCH, 8.0, UNEXPLAINED),
        (True, excess_of(4.0, 9.0, threshold=20.0), 12.0, UNEXPLAINED),  # held-out records tell nothing, the others do
        (True, excess_of(-60.0, 0.04, threshold=68.0), 4.0, UNEXPLAINED),  # what would not show is no consistency
        (False, excess_of(-60.0, 0.04, threshold=4.0), 4.0, CONSISTENT),
        (False, excess_of(-60.0, 0.04, threshold=23.0), 4.0, UNEXPLAINED),  # a motor: 7 % missing, and far above noise
        (False, excess_of(-60.0, 0.04, threshold=520.0), 4.0, UNEXPLAINED),  # far more than a sensor makes, and untold
    ],
)
def test_without_a_name(visible, before, fitted, word):
    found = search(visible, sensor=1.0 if before is NOTHING else 100.0)
    assert verdict(found, before, before, fitted=fitted).word == word


@pytest.mark.parametrize(("threshold", "word"), [(330.0, UNEXPLAINED), (30.0, PARTLY)])
def test_beside_a_rest_nothing_is_established_by_held_out_records_that_hardly_move(threshold, word):
    found = search(accepted=(cause(),), left=True, sensor=200.0, rest=40.0, not_random=0.1)
    before, after = (excess_of(percent, 0.9, threshold=threshold) for percent in (-1290.0, -1300.0))
    said = verdict(found, before, after, is_one=True)
    assert said.word == word
    if word == UNEXPLAINED:
        assert "too little motion" in said.sentences[0]
        assert "%" not in said.sentences[0]


@pytest.mark.parametrize(("unknown", "word"), [("coulomb_friction", UNEXPLAINED), ("", PARTLY)])
def test_beside_a_rest_a_cause_of_any_size_is_none(unknown, word):
    found = search(accepted=(cause(),), left=True, sensor=200.0, rest=40.0, not_random=0.1)
    said = verdict(found, MUCH, excess_of(0.6, 20.0), is_one=True, any_figures=unknown)
    assert said.word == word
    assert ("but not one figure of `coulomb_friction` is told" in said.sentences[0]) == bool(unknown)


@pytest.mark.parametrize(("left", "word"), [(0.6, UNEXPLAINED), (0.01, EXPLAINED)])
def test_beside_a_rest_a_cause_of_another_size_in_every_record_is_none(left, word):
    """A contact that grows with the load by a law of its own took errors of the profile of 0 to 3 times their size."""
    found = search(accepted=(cause(),), left=left > 0.1, sensor=200.0, rest=40.0, not_random=0.1)
    said = verdict(
        found, MUCH, excess_of(left, 20.0 if left > 0.1 else 1.05), is_one=True, scattered="coulomb_friction"
    )
    assert said.word == word
    assert ("but not one figure of `coulomb_friction` is told" in said.sentences[0]) == (word == UNEXPLAINED)


@pytest.mark.parametrize(("unknown", "word"), [("hysteretic_damping", UNEXPLAINED), ("", EXPLAINED)])
def test_a_cause_of_any_size_explains_nothing(unknown, word):
    """Half a swing of an arm took a cubic spring of -242 to 36 and a hysteresis of 0 to 10 for .17 %."""
    found = search(accepted=(cause(),), left=False)
    said = verdict(found, MUCH, excess_of(0.01, 1.05), any_figures=unknown)
    assert said.word == word
    assert ("it bends to what they show" in said.sentences[0]) == bool(unknown)


@pytest.mark.parametrize(("left", "word"), [(1080.0, UNEXPLAINED), (60.0, UNEXPLAINED), (40.0, PARTLY)])
def test_of_a_signal_no_more_can_be_missing_than_all_of_it(left, word):
    """A pendulum's swing of 3.5 s took a low-pass of 1.3 Hz for its friction: 1080 % left of 67 500."""
    found = search(accepted=(cause(),), left=True, sensor=1000.0, rest=900.0)
    assert verdict(found, excess_of(67500.0, 1e6), excess_of(left, 1e4), is_one=True).word == word


@pytest.mark.parametrize(
    ("is_one", "at_bound", "word"), [(False, True, UNEXPLAINED), (None, True, EXPLAINED), (False, False, EXPLAINED)]
)
def test_what_bends_to_each_record_as_far_as_it_can_is_none(is_one, at_bound, word):
    """A motor's friction in two directions took a low-pass of 1e-6 to .83 Hz, of .31 to .70 Hz by record."""
    found = search(accepted=(cause(at_bound=at_bound),), left=False)
    assert verdict(found, MUCH, excess_of(0.01, 1.05), is_one=is_one).word == word


@pytest.mark.parametrize(("worth", "word"), [(3.5e-4, CONSISTENT), (0.5e-4, EXPLAINED)])
def test_what_a_load_may_do_between_its_samples_is_no_cause(worth, word):
    """A load straight between its samples moved a mass by .0001 % less, which a second mode took."""
    found = search(accepted=(cause("second_mode"),), left=False)
    before, after = excess_of(1.0e-4, 1.06), excess_of(-1.6e-4, 0.9)
    assert verdict(found, before, after, between_samples=worth, not_random=0.09).word == word


@pytest.mark.parametrize(("rest", "word"), [(1.1, EXPLAINED), (40.0, UNEXPLAINED)])
def test_what_ends_at_a_bound_far_above_the_noise_of_the_sensor_is_none(rest, word):
    """Of a servo whose friction differs between directions a low-pass of .50 Hz, the slowest that is tried, was named.

    It left 12 % of what was missing, which four records of one step each do not tell from chance.
    """
    found = search(accepted=(cause(at_bound=True),), sensor=1000.0, rest=rest)
    assert verdict(found, MUCH, excess_of(0.01, 1.05)).word == word
    within = search(accepted=(cause(at_bound=False),), sensor=1000.0, rest=rest)
    assert verdict(within, MUCH, excess_of(0.01, 1.05)).word == EXPLAINED


def test_a_cause_of_other_sizes_beside_something_visible_is_a_part():
    """Nearly all is taken, but not by one size in all records, and what is left is not all random."""
    sizes = {True: EXPLAINED, False: PARTLY, None: EXPLAINED}
    for is_one, word in sizes.items():
        found = search(accepted=(cause(),), left=True)
        assert verdict(found, MUCH, excess_of(0.01, 1.05), is_one=is_one).word == word
    found = search(accepted=(cause(),), left=False)
    assert verdict(found, MUCH, excess_of(0.01, 1.05), is_one=False).word == EXPLAINED


def test_a_shape_without_a_name_is_no_consistency_and_is_told():
    said = verdict(search(), NOTHING, NOTHING, shape="a line at 50 Hz")
    assert said.word == UNEXPLAINED
    assert "a line at 50 Hz" in said.sentences[0]
    missing = verdict(search(), MUCH, MUCH, shape="a line at 50 Hz")
    assert "What is missing looks like a line at 50 Hz." in missing.sentences


def test_what_has_run_into_a_bound_is_no_part_of_an_answer_beside_a_residual():
    left = excess_of(3.0, 10.0)
    assert verdict(search(accepted=(cause(at_bound=True),), left=True), MUCH, left, is_one=True).word == UNEXPLAINED
    assert verdict(search(accepted=(cause(at_bound=True),)), MUCH, NOTHING, is_one=True).word == EXPLAINED


@pytest.mark.parametrize("known", [{"stands_in": "but a line takes more."}, {"is_one": False}])
def test_a_cause_that_is_none_makes_no_gap_of_what_would_be_none_without_it(known):
    little, less = (Excess(percent, 0.1, 0.0, 1.3, {}) for percent in (0.004, 0.003))
    assert verdict(search(), little, little).word == CONSISTENT
    assert verdict(search(accepted=(cause(),), left=True), little, less, **known).word == CONSISTENT


def test_what_stands_in_for_something_else_is_no_answer():
    found = search(accepted=(cause(),), left=True)
    said = verdict(found, MUCH, excess_of(0.5, 2.4), stands_in="but a line takes more.")
    assert said.word == UNEXPLAINED
    assert said.sentences[0].endswith("but a line takes more.")


@pytest.mark.parametrize(("left", "word"), [(0.5, UNEXPLAINED), (0.0, EXPLAINED)])
def test_of_what_nobody_could_ask_what_it_stands_in_for_nothing_is_established_beside_a_residual(left, word):
    found = search(accepted=(cause(), cause("cubic_stiffness")), left=left > 0)
    after = excess_of(left, 2.4 if left else 1.0)
    assert verdict(found, MUCH, after).word == (PARTLY if left else EXPLAINED)
    said = verdict(found, MUCH, after, is_untold=True)
    assert said.word == word
    assert ("no time to see" in said.sentences[0]) is (left > 0)


def test_several_causes_of_other_sizes_are_no_part_where_nobody_could_ask_what_they_stand_in_for():
    found = search(accepted=(cause(), cause("cubic_stiffness")), left=True)
    assert verdict(found, MUCH, excess_of(0.01, 1.05), is_one=False, is_untold=True).word == UNEXPLAINED


@pytest.mark.parametrize(("threshold", "word"), [(174.0, PARTLY), (20.0, EXPLAINED)])
def test_held_out_records_that_could_refute_nothing_do_not_excuse_what_is_left_of_the_others(threshold, word):
    """A stiffness that drifted, with the resonance in a held-out record: 45 % of it was left, within its error."""
    found = search(accepted=(cause(),), left=True, sensor=10.0, rest=2.3)
    before, after = excess_of(4335.0, 4612.0, threshold), excess_of(2.0, 1.1, threshold)
    assert verdict(found, before, after, of_fit=0.7).word == word


def test_noise_that_is_the_sensor_s_own_hides_nothing():
    """A short null: its held-out record could hide much, but no more is left than its sensor makes."""
    before = excess_of(-8.0, 0.7, threshold=18.0)
    assert verdict(search(sensor=2.0), before, before, fitted=1.0).word == CONSISTENT
    assert verdict(search(sensor=900.0), before, before, fitted=1.0).word == UNEXPLAINED


@pytest.mark.parametrize(
    ("visible", "sensor", "word"), [(True, 16.0, UNEXPLAINED), (False, 16.0, CONSISTENT), (True, 2.0, CONSISTENT)]
)
def test_what_looks_random_and_is_more_than_the_sensor_s_noise_holds_nothing_visible(visible, sensor, word):
    """A stiffness that jumped left 1.6 % in a narrow band, which passed for a random load."""
    assert verdict(search(visible, sensor=sensor), NOTHING, NOTHING).word == word


@pytest.mark.parametrize(
    ("left", "rest", "word"),
    [(True, 7.0, PARTLY), (False, 7.0, EXPLAINED), (True, 2.0, EXPLAINED), (True, 4.0, EXPLAINED)],
)
def test_causes_that_leave_so_much_do_not_explain_all(left, rest, word):
    """Of 10 % missing beyond the sensor 0.6 % is a residual, 0.3 % is not."""
    found = search(accepted=(cause(),), left=left, sensor=101.0, rest=rest)
    assert verdict(found, MUCH, excess_of(0.0, 1.0), is_one=True).word == word


@pytest.mark.parametrize(
    ("untried", "word"), [((), CONSISTENT), (("torque_ripple",), CONSISTENT), (("crack",), UNEXPLAINED)]
)
def test_what_is_visible_and_was_not_tried_is_no_consistency(untried, word):
    found = search()
    found.seen.visible = SimpleNamespace(shows=lambda name: name == "crack")
    assert verdict(found, NOTHING, NOTHING, untried=untried).word == word


def test_what_there_was_no_time_for_is_named_and_no_effect_is_said_to_fail():
    found = search(sensor=100.0)
    found.seen.visible = SimpleNamespace(shows=lambda name: name == "tooth_crack")
    said = verdict(found, MUCH, MUCH, untried=("tooth_crack", "pairs of effects"))
    assert said.word == UNEXPLAINED
    assert said.sentences[0].endswith("the time was over before its likely cause was tried: tooth_crack.")
    assert "no effect of the catalogue" not in " ".join(said.sentences)


def test_an_effect_that_was_not_tried_is_not_called_rejected():
    scores = [SimpleNamespace(candidate=SimpleNamespace(name=n), gain=g, failed="") for n, g in
              (("tooth_crack", 0.3), ("backlash", 0.1))]  # fmt: skip
    found = SimpleNamespace(first_fits=(), accepted=(), first_scores=scores, nominal=None, failed={})
    judged = SimpleNamespace(found=found, not_tried=("tooth_crack",), verdict=SimpleNamespace(word=UNEXPLAINED))
    assert {one["name"]: one["status"] for one in _candidates(judged, None)} == {
        "tooth_crack": "not_tried", "backlash": "rejected"}  # fmt: skip


def test_what_is_left_and_not_random_is_said():
    after = excess_of(0.05, 1.1)
    clean = verdict(search(accepted=(cause(),)), MUCH, after)
    rest = verdict(search(accepted=(cause(),), left=True), MUCH, after)
    assert clean.word == rest.word == EXPLAINED
    assert not any("not all random" in sentence for sentence in clean.sentences)
    assert any("0.05 % of the signal's variance, is not all random" in sentence for sentence in rest.sentences)


def test_a_fall_is_one_of_what_it_is_measured_by():
    power = verdict(search(accepted=(cause(),)), MUCH, NOTHING)
    assert "With it the held-out excess falls by 100.0 %." in power.sentences
    faint = verdict(search(accepted=(cause(),)), excess_of(-0.05, 0.99), excess_of(-0.06, 0.98))
    assert "With it what is not random in the fitted records falls by 93.8 %." in faint.sentences


@pytest.mark.parametrize(("is_one", "word"), [(True, PARTLY), (False, UNEXPLAINED)])
def test_one_cause_with_one_size_may_leave_a_residual(is_one, word):
    left = excess_of(3.0, 10.0)
    assert verdict(search(accepted=(cause(),), left=True), MUCH, left, is_one=is_one).word == word


@pytest.mark.parametrize(("share", "word"), [(0.8, PARTLY), (0.27, UNEXPLAINED)])
def test_what_takes_most_of_held_out_records_takes_it_of_the_fitted_ones_too(share, word):
    """A torque ripple in the place of a wrong shaft angle: 71 % of two held-out records, 27 % of the other six."""
    found = search(accepted=(cause(share=share),), left=True)
    assert verdict(found, MUCH, excess_of(2.4, 3.1), is_one=True).word == word


@pytest.mark.parametrize(
    ("is_one", "of_fit", "word"), [(None, 0.97, PARTLY), (None, 0.6, UNEXPLAINED), (False, 0.97, UNEXPLAINED)]
)
def test_one_cause_that_takes_nearly_all_of_one_record_is_part_of_the_answer(is_one, of_fit, word):
    found, after = search(accepted=(cause(),), left=True), excess_of(3.5, 20.0)
    assert verdict(found, MUCH, after, is_one=is_one, of_fit=of_fit).word == word


@pytest.mark.parametrize(("misfit", "whole", "word"), [(0.1, 0.2, UNEXPLAINED), (0.1, 0.9, PARTLY), (1.0, 0.2, PARTLY)])
def test_a_small_part_of_what_only_looks_random_is_no_cause(misfit, whole, word):
    """A jump in a decay is no noise: held out there is less of it. A random load is one, and hides no cause."""
    before = excess_of(-20.0, misfit, threshold=15.0)
    assert verdict(search(accepted=(cause(),)), before, before, whole=whole).word == word


@pytest.mark.parametrize(("first", "share"), [(8.0, 0.75), (-1.0, 0.4)])
def test_a_share_is_one_of_residuals_where_nothing_was_left_beyond_noise(first, share):
    outcomes = [SimpleNamespace(percent=p, left_out_cost=c) for p, c in ((first, 10.0), (first - 6.0, 6.0))]
    bench = SimpleNamespace(excess=lambda outcome: excess_of(outcome.percent, 1.0))
    assert State(bench, outcomes[0], outcomes[0]).share_taken(outcomes[1]) == pytest.approx(share)


@pytest.mark.parametrize(("is_one", "word"), [(True, PARTLY), (None, PARTLY), (False, UNEXPLAINED)])
@pytest.mark.parametrize("causes", [1, 2])
def test_a_cause_of_several_sizes_beside_a_residual_stands_in_for_something_else(is_one, word, causes):
    """However small the rest, and however much of the gap it takes."""
    names = ("coulomb_friction", "cubic_stiffness")[:causes]
    found = search(accepted=tuple(cause(name) for name in names), left=True)
    said = verdict(found, MUCH, excess_of(0.5, 2.4), is_one=is_one)
    assert said.word == word
    assert ("another size in other records" in said.sentences[0]) is (is_one is False)


@pytest.mark.parametrize(("left", "word"), [(0.59, EXPLAINED), (0.61, CONSISTENT), (0.9, CONSISTENT)])
def test_a_faint_cause_takes_a_quarter_of_what_is_not_random(left, word):
    faint = excess_of(-0.05, 0.99)
    assert verdict(search(accepted=(cause(),), not_random=left), faint, faint).word == word
    assert verdict(search(accepted=(cause(),), not_random=left), MUCH, NOTHING).word == EXPLAINED


@pytest.mark.parametrize(("after", "word"), [(0.45, PARTLY), (1.2, UNEXPLAINED)])
def test_where_noise_hides_what_is_missed_the_fall_of_the_whole_held_out_error_counts(after, word):
    found = search(accepted=(cause(share=0.7),), left=True, sensor=40.0, rest=15.0, not_random=0.5)
    before, left = (excess_of(percent, misfit, threshold=5.0) for percent, misfit in ((1.6, 1.6), (-1.4, after)))
    said = verdict(found, before, left, is_one=True)
    assert said.word == word
    if word == PARTLY:
        assert "With it the squared error of the held-out records falls by 71.9 %." in said.sentences


@pytest.mark.parametrize(
    ("fitted", "threshold", "word"), [(60.0, 15e3, UNEXPLAINED), (2.0, 15e3, CONSISTENT), (60.0, 15.0, CONSISTENT)]
)
def test_fitted_records_that_are_missed_are_no_consistency_where_the_others_hardly_move(fitted, threshold, word):
    """A step of a motor whose cause no channel holds: what is held out is its steady end, and tells nothing."""
    before = excess_of(-60.0, 0.05, threshold)
    found = search(visible=False, sensor=2.0)
    assert verdict(found, before, before, fitted_beyond_sensor=fitted).word == word


@pytest.mark.parametrize(("at_bound", "word"), [(False, PARTLY), (True, UNEXPLAINED)])
def test_what_has_run_into_a_bound_and_leaves_most_is_no_part_of_an_answer(at_bound, word):
    before = excess_of(5.0, 9.0)
    assert verdict(search(accepted=(cause(at_bound=at_bound),)), before, NOTHING, whole=0.2).word == word


@pytest.mark.parametrize(("misfit", "said"), [(600.0, "is not random"), (1.0, "No evidence")])
def test_something_visible_that_is_too_small_to_matter_is_not_called_nothing(misfit, said):
    before = excess_of(0.02, misfit, threshold=0.03)
    (sentence,) = verdict(search(sensor=1.0), before, before).sentences
    assert said in sentence


def test_a_sure_cause_beside_one_that_looks_like_others_is_named_in_the_first_sentence():
    """A runout of 39 % beside a gain, a wrong inertia or a wrong torque that look the same."""
    alike = cause("sensor_gain")
    alike.effect.cause.one_class = ("an error of the torque", "a wrong inertia")
    for accepted, is_named in (((cause("pinion_eccentricity"), alike), True), ((alike,), False)):
        said = verdict(search(accepted=accepted), MUCH, NOTHING)
        assert said.word == AMBIGUOUS
        assert ("pinion_eccentricity" in said.sentences[0]) is is_named
        assert "look the same" in said.sentences[1]


@pytest.mark.parametrize(("not_random", "word"), [(0.02, CONSISTENT), (0.04, UNEXPLAINED)])
def test_what_shows_and_is_less_than_what_counts_is_no_gap(not_random, word):
    """A stiffness of other teeth left .06 % of a null, of which .02 % could be shown to be no noise."""
    little = Excess(0.06, 0.04, 0.04, 1.12, {})
    said = verdict(search(), little, little, not_random=not_random)
    assert said.word == word
    if word == CONSISTENT:
        assert "not random, and less than 0.06 %" in said.sentences[0]
    raised = verdict(search(sensor=16.0), NOTHING, NOTHING, not_random=not_random)  # a pink noise over a white floor
    assert raised.word == word
    assert verdict(search(), MUCH, MUCH, not_random=not_random).word == UNEXPLAINED


@pytest.mark.parametrize(("left", "word"), [(0.075, UNEXPLAINED), (0.04, PARTLY)])
def test_beside_what_is_random_a_part_that_is_less_than_what_counts_is_none(left, word):
    """A wave of another form, 0.004 % of what a gear pair did, was a profile error of 21 nm."""
    found = search(accepted=(cause(share=0.1),), sensor=2.4, rest=2.3)
    before, after = excess_of(0.079, 2.44, threshold=0.03), excess_of(left, 2.3, threshold=0.03)
    assert verdict(found, before, after, whole=0.2, is_one=True, not_random=0.05).word == word


@pytest.mark.parametrize(("left", "said"), [(3.0, "An unexplained residual of 3 % has none."), (-0.2, WITHIN_NOISE)])
def test_what_is_left_is_no_less_than_nothing(left, said):
    """Held-out records may leave less than their noise is taken for, and hold something that is not random."""
    found = search(accepted=(cause(share=0.95),), left=True, sensor=40.0, rest=20.0)
    told = verdict(found, MUCH, excess_of(left, 10.0), is_one=True)
    assert told.word == PARTLY
    assert told.sentences[0].endswith(f"Part of it has a name: a law (`coulomb_friction`). {said}")


@pytest.mark.parametrize(
    ("is_short", "before", "word"),
    [
        (False, excess_of(-0.2, 0.2, threshold=0.5), PARTLY),
        (True, excess_of(-0.2, 0.2, threshold=0.5), CONSISTENT),  # a bend of .3 % in three periods is anything's
        (True, MUCH, EXPLAINED),  # a large effect shows in a short record too
    ],
)
def test_held_out_records_that_are_too_short_establish_large_effects_alone(is_short, before, word):
    found = search(visible=True, accepted=(cause(),))
    assert verdict(found, before, NOTHING, is_short=is_short, is_one=True).word == word


def test_what_only_other_figures_than_the_stated_ones_follow_is_not_consistent():
    assert verdict(search(visible=False), NOTHING, NOTHING, is_stated_otherwise=True).word == UNEXPLAINED
    assert verdict(search(visible=False), NOTHING, NOTHING).word == CONSISTENT


@pytest.mark.parametrize("before", [NOTHING, MUCH])
def test_what_predicts_held_out_records_worse_than_without_it_is_no_cause(before):
    """A delay of 13 us took 89 % of what was not random in fitted records, and raised the rest of others by 2 %."""
    found = search(accepted=(cause(),))
    named = verdict(found, before, NOTHING, is_one=True, whole=1.0)
    refused = verdict(found, before, NOTHING, is_one=True, whole=1.0, predicts_worse=True)
    assert named.word in (EXPLAINED, PARTLY)
    assert refused.word == (CONSISTENT if before is NOTHING else UNEXPLAINED)
    if before is MUCH:
        assert "predicted worse than without" in refused.sentences[0]
