"""Every threshold of the search decides something: changed tenfold, a decision at made-up numbers falls otherwise."""

from dataclasses import fields, replace

import pytest

from gear_damping.explanation.settings import SearchSettings
from tests.explanation.decisions import of_evidence, of_steps, of_trials  # noqa: F401 - they declare
from tests.explanation.decisions.declared import DECISIONS

FIELDS = {one.name: one for one in fields(SearchSettings)}


def test_every_threshold_has_its_decision():
    assert set(DECISIONS) == set(FIELDS)


@pytest.mark.parametrize("name", FIELDS)
def test_what_is_decided_on_either_side_of_a_threshold(name):
    decision = DECISIONS[name]
    assert decision.made(SearchSettings()) == decision.expected


@pytest.mark.parametrize("factor", [0.1, 10.0])
@pytest.mark.parametrize("name", FIELDS)
def test_tenfold_another_threshold_decides_otherwise(name, factor):
    limits, default = FIELDS[name].metadata, FIELDS[name].default
    value = type(default)(min(max(factor * default, limits["lower"]), limits["upper"]))
    decision = DECISIONS[name]
    assert decision.made(replace(SearchSettings(), **{name: value})) != decision.expected
