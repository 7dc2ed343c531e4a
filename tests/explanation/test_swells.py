"""A free motion that grows again after it fell has got energy back; a decay of any law has not."""

import numpy as np
import pytest
import torch

from gear_damping.explanation.model.rig import swells_again
from gear_damping.identification.output_error.records import FitRecord

RATE, NATURAL = 20.0, 4.5 / (2 * np.pi)
TIME = np.arange(1600) / RATE
NOISE = 0.01 * np.random.default_rng(2).normal(size=TIME.size)
CARRIER = np.cos(4.5 * TIME)
SIZES = {
    "viscous": (np.exp(-0.1 * TIME), False),
    "dry": (np.clip(1 - TIME / 40, 0, None), False),
    "drag": (1 / (1 + 0.2 * TIME), False),
    "beats": (np.exp(-0.02 * TIME) * np.cos(0.085 * TIME), True),
    "half beats": (np.exp(-0.02 * TIME) * (0.6 + 0.4 * np.cos(0.17 * TIME)), True),
    "beats of eight periods": (np.exp(-0.16 * TIME) * np.sin(0.28 * TIME), True),  # from the one that was at rest
    "struck again": (np.exp(-0.1 * (TIME % 30)), True),
}


@pytest.mark.parametrize("name", SIZES)
def test_what_grows_again_is_told(name):
    size, expected = SIZES[name]
    assert swells_again(FitRecord(name, torch.as_tensor(size * CARRIER + NOISE), RATE, {}), NATURAL) == expected


def test_a_driven_record_and_a_short_one_are_not_asked():
    swelling = torch.as_tensor(SIZES["beats"][0] * CARRIER)
    assert not swells_again(FitRecord("driven", swelling, RATE, {"force": swelling}), NATURAL)
    assert not swells_again(FitRecord("short", swelling[:100], RATE, {}), NATURAL)
