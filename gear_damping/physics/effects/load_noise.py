"""Noise of the load."""

from typing import ClassVar

import torch
from torch import Tensor

from gear_damping.physics.parameter import Parameter
from gear_damping.physics.systems.traits import Trait
from gear_damping.physics.terms import HeldLoad, Values


class LoadNoise(HeldLoad):
    """White noise on the load, held over an output sample: it drives the motion."""

    name = "load_noise"
    refinement = 1.2  # of the steps, measured by step halving: the load has content up to half the rate
    equation = "F + w_k on sample k, std(w) = |F0| 10^(-SNR/20)"
    reference = "Yousfi et al. (2026), noise on the load"
    parameters: ClassVar = (Parameter("snr_db", "dB", 20.0, "mean load to noise in dB", -40, 200),)
    needs: ClassVar = (Trait.PRELOAD,)

    def draw(self, values: Values, mean_load: Tensor, samples: int, generator: torch.Generator) -> Tensor:
        """One force for each output sample, (batch, samples)."""
        shape = (mean_load.shape[0], samples)
        noise = torch.randn(shape, generator=generator, dtype=mean_load.dtype, device=generator.device).to(mean_load)
        return noise * (mean_load.abs() * 10 ** (-values["snr_db"] / 20)).unsqueeze(1)
