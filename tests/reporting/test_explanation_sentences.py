"""Sentences of a report, from the content of explanation.json."""

import pytest

from gear_damping.reporting.explanation_report.sentences import confirmed_sentence, verdict_sentences

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
