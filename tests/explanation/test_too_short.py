"""What is too short to judge is said in periods where there are any, else in times that the motion remembers."""

import math
from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.settings import SearchSettings
from gear_damping.explanation.steps import too_short as module

NOMINAL = SimpleNamespace(hypothesis=SimpleNamespace(model=None), flat_given=dict)


def said(monkeypatch, fitted, *, stated=0.0, spring=True, held_s=20.0, alone=False, parts=1, ask=module.too_short):
    """Of records of 40 s that forget themselves in 0.5 s."""
    monkeypatch.setattr(module, "natural_frequency_hz", lambda *_: fitted)
    monkeypatch.setattr(module, "stated_frequency", lambda _: stated)
    monkeypatch.setattr(module, "decorrelation_time", lambda _: 0.5)
    fit, held = (SimpleNamespace(response=torch.zeros(int(10 * s)), sampling_rate=10.0) for s in (40.0, held_s))
    evidence = SimpleNamespace(
        settings=SearchSettings(),
        has_spring=spring,
        duration=40.0,
        fit=(fit,) * parts,
        holdout=(held,),
        records=(fit, held),
        one_record=alone,
    )
    return ask(evidence, NOMINAL)


def test_eight_periods_are_enough(monkeypatch):
    assert not said(monkeypatch, fitted=0.41)
    assert "hold 7.8 natural periods of 0.39 Hz" in said(monkeypatch, fitted=0.39)
    assert "hold out records of at least 20.5 s" in said(monkeypatch, fitted=0.39)


def test_what_is_stated_of_the_rig_says_its_period(monkeypatch):
    assert "natural periods of 0.2 Hz" in said(monkeypatch, fitted=3.0, stated=0.2)


@pytest.mark.parametrize(("fitted", "spring"), [(7.3e-6, True), (0.0, True), (3.0, False)])
def test_where_nothing_swings_within_the_records_the_motion_has_times_of_its_own(fitted, spring, monkeypatch):
    """A wing whose one-mode fit had no spring was told to be held out for twelve days."""
    assert not said(monkeypatch, fitted, spring=spring)
    short = said(monkeypatch, fitted, spring=spring, held_s=3.0)
    assert "hold 6 times of 0.5 s" in short
    assert "at least 4 s" in short


def test_the_part_of_one_record_that_is_held_out_counts(monkeypatch):
    assert "of which the last" in said(monkeypatch, fitted=0.1, alone=True)
    assert "of which 2 in two parts are held out" in said(monkeypatch, fitted=0.1, alone=True, parts=2)


def test_a_cause_of_few_periods_needs_the_t_of_few_blocks(monkeypatch):
    """That of Student's distribution with the chance of .0228 that two deviations of many have."""
    least = {held: said(monkeypatch, fitted=1.0, held_s=held, ask=module.least_t) for held in (8.0, 7.0, 3.0, 2.0, 1.0)}
    assert least[8.0] == 0
    assert least[7.0] == pytest.approx(2.517, abs=1e-3)
    assert least[3.0] == pytest.approx(4.527, abs=1e-3)
    assert least[2.0] == pytest.approx(1 / math.tan(math.pi * 0.0227501), rel=1e-4)  # that of Cauchy
    assert least[1.0] == math.inf
