"""Of records of more samples than a search can look through, the stretch that tells most is taken, and that is said."""

from dataclasses import replace
from math import pi

import pytest
import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.useful_samples import of_useful_length
from gear_damping.explanation.settings import SearchSettings
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord, Observed
from gear_damping.physics.systems.gear_pair import GearPair
from gear_damping.physics.systems.oscillator import Oscillator

RATE = 1000.0


def record(samples, speed=None, response=None):
    values = torch.arange(samples, dtype=torch.float64) if response is None else response
    conditions = {} if speed is None else {"pinion_speed": speed}
    angle = {"pinion_angle": torch.arange(samples, dtype=torch.float64)} if speed else {}
    return FitRecord("one", values, RATE, inputs=angle, conditions=conditions)


def evidence_of(fit, holdout=(), most=10000, system=Oscillator, **stated):
    known, settings = Known(stated, {}, system), SearchSettings(most_samples=most)
    return Evidence(system.name, tuple(fit), tuple(holdout), known, None, one_record=False, settings=settings)


def kept(*args, **options):
    return [len(one.response) for one in of_useful_length(evidence_of(*args, **options)).evidence.fit]


def test_what_is_short_enough_stays_as_it_is():
    evidence = evidence_of([record(4000), record(6000)], [record(10000)])
    found = of_useful_length(evidence)
    assert found.evidence is evidence
    assert not found.said


def test_short_records_stay_whole_and_long_ones_share_the_rest():
    assert kept([record(1000), record(3000), record(30000), record(50000)]) == [1000, 3000, 3000, 3000]
    assert kept([record(500), record(30000), record(50000)]) == [500, 4750, 4750]


def test_held_out_records_have_as_many_of_their_own():
    found = of_useful_length(evidence_of([record(4000)], [record(15000), record(15000)])).evidence
    assert [len(one.response) for one in found.records] == [4000, 5000, 5000]


def test_channels_count():
    two = replace(record(8000), others=((Observed("velocity"), torch.zeros(8000, dtype=torch.float64)),))
    assert kept([two]) == [5000]


def test_a_stretch_holds_two_turns_of_the_slower_shaft():
    turning = [record(60000, speed=2 * pi * 2) for _ in range(2)]  # a share of 5000 samples is 10 turns of the pinion
    assert kept(turning, system=GearPair, n_teeth_pinion=20, n_teeth_gear=80) == [5000, 5000]
    assert kept(turning, system=GearPair, n_teeth_pinion=10, n_teeth_gear=100) == [10000, 10000]  # 1 of the gear
    assert kept(turning, system=GearPair, n_teeth_pinion=10, n_teeth_gear=900) == [10000, 10000]  # two shares
    assert kept(turning, system=GearPair, n_teeth_pinion=100, n_teeth_gear=10) == [5000, 5000]
    assert kept([record(60000, speed=0.0)], system=GearPair) == [10000]


@pytest.mark.parametrize("at", [0, 21000, 49000])
def test_it_lies_where_the_record_is_loud(at):
    values = 0.01 * torch.randn(60000, generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    values[at : at + 3000] += torch.sin(torch.arange(3000, dtype=torch.float64))
    [one] = of_useful_length(evidence_of([record(60000, speed=1.0, response=values)])).evidence.fit
    begins = round(one.begins * RATE)
    assert begins <= at + 1500
    assert at + 1500 <= begins + 10000
    assert torch.equal(one.response, values[begins : begins + 10000])
    assert float(one.inputs["pinion_angle"][0]) == begins
    assert one.record == "one"


def test_of_a_steady_record_it_is_the_beginning():
    values = torch.randn(60000, generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    [one] = of_useful_length(evidence_of([record(60000, response=values)])).evidence.fit
    assert one.begins == 0


def test_the_answer_says_how_much_was_left_out():
    said = of_useful_length(evidence_of([record(4000), record(20000)], [record(5000)])).said
    assert said.startswith("1 of 3 records are long, and 6 of their 20 s were searched, a stretch of each")
    assert "explain.most_samples=20000" in said
