"""Errors of pitches that lie on a slow wave are those of an encoder's disc, and no record of its angle tells which."""

import numpy as np
import pytest

from gear_damping.physics.effects.pitch_error import PitchError

TEETH = 2 * np.pi * np.arange(26) / 26
RANDOM = np.random.default_rng(11).standard_normal(26)


@pytest.mark.parametrize(
    ("values", "looks_like"),
    [
        (0.2 * np.cos(2 * TEETH - 0.9) + 0.01 * RANDOM, ("encoder_error",)),  # a tilted disc
        (np.cos(TEETH) + 0.4 * np.cos(2 * TEETH), ("encoder_error",)),  # an eccentric one
        (np.cos(3 * TEETH), ()),
        (RANDOM, ()),
        (np.zeros(26), ()),
    ],
)
def test_a_wave_of_one_or_two_periods_a_turn_looks_like_an_encoder(values, looks_like):
    assert PitchError.cause.alike({"values": tuple(values)}) == looks_like
