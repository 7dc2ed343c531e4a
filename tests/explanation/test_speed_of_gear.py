"""The speed of a pinion from a speed meter on the gear, where only a rough one is stated."""

from types import SimpleNamespace

import numpy as np
import pytest
import torch

from gear_damping.explanation.evidence.speed_of_gear import with_speed_of_gear
from gear_damping.identification.output_error.records import FitRecord, FreeParameter

RATIO, TRUE = 17 / 58, 125.66


def begun(stated, uncertainty=None, level=TRUE * RATIO, drift=0.0, inputs=(), meters=("gear_speed",)):
    time = np.linspace(0, 1, 4000)
    noise = 0.05 * np.random.default_rng(3).normal(size=time.size)
    seen = level + 0.2 * np.sin(2 * np.pi * 340 * time) + drift * time + noise
    own = (FreeParameter("inertia", 1.0),)
    if uncertainty:
        own = (FreeParameter("pinion_speed", stated, uncertainty, deviation=uncertainty, expected=stated), *own)
    record = FitRecord(
        "run", torch.as_tensor(seen), 4e3, dict.fromkeys(inputs, torch.zeros(4000)), {"pinion_speed": stated}, own=own
    )
    measured = SimpleNamespace(channels=dict.fromkeys(meters, SimpleNamespace(values=seen)))
    (found,) = with_speed_of_gear([record], [measured], RATIO)
    return found


def test_a_fit_begins_at_the_mean_of_the_gear_and_expects_what_is_stated():
    found = begun(125.9, 0.4)
    assert found.conditions["pinion_speed"] == pytest.approx(TRUE, rel=1e-4)
    speed, other = found.own
    assert (speed.start, speed.expected, speed.deviation) == (found.conditions["pinion_speed"], 125.9, 0.4)
    assert other.name == "inertia"


def test_without_a_stated_uncertainty_a_drive_may_be_off_by_three_thousandths():
    assert begun(125.9).conditions["pinion_speed"] == pytest.approx(TRUE, rel=1e-4)
    assert begun(126.3).conditions["pinion_speed"] == 126.3


@pytest.mark.parametrize(
    "more", [{"level": 0.0}, {"drift": 2.0}, {"inputs": ("pinion_angle",)}, {"meters": ("gear_speed", "pinion_speed")}]
)
def test_a_lost_mean_a_drift_or_a_better_channel_leave_it_as_it_is(more):
    found = begun(125.9, 0.4, **more)
    assert found.conditions["pinion_speed"] == 125.9
    assert found.own[0].start == 125.9
