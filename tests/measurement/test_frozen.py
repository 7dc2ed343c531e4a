"""A value that is kept while the motion goes on is a fault of the record; one at which the motion stood is none."""

import numpy as np
import pytest

from gear_damping.measurement.frozen import frozen
from gear_damping.measurement.record import Channel

T = np.arange(3000) / 100
DECAY = np.exp(-0.1 * T) * np.cos(8 * T) + np.random.default_rng(5).normal(0, 0.003, T.size)


def _said(values, name="displacement"):
    return frozen(Channel(name, values, "m"))


def test_a_kept_value_is_found_where_the_motion_went_on():
    values = DECAY.copy()
    values[400:412], values[900:930] = values[399], values[899]
    found = _said(values)
    assert found.kind == "frozen"
    assert found.sample == 399
    assert found.severity == "data_problem"
    assert "2 stretch(es)" in found.message
    assert "42 samples in all" in found.message


def test_a_sound_decay_has_none():
    assert _said(DECAY) is None


def test_rests_at_the_ends_are_none():
    assert _said(np.concatenate([np.full(40, DECAY[0] - 0.2), DECAY, np.full(40, DECAY[-1] + 0.2)])) is None


def test_where_friction_holds_the_motion_begins_again_with_small_steps():
    speed = np.clip(np.sin(3 * T), 0, None)  # moves for half of a period and stands for the other
    assert _said(np.cumsum(speed) / 100) is None


@pytest.mark.parametrize("step", [0.02, 0.05])
def test_a_coarse_converter_repeats_values_everywhere(step):
    values = np.round(DECAY / step) * step
    values[400:412] = values[399]
    assert _said(values) is None


def test_a_value_that_is_renewed_slowly_throughout_is_none():
    """The speed of a drive that works its encoder out anew every 9 to 30 samples."""
    renewed = np.r_[0, np.cumsum(np.random.default_rng(3).integers(9, 31, 300))]
    speed = 100 * np.sign(np.sin(T)) * (1 - np.exp(-5 * (T % np.pi))) + np.random.default_rng(4).normal(0, 1, T.size)
    last = renewed[np.searchsorted(renewed, np.arange(T.size), side="right") - 1]
    assert _said(speed[last]) is None


def test_an_input_may_be_held():
    values = DECAY.copy()
    values[900:930] = values[899]
    assert _said(values, "force") is None


@pytest.mark.parametrize("last", [0.0, DECAY[-1]], ids=["filled up with zeros", "lost"])
def test_one_value_to_the_end_at_which_nothing_came_to_rest_is_a_fault(last):
    found = _said(np.concatenate([DECAY[:800], np.full(60, last)]))
    assert found.severity == "data_problem"
    assert "over its last 60 samples" in found.message
    assert "slice: [0, 800]" in found.message


def test_a_motion_that_friction_brought_to_rest_ends_in_a_rest():
    moves = np.arange(400) / 100
    slower = np.exp(-0.1 * moves) * np.cos(np.pi * moves)  # stops where it turns
    assert _said(np.concatenate([slower, np.full(60, slower[-1])])) is None


@pytest.mark.parametrize(("swings", "is_told"), [(0.004, False), (0.4, True)])
def test_a_motion_that_has_died_away_is_held_where_it_is(swings, is_told):
    """A filter behind the sensor makes its last steps long ones; of a large motion the same is a buffer's end."""
    values = (1 - swings) * np.exp(-0.3 * T) * np.cos(8 * T) + swings * np.cos(8 * T) + 1e-7 * np.arange(T.size)
    kept = np.concatenate([values, np.full(200, values[-1])])
    assert (_said(kept) is not None) is is_told
