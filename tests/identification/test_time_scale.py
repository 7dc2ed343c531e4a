"""The time in which a motion forgets itself, against closed forms."""

import numpy as np
import pytest
import torch

from gear_damping.identification.output_error.records import FitRecord
from gear_damping.identification.time_scale import characteristic_time

LONG = FitRecord("a", torch.tensor(np.sin(np.arange(60_000) / 50)), 100.0)  # 600 s


@pytest.mark.parametrize(
    ("frequency", "damping", "expected"),
    [
        (2 * np.pi, 0.1, 1.0),  # rings: its period
        (2.0, 60.0, 15.0),  # creeps back: damping over stiffness, not one over the damping
        (0.0, 0.5, 2.0),  # no spring: the rate dies away
        (0.001, 60.0, 60.0),  # slower than a tenth of the record
    ],
)
def test_it_is_the_slowest_time_of_the_motion(frequency, damping, expected):
    assert characteristic_time([LONG], frequency, damping) == pytest.approx(expected)


def test_an_overdamped_motion_falls_to_one_part_in_e_in_it():
    """The slow root of s^2 + c s + w^2, with c far above w."""
    frequency, damping = 1.5, 40.0
    slow = damping / 2 - np.sqrt(damping**2 / 4 - frequency**2)
    assert characteristic_time([LONG], frequency, damping) == pytest.approx(1 / slow, rel=0.01)
