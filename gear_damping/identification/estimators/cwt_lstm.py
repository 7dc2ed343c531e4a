"""The network on wavelet columns."""

from collections.abc import Mapping
from typing import Any, ClassVar

from gear_damping.identification.estimators.base import WindowEstimator
from gear_damping.identification.estimators.raw_lstm import RawLSTM
from gear_damping.identification.features import WaveletFrontEnd
from gear_damping.identification.networks import DampingLSTM


class CwtLSTM(WindowEstimator):
    """The same LSTM, which reads the wavelet coefficients at each sample."""

    name = "cwt_lstm"
    reference = RawLSTM.reference
    settings: ClassVar = RawLSTM.settings
    transforms = True

    def front_end(self, sampling_rate: float, wavelet: Mapping[str, Any]) -> WaveletFrontEnd:
        """The transform of the window."""
        return WaveletFrontEnd(wavelet, sampling_rate)

    def network(self, n_features: int) -> DampingLSTM:
        """LSTM, dropout, dense, softplus."""
        return DampingLSTM(n_features, **self.values)
