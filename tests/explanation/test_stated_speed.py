"""A speed that is stated of one record and is another one's is told by where its mesh stands."""

from types import SimpleNamespace

import numpy as np
import pytest
import torch

from gear_damping.explanation.evidence.records import Evidence
from gear_damping.explanation.evidence.stated_speed import stated_speed_faults
from gear_damping.identification.observation import Known
from gear_damping.identification.output_error.records import FitRecord
from gear_damping.physics.systems.gear_pair import GearPair

RATE, N, TEETH = 10_000.0, 5000, 54
SPEEDS = {"a": 92.0, "b": 127.0, "c": 101.0}  # rad/s


def record(name, turns, stated, second=0.01, noise=0.03, **more):
    time = np.arange(N) / RATE
    mesh = TEETH * turns * time
    values = np.cos(mesh + 1) + second * np.cos(2 * mesh) + 0.3 * np.cos(turns * time)
    values += noise * np.random.default_rng(len(name)).standard_normal(N)
    return FitRecord(name, torch.as_tensor(values), RATE, {}, {"pinion_speed": stated} | more)


def said(records):
    channel = SimpleNamespace(name="pinion_speed")
    known = Known({"n_teeth_pinion": float(TEETH), "n_teeth_gear": 108.0}, {}, GearPair)
    evidence = Evidence("gear_pair", tuple(records), (), known, channel, one_record=False)
    return {finding.record: finding.message for finding in stated_speed_faults(evidence)}


@pytest.mark.parametrize("factor", [0.9, 0.955, 1.05, 1.2])
def test_the_record_is_named_with_the_speed_that_it_has(factor):
    found = said(record(name, speed, speed / factor if name == "b" else speed) for name, speed in SPEEDS.items())
    assert list(found) == ["b"]
    assert f"a pinion_speed of {60 * SPEEDS['b'] / (2 * np.pi):.5g}"[:-1] in found["b"]
    assert f"{60 * SPEEDS['b'] / factor / (2 * np.pi):.5g} rpm are stated" in found["b"]


@pytest.mark.parametrize(
    "off",
    [
        {"factor": 1.005},  # its uncertainty
        {"factor": 1.05, "every": True},  # a wrong tooth count moves all of them
        {"factor": 1.05, "second": 0.0},  # one line may be the structure's
        {"factor": 1.05, "noise": 5.0},
    ],
)
def test_nothing_is_said_of_what_may_be_something_else(off):
    wrong = {k: v for k, v in off.items() if k in ("second", "noise")}
    assert not said(
        record(name, speed, speed / off["factor"] if name == "b" or off.get("every") else speed, **wrong)
        for name, speed in SPEEDS.items()
    )


def test_a_run_up_has_no_one_speed():
    kept = [record(name, speed, speed) for name, speed in SPEEDS.items() if name != "b"]
    assert not said([*kept, record("b", SPEEDS["b"], 0.9 * SPEEDS["b"], pinion_acceleration=40.0)])
