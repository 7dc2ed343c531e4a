"""The network on wavelet columns."""

from typing import ClassVar

from gear_damping.identification.estimators.base import WindowEstimator
from gear_damping.identification.estimators.raw_lstm import RawLSTM
from gear_damping.identification.features import WaveletFrontEnd
from gear_damping.identification.networks import DampingLSTM
from gear_damping.signals.wavelets.base import ContinuousWavelet


class CwtLSTM(WindowEstimator):
    """The same LSTM, which reads the wavelet coefficients at each sample."""

    name = "cwt_lstm"
    reference = RawLSTM.reference
    settings: ClassVar = RawLSTM.settings
    transforms = True

    def front_end(self, transform: ContinuousWavelet | None) -> WaveletFrontEnd:
        """The transform of the window."""
        return WaveletFrontEnd(transform)

    def network(self, n_features: int) -> DampingLSTM:
        """LSTM, dropout, dense, softplus."""
        return DampingLSTM(n_features, **self.values)
