"""The network of whole records on wavelet energies."""

from typing import ClassVar

from gear_damping.identification.estimators.base import RecordNetwork
from gear_damping.identification.features import FrameFrontEnd
from gear_damping.identification.networks import RecordLSTM
from gear_damping.setting import Setting

NYQUIST_SHARE = 0.98  # of half the sampling rate, below which every wavelet lies


class RecordCwtLSTM(RecordNetwork):
    """An LSTM over the wavelet energies of all frames of a record: damping ratio, deviation, calibrated interval."""

    name = "record_cwt_lstm"
    reference = "LSTM of Yousfi et al. (2026) over whole records; attention of Bahdanau et al. (2015)"
    settings: ClassVar = (
        Setting("hidden_size", 60, "units of the LSTM", 1, 4096),
        Setting("dropout", 0.0, "part of what was read that is dropped in training", 0.0, 0.99),
        Setting("bands", 35, "wavelets, equally far apart in frequency", 2, 512),
        Setting("lowest_hz", 800.0, "frequency of the first", 1e-6, 1e9),
        Setting("highest_hz", 7600.0, "frequency of the last", 1e-6, 1e9),
        Setting("frame_ms", 1.0, "between frames, and the standard deviation of a wavelet's envelope", 1e-6, 1e6),
    )

    def front_end(self, sampling_rate: float) -> FrameFrontEnd:
        """Log energies of the frames.

        Raises:
            ValueError: the frequencies do not ascend below half the sampling rate.
        """
        low, high, count = (self.values[name] for name in ("lowest_hz", "highest_hz", "bands"))
        if not low < high <= NYQUIST_SHARE * sampling_rate / 2:
            limit = f"{NYQUIST_SHARE * sampling_rate / 2:g}"
            raise ValueError(f"lowest_hz < highest_hz <= {limit} Hz is needed at this rate, got {low:g} and {high:g}")
        step, frame = (high - low) / (count - 1), self.values["frame_ms"] / 1e3
        return FrameFrontEnd(sampling_rate, [low + i * step for i in range(count)], frame, frame)

    def network(self, n_features: int) -> RecordLSTM:
        """LSTM, pooling, hidden layer, normal distribution."""
        return RecordLSTM(n_features, self.values["hidden_size"], self.values["dropout"])
