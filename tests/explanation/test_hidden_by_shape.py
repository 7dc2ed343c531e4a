"""Beside the shape of the stiffness as it was, effects of single teeth that promise little are not scored again."""

from types import SimpleNamespace

import pytest

from gear_damping.explanation.steps.single import _hidden_by_shape


def score(name, gain, teeth=False):
    return SimpleNamespace(gain=gain, candidate=SimpleNamespace(name=name, tells_teeth_apart=teeth))


@pytest.mark.parametrize(("of_teeth", "again"), [(0.04, False), (0.06, True)])
def test_what_a_shape_cannot_take_need_not_be_found_anew(of_teeth, again):
    found = _hidden_by_shape([score("law", 0.5), score("crack", of_teeth, True), score("crack", 0.0, True)])
    assert ("crack" in found) == again


def test_a_law_that_promises_nothing_is_scored_again_all_the_same():
    assert _hidden_by_shape([score("ripple", 0.5), score("law", 0.0)]) == {"ripple", "law"}
    assert _hidden_by_shape([]) == set()
