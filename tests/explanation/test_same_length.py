"""A held-out record that is longer than the fitted ones shows no more of a wandering zero than these do."""

from types import SimpleNamespace

import pytest
import torch

from gear_damping.explanation.evidence.same_length import as_fitted


def record(seconds, *offsets):
    return SimpleNamespace(duration=seconds, channels=[SimpleNamespace(offset=one) for one in offsets])


def test_every_stretch_as_long_as_the_longest_fitted_record_has_its_own_offset():
    wandering = torch.tensor([3.0, 3, 3, 3, -1, -1, -1, -1], dtype=torch.float64)
    motion = torch.tensor([1.0, -1] * 4, dtype=torch.float64)
    (left,) = as_fitted([wandering + motion], [record(2.1, True)], [record(0.5, True), record(1.0, True)])
    assert left.tolist() == pytest.approx(motion.tolist())


def test_a_channel_whose_zero_is_known_keeps_it():
    rows = torch.cat([torch.full((4,), 2.0), torch.tensor([5.0, 5.0, 7.0, 7.0])]).double()
    (left,) = as_fitted([rows], [record(2.0, False, True)], [record(1.0, False, True)])
    assert left.tolist() == [2.0] * 4 + [0.0] * 4


@pytest.mark.parametrize("seconds", [0.3, 1.0, 1.4])
def test_a_record_of_their_length_or_less_stays_as_it_is(seconds):
    left = torch.tensor([4.0, 4, 8, 8], dtype=torch.float64)
    assert as_fitted([left], [record(seconds, True)], [record(1.0, True)])[0] is left
