"""Where the first cause is sought from: before the stiffness had its shape, or beside it."""

from math import inf
from types import SimpleNamespace
from unittest.mock import patch

import pytest

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.steps import single
from tests.explanation.decisions.made_up import NAMES, bench, fit, left, outcome, scored

LOST = left(10.0, misfit=20.0)  # far beyond what a shape may bend to


def sought(nominal, scores, leaves, made):
    """The places in their order, the effects that were fitted in each, and the fits."""
    known = bench(SearchSettings(), [(nominal, LOST), *leaves])
    state, order = State(known, nominal, nominal, first_scores=tuple(scores)), []
    rough = outcome()

    def full_fits(_, ranked, begun, against, reach=inf):
        if not ranked:
            return ()
        place = "shaped" if begun is nominal else "unshaped"
        order.append((place, [one.candidate.name for one in ranked]))
        return tuple(made[place])

    with (
        patch.object(single, "_unshaped", lambda _: (rough, scores)),
        patch.object(single, "flanks_change", lambda evidence: False),
        patch.object(single, "stay_closed", lambda evidence: True),
        patch.object(type(known), "full_fits", full_fits),
    ):
        return order, single._first_fits(state)


def converged(name, squares, is_converged=True):
    made = fit(name, squares, squares)
    made.outcome.fitted.converged = is_converged
    return made


@pytest.mark.parametrize(("gain", "first"), [(0.95, "shaped"), (0.85, "unshaped")])
def test_what_promises_nearly_all_is_fitted_from_the_shape_first(gain, first):
    nominal, found = outcome(), converged(NAMES[0], 0.1)
    made = {"shaped": [found], "unshaped": [found]}
    order, _ = sought(nominal, [scored(0, gain)], [(found.outcome, left(1.0))], made)
    assert order[0][0] == first
    assert len(order) == 1


@pytest.mark.parametrize(("gain", "is_converged"), [(0.8, False), (0.8, True), (0.6, False)])
def test_a_rival_that_came_to_no_end_is_fitted_from_the_shape_too(gain, is_converged):
    """One that promises as much as the best of .85, beside a cause that is validated: the better fit comes first."""
    nominal, best = outcome(), converged(NAMES[0], 0.3)
    rival, again = converged(NAMES[1], 0.8, is_converged), converged(NAMES[1], 0.1)
    made = {"unshaped": [best, rival], "shaped": [again]}
    leaves = [(one.outcome, left(1.0)) for one in (best, rival, again)]
    order, fits = sought(nominal, [scored(0, 0.85), scored(1, gain)], leaves, made)
    is_tried = gain > 0.9 * 0.85 and not is_converged
    assert ("shaped", [NAMES[1]]) in order or not is_tried
    assert (fits[0] is again) == is_tried


@pytest.mark.parametrize(("gain", "is_tried"), [(0.45, True), (0.4, False)])
def test_what_the_missing_shape_hid_is_fitted_from_the_shape_too(gain, is_tried):
    """One that was worth no fit before, and promises half of the best one's .85 beside the nominal model."""
    nominal, best, hidden = outcome(), converged(NAMES[0], 0.3), converged(NAMES[1], 0.1)
    made = {"unshaped": [best], "shaped": [hidden]}
    leaves = [(one.outcome, left(1.0)) for one in (best, hidden)]
    order, fits = sought(nominal, [scored(0, 0.85), scored(1, gain)], leaves, made)
    assert (("shaped", [NAMES[1]]) in order) == is_tried
    assert (fits[0] is hidden) == is_tried


def test_an_error_of_every_tooth_promises_as_much_of_anything():
    nominal, teeth = outcome(), scored(11, 0.95)
    state = State(bench(SearchSettings()), nominal, nominal, first_scores=(teeth,))
    assert single._promises_all(state)
    teeth.candidate.tells_teeth_apart = True
    assert not single._promises_all(state)


def test_where_nothing_is_validated_no_rival_is_waited_for():
    nominal, found = outcome(), converged(NAMES[0], 0.9, is_converged=False)
    made = {"shaped": [found], "unshaped": [found]}
    order, _ = sought(nominal, [scored(0, 0.85)], [(found.outcome, LOST)], made)
    assert [place for place, _ in order] == ["unshaped", "shaped"]


def test_the_promise_counts_beside_what_noise_leaves():
    """Of a cost of 1, of which noise is .2, a gain of .75 is nearly all."""
    nominal = outcome()
    state = State(bench(SearchSettings()), nominal, nominal, first_scores=(scored(0, 0.75),))
    assert not single._promises_all(state)
    with patch.object(type(state.bench), "noise_cost", lambda *_: 0.2):
        assert single._promises_all(state)
    assert not single._promises_all(SimpleNamespace(bench=state.bench, nominal=nominal, first_scores=()))
