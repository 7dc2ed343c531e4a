"""Springs that lie far apart are begun from each record by itself."""

from math import pi
from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.state import State
from gear_damping.explanation.steps import single
from gear_damping.explanation.trials import levels_alone as module
from gear_damping.explanation.trials.levels_alone import levels_alone
from gear_damping.identification.oscillator.each_alone import Alone
from gear_damping.identification.oscillator.linear_model import DAMPING
from gear_damping.identification.output_error.records import FreeParameter
from gear_damping.physics.effects.stiffness_by_record import StiffnessByRecord
from tests.explanation.decisions.made_up import bench, fit, left, outcome

FREQUENCIES = {"a": 4.71, "b": 3.97, "c": 3.46}  # Hz
ALONE = tuple(
    Alone(name, SimpleNamespace(value=hertz), SimpleNamespace(value=0.7)) for name, hertz in FREQUENCIES.items()
)
COMMON = [
    FreeParameter("stiffness", 500.0, logarithmic=True),
    FreeParameter(DAMPING, 2.0, logarithmic=True),
    FreeParameter("stiffness_by_record.spread", 0.0, 30.0),
]


def score(own_levels=True, effect=None):
    hypothesis = SimpleNamespace(effects=[effect or StiffnessByRecord()], common=COMMON)
    candidate = SimpleNamespace(
        name="stiffness_by_record", hypothesis=hypothesis, own_levels=own_levels,
        own_phases={2: "stiffness_by_record.level"},
    )  # fmt: skip
    return SimpleNamespace(candidate=candidate, start=torch.zeros(3, dtype=torch.float64))


def begun(asked, monkeypatch, alone=ALONE, has_spring=True):
    monkeypatch.setattr(module, "each_alone", lambda *_: alone)
    evidence = SimpleNamespace(
        base=SimpleNamespace(spring="stiffness"), has_spring=has_spring, fitted=(), fit=(), known=None
    )
    return levels_alone(asked, SimpleNamespace(fit_residuals=()), evidence)


def test_a_fit_begins_at_the_stiffness_of_each_record(monkeypatch):
    found = begun(score(), monkeypatch)
    stiffness = {name: (2 * pi * hertz) ** 2 for name, hertz in FREQUENCIES.items()}
    mean = sum(stiffness.values()) / 3
    values = [float(p.value(x)) for p, x in zip(COMMON, found.starts[0], strict=True)]
    assert values[0] == pytest.approx(mean)
    assert values[1] == pytest.approx(2 * 0.007 * mean**0.5)
    for name, own in stiffness.items():
        level = found.own[f"stiffness_by_record.level@{name}"]
        assert values[0] + values[2] * level == pytest.approx(own)


@pytest.mark.parametrize(
    "otherwise",
    [
        {"asked": score(own_levels=False)},
        {"asked": score(effect=SimpleNamespace(told_alone=""))},
        {"alone": ()},  # one model nearly follows all, or none follows each
        {"has_spring": False},
    ],
)
def test_elsewhere_it_begins_as_others_do(otherwise, monkeypatch):
    given = {"asked": score()} | otherwise
    assert begun(given.pop("asked"), monkeypatch, **given) is None


@pytest.mark.parametrize(
    ("is_told", "is_seen", "named"), [(True, True, True), (False, True, False), (True, False, False)]
)
def test_it_is_tried_where_nothing_else_is_found_and_each_record_has_a_model_of_its_own(
    is_told, is_seen, named, monkeypatch
):
    """Beside a mean spring its score is that of any other law."""
    found, nominal = fit("stiffness_by_record", is_seen_in_fit=is_seen), outcome()
    made = bench(SearchSettings(), [(nominal, None)])
    monkeypatch.setattr(type(made), "full_fit", lambda *_: found)
    monkeypatch.setattr(single, "levels_alone", lambda *_: object() if is_told else None)
    monkeypatch.setattr(State, "is_unpredictable", False)
    monkeypatch.setattr(State, "is_validated", lambda *_: True)
    monkeypatch.setattr(State, "accepting", lambda _, best, rivals: best)
    state = State(made, nominal, nominal, ranked=(score(),))
    assert (single.cause_of_records(state) is found) is named


@pytest.mark.parametrize(
    ("misfit", "squares", "is_validated", "is_told", "other", "instead"),
    [
        (50.0, 0.2, True, True, 2.0, True),
        (1.0, 0.2, True, True, 2.0, False),  # the law leaves noise
        (50.0, 0.3, True, True, 2.0, False),  # it leaves no more than twice as much, with one figure
        (50.0, 0.2, False, True, 2.0, False),
        (50.0, 0.2, True, False, 2.0, False),
        (50.0, 0.2, True, True, 0.4, False),  # another law leaves less of what is fitted, for all records alike
    ],
)
def test_it_takes_the_place_of_a_law_for_all_that_leaves_far_more(
    misfit, squares, is_validated, is_told, other, instead, monkeypatch
):
    """Of pendulums of six lengths a law whose frequency falls with the swing follows some.

    Of one whose swing dies away three windows have three frequencies, and a cubic spring leaves less of each.
    """
    law, own, nominal = fit("sine_restoring", squares=0.5), fit("stiffness_by_record", squares=squares), outcome()
    own.differs = True
    monkeypatch.setattr(single, "_told_alone", lambda _: own if is_told else None)
    monkeypatch.setattr(State, "is_validated", lambda *_: is_validated)
    monkeypatch.setattr(State, "beyond_sensor", lambda *_: left(40.0, misfit))
    others = (fit("cubic_stiffness", cost=other),)
    state = State(bench(SearchSettings(), [(nominal, None)]), nominal, nominal, rejected=others)
    assert single.differing_instead(law, state) is (own if instead else None)
    assert single.differing_instead(own, state) is None
