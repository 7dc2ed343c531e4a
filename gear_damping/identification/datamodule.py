"""From runs to batches of windows: signals stay where they are, a batch is one indexing operation."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import lightning as L
import torch
from torch import Tensor

from gear_damping.identification.noise import SensorNoise, ac_rms_of_runs, noisy_records
from gear_damping.identification.processes import WHOLE, Share
from gear_damping.identification.protocols import Protocol
from gear_damping.identification.runs import RunSet
from gear_damping.identification.seeding import seeded_generator
from gear_damping.identification.windows import gather_windows

_CLEAN = SensorNoise(None)
_COLUMN_RUNS = 64  # runs transformed at a time
_FITTED_WINDOWS = 8192  # windows that normalisation is fitted on

Batch = tuple[Tensor, Tensor]


@dataclass(frozen=True)
class WindowSource:
    """Windows of one part of the data.

    Args:
        values: Signals (runs, time) or columns (runs, time, feature).
        labels: Damping ratio of each run in %, (runs,).
        ac_rms: AC root mean square of each run, (runs,), for the noise.
        index: Run (row of `values`) and first sample of each window, (windows, 2).
        window: Samples of a window.
        noise: Noise that is added to each batch.
    """

    values: Tensor
    labels: Tensor
    ac_rms: Tensor
    index: Tensor
    window: int
    noise: SensorNoise = _CLEAN

    def batch(self, chosen: Tensor, generator: torch.Generator) -> Batch:
        """The windows numbered by `chosen` (with fresh noise) and their labels."""
        index = self.index[chosen]
        windows = gather_windows(self.values, index, self.window)
        runs = index[:, 0]
        return self.noise.add(windows, self.ac_rms[runs], generator), self.labels[runs]


class WindowBatches:
    """Iterable over the batches of a source; what it draws depends on the seed and the epoch alone.

    Args:
        source: The windows.
        batch_size: Windows of a batch; the last one may be smaller.
        seed: Seed of order and noise.
        draw: Windows drawn afresh, without replacement, for each epoch; None gives all in their order.
        epoch: Says which epoch it is.
        share: The part of every batch that this process takes.
    """

    def __init__(
        self,
        source: WindowSource,
        batch_size: int,
        seed: int,
        draw: int | None = None,
        epoch: Callable[[], int] = lambda: 0,
        share: Share = WHOLE,
    ) -> None:
        self.source, self.batch_size, self.seed, self.draw, self.epoch = source, batch_size, seed, draw, epoch
        self.share = share
        self.n_windows = len(source.index) if draw is None else min(draw, len(source.index))

    def __len__(self) -> int:
        return -(-self.n_windows // self.batch_size)

    def __iter__(self) -> Iterator[Batch]:
        device = self.source.values.device
        noise = seeded_generator(self.seed, "batch noise", self.epoch(), device=device)
        for chosen in self._order().to(device).split(self.batch_size):
            inputs, labels = self.source.batch(chosen, noise)
            yield self.share.part(inputs), self.share.part(labels)

    def _order(self) -> Tensor:
        if self.draw is None:
            return torch.arange(len(self.source.index))
        order = seeded_generator(self.seed, "order", self.epoch())
        return torch.randperm(len(self.source.index), generator=order)[: self.draw]


@dataclass(frozen=True)
class Material:
    """What is learned from.

    Args:
        run_set: The runs.
        protocol: How they are split.
        noise: The sensor.
        test_runs: Runs to test on instead of a part of `run_set` (by_run).

    Raises:
        ValueError: the test runs have another sampling rate.
    """

    run_set: RunSet
    protocol: Protocol
    noise: SensorNoise = _CLEAN
    test_runs: RunSet | None = None

    def __post_init__(self) -> None:
        if self.test_runs is not None and self.test_runs.sampling_rate != self.run_set.sampling_rate:
            raise ValueError(
                f"test_runs have {self.test_runs.sampling_rate:g} Hz and run_set {self.run_set.sampling_rate:g} Hz: "
                "simulate both at one sampling_rate"
            )


class WindowDataModule(L.LightningDataModule):
    """Training, validation and test windows of a set of runs under a protocol.

    Under `by_run` each training batch gets fresh sensor noise. Validation and test runs are noisy records,
    one realisation each, the same at every pass and for every estimator of the same seed. Under the
    chronological protocols the noise is part of the runs, one realisation for all three parts, because it
    has to be there before a whole run is transformed.

    Args:
        material: Runs, their split, the sensor.
        seed: Seed of split, order and noise.
        batch_size: Windows of a training batch.
        evaluation_batch_size: Windows of a validation or test batch.
    """

    def __init__(
        self, material: Material, *, seed: int = 0, batch_size: int = 256, evaluation_batch_size: int = 4096
    ) -> None:
        super().__init__()
        self.material, self.seed = material, seed
        self.run_set, self.test_runs = material.run_set, material.test_runs or material.run_set
        self.protocol, self.noise = material.protocol, material.noise
        self.batch_size, self.evaluation_batch_size = batch_size, evaluation_batch_size
        self.share = WHOLE  # of the training batches; every process validates on all runs
        self.split = self.protocol.split(self.run_set, seed, material.test_runs)
        self._sources: dict[tuple[str, torch.device], WindowSource] = {}
        self.use_signals()

    @property
    def training_labels(self) -> Tensor:
        """Label of every training window, (windows,), in %."""
        return self.run_set.damping_ratio_percent[self.split.train[:, 0]]

    @property
    def test_window_runs(self) -> Tensor:
        """Run of every test window, (windows,)."""
        return self.split.test[:, 0]

    def use_signals(self) -> None:
        """Take windows from the signals themselves: so it is from the start."""
        self._sources.clear()
        self._values = self.run_set.signals
        if self.protocol.chronological and not self.noise.is_clean:
            every = torch.arange(len(self.run_set))
            self._values = noisy_records(self._values, every, self.noise, self.seed, "runs")

    def use_columns(self, transform: Callable[[Tensor], Tensor]) -> None:
        """Replace the runs by columns of the WHOLE run, (runs, time, feature): chronological protocols only.

        The columns of every run are held at once: runs * samples * features * 4 bytes.

        Args:
            transform: Signals (batch, time) to columns (batch, time, feature).
        """
        if not self.protocol.chronological:
            raise ValueError("columns of whole runs see beyond the window: by_run must transform windows")
        self.use_signals()
        self._values = torch.cat([transform(part) for part in self._values.split(_COLUMN_RUNS)])
        self._sources.clear()

    def training_inputs(self) -> Tensor:
        """A seeded sample of training windows or columns with their noise, to fit normalisation on."""
        batches = WindowBatches(self._source("train"), _FITTED_WINDOWS, self.seed, _FITTED_WINDOWS)
        return next(iter(batches))[0]

    def train_dataloader(self) -> WindowBatches:
        """Batches of the epoch that the trainer is in."""
        source = self._source("train")
        draw = self.protocol.windows_per_epoch or len(source.index)
        epoch = lambda: self.trainer.current_epoch  # noqa: E731 - asked anew at each pass
        return WindowBatches(source, self.batch_size, self.seed, draw, epoch, self.share)

    def val_dataloader(self) -> WindowBatches:
        """All validation windows in their order."""
        return WindowBatches(self._source("validation"), self.evaluation_batch_size, self.seed)

    def test_dataloader(self) -> WindowBatches:
        """All test windows in their order."""
        return WindowBatches(self._source("test"), self.evaluation_batch_size, self.seed)

    def _source(self, part: str) -> WindowSource:
        device = torch.device("cpu") if self.trainer is None else self.trainer.strategy.root_device
        if (part, device) not in self._sources:
            self._sources[part, device] = self._build(part, device)
        return self._sources[part, device]

    def _build(self, part: str, device: torch.device) -> WindowSource:
        runs = self.test_runs if part == "test" else self.run_set
        index = getattr(self.split, part)
        values, labels, noise = runs.signals, runs.damping_ratio_percent.float(), _CLEAN
        if self.protocol.chronological:
            values = self._values
        elif part == "train":
            noise = self.noise
        elif not self.noise.is_clean:
            numbers, rows = index[:, 0].unique(return_inverse=True)
            name = "test_runs" if runs is not self.run_set else "runs"
            values, labels = noisy_records(values, numbers, self.noise, self.seed, name), labels[numbers]
            index = torch.stack([rows, index[:, 1]], dim=1)
        rms = torch.zeros(len(values)) if noise.is_clean else ac_rms_of_runs(values)
        moved = (tensor.to(device) for tensor in (values, labels, rms, index))
        return WindowSource(*moved, self.protocol.window, noise)
