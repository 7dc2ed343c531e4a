"""Angles and torques at the samples of a record whose clock slows down: they are known at even instants."""

from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.shaft import shaft_of
from gear_damping.explanation.model.parting_flanks import TORQUE, _stated
from gear_damping.explanation.model.rig import shaft_angle
from gear_damping.explanation.model.ringing import _turning
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.systems.gear_pair import GearPair

RATE, SAMPLES, SPEED, TEETH = 1000.0, 801, 60.0, 21
EVEN = torch.arange(SAMPLES, dtype=torch.float64)
PLACE = EVEN / (SAMPLES - 1)
STAMPS = (SAMPLES - 1) * (PLACE - 0.1 * PLACE * (1 - PLACE))  # up to 20 behind the even ones
KNOWN = {"n_teeth_pinion": TEETH, "n_teeth_gear": 43}


def angle(instants):
    return SPEED * instants / RATE


@pytest.mark.parametrize("is_measured", [True, False])
def test_the_shafts_stand_where_they_stood_at_each_sample(is_measured):
    inputs = {"pinion_angle": angle(EVEN)} if is_measured else {}
    record = FitRecord("run", torch.zeros(SAMPLES), RATE, inputs, {"pinion_speed": SPEED}, stamps=STAMPS)
    evidence = Evidence("gear_pair", (record,), (), Known(KNOWN, {}, GearPair), None, one_record=True)
    expected = pytest.approx(angle(STAMPS).numpy(), abs=1e-9)
    assert shaft_of(record, evidence).angle == expected
    assert shaft_angle(record, 0.0).numpy() == expected
    turning = _turning(record, SimpleNamespace(values={}), evidence)
    assert turning.mesh_angle / TEETH == expected


def test_a_torque_is_that_of_its_sample():
    record = FitRecord("run", torch.zeros(SAMPLES), RATE, {TORQUE: 3 + 2 * EVEN}, stamps=STAMPS)
    assert _stated(record, TORQUE).numpy() == pytest.approx((3 + 2 * STAMPS).numpy(), abs=1e-9)
