"""Noise of the sensor, as one draw for a record; what networks are trained with is drawn in identification/noise.py."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import Recording, Sensor, Values


class SensorNoise(Sensor):
    """White noise on the record: it does not drive the motion."""

    name = "sensor_noise"
    equation = "y + w, std(w) = std(y) 10^(-SNR/20), per run"
    reference = "Yousfi et al. (2026), additive noise"
    parameters: ClassVar = (Parameter("snr_db", "dB", 30.0, "AC part of the run to noise in dB", -40, 200),)
    position = 70  # in the chain, behind what filters and delays

    def measure(self, signal: Tensor, values: Values, recording: Recording) -> Tensor:
        """The noisy record."""
        source = recording.generator
        noise = torch.randn(signal.shape, generator=source, dtype=signal.dtype, device=source.device).to(signal)
        size = signal.std(dim=-1, keepdim=True, correction=0)
        return signal + noise * size * 10 ** (-values["snr_db"] / 20).unsqueeze(1)
