"""The network on raw windows."""

from typing import ClassVar

from gear_damping.identification.estimators.base import WindowEstimator
from gear_damping.identification.features import FrontEnd
from gear_damping.identification.networks import DampingLSTM
from gear_damping.setting import Setting
from gear_damping.signals.wavelets.base import ContinuousWavelet


class RawLSTM(WindowEstimator):
    """An LSTM that reads the samples of a window one after another."""

    name = "raw_lstm"
    reference = "Yousfi et al. (2026), section 2.3"
    settings: ClassVar = (
        Setting("hidden_size", 60, "units of the LSTM", 1, 4096),
        Setting("dropout", 0.2, "part of the state that is dropped in training", 0.0, 0.99),
        Setting("start_at_mean", True, "training starts at the mean label; false: where the drawn weights lie"),
    )

    def front_end(self, transform: ContinuousWavelet | None) -> FrontEnd:
        """The window itself."""
        return FrontEnd()

    def network(self, n_features: int) -> DampingLSTM:
        """LSTM, dropout, dense, softplus."""
        return DampingLSTM(n_features, **self.values)
