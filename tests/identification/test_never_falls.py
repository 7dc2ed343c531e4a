"""A motion that something feeds does not die away; a decay does, and one with an input is not asked."""

import numpy as np
import pytest
import torch

from gear_damping.identification.free_vibration import never_falls
from gear_damping.identification.output_error.records import FitRecord

TIME = np.arange(1600) / 20.0
NOISE = 0.004 * np.random.default_rng(2).normal(size=TIME.size)
MOTIONS = {
    "decay": (np.exp(-0.03 * TIME) * np.cos(4.5 * TIME), False),
    "friction": (np.clip(1 - TIME / 70, 0, None) * np.cos(4.5 * TIME), False),
    "fed": (np.cos(4.5 * TIME) * (1 + 0.3 * np.sin(0.11 * TIME)), True),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_what_dies_away_is_told_from_what_does_not(name):
    motion, expected = MOTIONS[name]
    assert never_falls(FitRecord(name, torch.as_tensor(motion + NOISE), 20.0, {})) == expected


def test_a_driven_record_is_not_asked():
    force = {"force": torch.as_tensor(np.sin(4.5 * TIME))}
    assert not never_falls(FitRecord("driven", torch.as_tensor(MOTIONS["fed"][0] + NOISE), 20.0, force))
