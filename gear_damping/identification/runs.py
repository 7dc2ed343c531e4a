"""The runs that a learner meets: signals, labels and the rate, and nothing of the model behind them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import torch
from torch import Tensor


@dataclass(frozen=True)
class RunSet:
    """A set of runs of one channel; the signals are held once and every window is read from them.

    Args:
        signals: Signal of each run, (runs, time), float32, all finite.
        damping_ratio_percent: Damping ratio of each run, (runs,), in % of critical, float32.
        sampling_rate: Samples per second (Hz).
        id: What the data set is called; a checkpoint remembers it.
        quantities: Further numbers of each run, name -> (runs,), for example the speed.
        system: `gear_pair` or `oscillator`; "" where it is not known.
        channel: Which response the signals are.
        unit: Of the signals.

    Raises:
        ValueError: shapes, type or values break one of these rules.
    """

    signals: Tensor
    damping_ratio_percent: Tensor
    sampling_rate: float
    id: str
    quantities: Mapping[str, Tensor] = field(default_factory=dict)
    system: str = ""
    channel: str = ""
    unit: str = ""

    def __post_init__(self) -> None:
        _require_signals(self.signals)
        for name, values in {"damping_ratio_percent": self.damping_ratio_percent, **self.quantities}.items():
            if tuple(values.shape) != (len(self),):
                shape = tuple(values.shape)
                raise ValueError(f"{name} must have shape ({len(self)},), one value per run, got {shape}")
        if not self.sampling_rate > 0:
            raise ValueError(f"sampling_rate must be positive, got {self.sampling_rate!r}")
        labels = self.damping_ratio_percent
        if not bool((torch.isfinite(labels) & (labels >= 0)).all()):
            raise ValueError("damping_ratio_percent must be finite and >= 0: drop runs without a label")

    def __len__(self) -> int:
        return self.signals.shape[0]

    @property
    def n_samples(self) -> int:
        """Samples of each run."""
        return self.signals.shape[1]

    def subset(self, index: Tensor) -> "RunSet":
        """The runs numbered by `index` (integers or a mask), copied, under the same id."""
        return replace(
            self,
            signals=self.signals[index],
            damping_ratio_percent=self.damping_ratio_percent[index],
            quantities={name: values[index] for name, values in self.quantities.items()},
        )


def _require_signals(signals: Tensor) -> None:
    if signals.ndim != 2 or 0 in signals.shape:
        shape = tuple(signals.shape)
        raise ValueError(f"signals must have shape (runs, time), got {shape}: select one channel")
    if signals.dtype != torch.float32:
        raise ValueError(f"signals must be float32, got {signals.dtype}: convert them with .float()")
    finite = signals.isfinite().all(dim=1)
    if not bool(finite.all()):
        broken = finite.logical_not().nonzero().flatten().tolist()
        raise ValueError(f"signals must be finite, runs {broken[:5]} are not: drop runs that diverged")
