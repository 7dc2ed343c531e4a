"""How a record's motion begins and how large it is, from whatever was recorded of it."""

import numpy as np
import pytest
import torch

from gear_damping.identification.output_error.first_guess import first_motion
from gear_damping.identification.output_error.records import FitRecord, Observed

CHANNELS = ("displacement", "velocity", "acceleration")


@pytest.mark.parametrize("derivatives", [0, 1, 2])
@pytest.mark.parametrize(("rate", "frequency"), [(600.0, 151.0), (1000.0, 30.0), (50.0, 0.9)])
def test_a_decay_is_as_large_as_it_is_whatever_was_recorded_of_it(derivatives, rate, frequency):
    """Two integrals of an acceleration add up its mean: of 151 Hz for 0.7 s that was sixty times the motion."""
    pole = 2 * np.pi * frequency * (-0.003 + 1j)
    time = np.arange(round(105 / frequency * rate)) / rate
    motion = [(1e-3 * pole**order * np.exp(pole * time)).real for order in range(3)]
    noise = 1e-4 * motion[derivatives].std() * np.random.default_rng(0).normal(size=time.size)
    shown = torch.from_numpy(motion[derivatives] + noise)
    record = FitRecord("decay", shown, rate, observed=Observed(CHANNELS[derivatives]))
    _, scale = first_motion(record, 0.0, 0.0)
    assert scale.tolist() == pytest.approx([motion[0].std(), motion[1].std()], rel=0.4)
