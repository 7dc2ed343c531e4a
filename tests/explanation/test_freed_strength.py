"""Beside an exponent the logarithm of a strength is fitted; on made-up candidates."""

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from gear_damping.explanation.trials.refit import _freed
from gear_damping.identification.output_error.records import FreeParameter

VISCOUS = FreeParameter("viscous_damping.damping_coefficient", 0.02, logarithmic=True)
STRENGTH = FreeParameter("law.strength", 0.0, 1e-9, lower=0.0)


@dataclass(frozen=True)
class Hypothesis:
    free: tuple
    given: dict


def freed(value, later, strength=STRENGTH):
    candidate = SimpleNamespace(
        hypothesis=SimpleNamespace(common=[VISCOUS, strength]), strengths=(1,), later=(FreeParameter(later, 2.0),)
    )
    given = {VISCOUS.name: 0.03, strength.name: value, later: 2.5}
    found = _freed(SimpleNamespace(hypothesis=Hypothesis((VISCOUS, strength), given)), candidate)
    return {parameter.name: parameter for parameter in found.free}


def test_everything_begins_where_the_fit_stands():
    assert [p.start for p in freed(4e-9, "law.exponent").values()] == [0.03, 4e-9, 2.5]


@pytest.mark.parametrize(
    ("value", "later", "logarithmic"),
    [(4e-9, "law.exponent", True), (4e-9, "law.width", False), (0.0, "law.exponent", False)],
)
def test_only_a_size_beside_an_exponent_becomes_a_logarithm(value, later, logarithmic):
    assert freed(value, later)["law.strength"].logarithmic is logarithmic


def test_a_strength_of_either_sign_stays_as_it_is():
    either = FreeParameter("law.strength", 0.0, 1e-9)
    assert not freed(4e-9, "law.exponent", either)["law.strength"].logarithmic
