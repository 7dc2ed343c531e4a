"""What a checkpoint says of its training, and which records it is then asked about."""

import pytest
import torch

from gear_damping.identification.runs import RunSet
from gear_damping.identification.trained_on import TrainedOn


def runs():
    signals = torch.tensor([[1.0, 3.0, 1.0, 3.0], [10.0, 10.0, 14.0, 14.0], [500.0, 900.0, 500.0, 900.0]])
    speeds = {"pinion_speed": torch.tensor([100.0, 300.0, 999.0])}
    return RunSet(signals, torch.tensor([1.0, 4.0, 9.0]), 1e3, "three", speeds, "gear_pair", "transmission_error", "m")


def known():
    return TrainedOn.of(runs(), torch.tensor([0, 1, 1, 0, 0]))


def test_ranges_are_those_of_the_training_runs_alone():
    found = known()
    assert (found.system, found.channel, found.unit) == ("gear_pair", "transmission_error", "m")
    assert found.ranges == {
        "damping_ratio_percent": (1.0, 4.0),
        "mean": (2.0, 12.0),
        "ac_rms": (1.0, 2.0),
        "pinion_speed": (100.0, 300.0),
    }
    assert TrainedOn.from_plain(found.plain()) == found


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (("oscillator", "transmission_error", "m"), ["system", "gear_pair", "oscillator"]),
        (("gear_pair", "pinion_speed", "m"), ["channel", "pinion_speed", "transmission_error"]),
        (("gear_pair", "transmission_error", "V"), ["unit", "V"]),
    ],
)
def test_records_of_another_kind_are_refused(asked, words):
    (problem,) = known().problems(*asked)
    assert all(word in str(problem) for word in words)


def test_records_of_that_kind_are_not():
    assert not known().problems("gear_pair", "transmission_error", "m")


def test_a_checkpoint_that_says_nothing_refuses_nothing():
    silent = TrainedOn.from_plain(None)
    assert not silent.problems("oscillator", "displacement", "V")
    assert not silent.outside(torch.tensor([1.0, 2.0]), 50.0, {"pinion_speed": 7.0})


@pytest.mark.parametrize(
    ("values", "predicted", "speed", "names"),
    [
        ([4.0, 6.0], 2.0, 200.0, []),
        ([4.0, 6.0], 2.0, 302.0, []),
        ([4.0, 6.0], 2.0, 320.0, ["pinion_speed"]),
        ([4.0, 6.0], 4.5, 200.0, ["damping_ratio_percent"]),
        ([4.0, 4.2], 2.0, 200.0, ["ac_rms"]),
        ([-1.0, 1.0], 2.0, 200.0, ["mean"]),
        ([-90.0, 90.0], 9.0, 20.0, ["damping_ratio_percent", "mean", "ac_rms", "pinion_speed"]),
    ],
)
def test_what_lies_outside_the_ranges_is_said(values, predicted, speed, names):
    said = known().outside(torch.tensor(values), predicted, {"pinion_speed": speed, "humidity": 3.0})
    assert [sentence.split()[0] for sentence in said] == names
