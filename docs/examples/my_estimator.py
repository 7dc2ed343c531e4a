"""An estimator of one's own: convolutions that halve the rate, and the mean of what they find."""

from itertools import pairwise
from typing import ClassVar

from torch import Tensor, nn

from gear_damping.identification.estimators.base import WindowEstimator
from gear_damping.identification.features import FrontEnd
from gear_damping.identification.networks import DampingNetwork
from gear_damping.setting import Setting
from gear_damping.signals.wavelets import ContinuousWavelet


class Convolutions(DampingNetwork):
    """Layers of convolution with a stride of 2."""

    def __init__(self, n_features: int, channels: int, layers: int, dropout: float) -> None:
        super().__init__()
        widths = [n_features, *([channels] * layers)]
        stages = [stage for a, b in pairwise(widths) for stage in (nn.Conv1d(a, b, 5, stride=2, padding=2), nn.GELU())]
        self.body = nn.Sequential(*stages)
        self.end(channels, dropout)

    def state(self, features: Tensor) -> Tensor:
        """The mean over time, (batch, channels)."""
        return self.body(features.transpose(1, 2)).mean(-1)


class RawConvolution(WindowEstimator):
    """Convolutions over the samples of a window."""

    name = "raw_convolution"
    reference = "one's own"
    settings: ClassVar = (
        Setting("channels", 16, "of every layer", 1, 1024),
        Setting("layers", 3, "of convolution", 1, 10),
        Setting("dropout", 0.1, "part of the state that is dropped in training", 0.0, 0.99),
    )

    def front_end(self, transform: ContinuousWavelet | None) -> FrontEnd:
        """The window itself."""
        return FrontEnd()

    def network(self, n_features: int) -> Convolutions:
        """Convolutions, mean, dropout, dense, softplus."""
        return Convolutions(n_features, **self.values)
