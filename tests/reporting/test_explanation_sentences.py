"""Sentences of a report, from the content of explanation.json."""

import pytest

from gear_damping.reporting.explanation_report.sentences import (
    CONDITIONAL,
    confirmed_sentence,
    damping_sentence,
    size_sentence,
    verdict_sentences,
)

CONFIRMED = {"t": 14.27, "percent": 99.958, "interval95": [99.91, 100.0]}


def test_what_causes_are_worth_is_said_with_how_sure_that_is():
    said = confirmed_sentence({"confirmed": CONFIRMED})
    assert said == (
        "There the causes take 99.96 % (99.91 to 100 %) of the squared residuals; t of what they add is 14.3."
    )
    misfit = {"before": 40.0, "after": 1.0, "floor": 1.0}
    told = verdict_sentences({"verdict": "partly_explained", "misfit": misfit, "gain": {"confirmed": CONFIRMED}})
    assert told.index(said) == 1 + next(i for i, one in enumerate(told) if one.startswith("On held-out records"))


@pytest.mark.parametrize("gain", [None, {}, {"confirmed": None}, {"confirmed": CONFIRMED | {"t": float("nan")}}])
def test_nothing_is_said_of_what_is_not_known(gain):
    assert confirmed_sentence(gain) == ""


def test_a_cause_is_said_with_its_form_its_size_and_what_was_not_fitted():
    depth = {"value": 0.249, "unit": "1", "interval95": [0.241, 0.257]}
    crack = {"name": "tooth_crack", "status": "established", "parameters": {"depth": depth, "phase": depth}}
    said = size_sentence(crack | {"options": {"shaft": "gear", "halved": True}, "fixed": {"order": 2.0, "share": 0.0}})
    assert said == (
        "tooth_crack (established): shaft gear; order 2; depth 0.249 (0.241 … 0.257); phase 0.249 (0.241 … 0.257)."
    )
    many = size_sentence(crack | {"parameters": {f"harmonic_{place}": depth for place in range(9)}})
    assert many.endswith("and 3 more in the report.")
    teeth = {f"values[{place}]": {**depth, "value": -(place % 7)} for place in range(9)}
    assert "; values[6], the largest of 9, -6" in size_sentence(crack | {"parameters": teeth, "options": {"a": "b"}})


def test_damping_beside_what_has_no_name_is_said_to_be_conditional():
    before, after = ({"value": value, "interval95": [value - 0.1, value + 0.1]} for value in (2.0, 1.0))
    gain = {"damping_ratio_percent": {"before": before, "after": after, "conditional": False}}
    plain = damping_sentence(gain)
    assert "100 % too high" in plain
    after["by_law"] = {"viscous_damping": 1.634, "coulomb_friction": 1.9}
    assert "(viscous_damping 1.63 %, coulomb_friction 1.9 %)" in damping_sentence(gain)
    after["by_law"] = {}
    gain["damping_ratio_percent"]["conditional"] = True
    assert damping_sentence(gain) == plain + CONDITIONAL
