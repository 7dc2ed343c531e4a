"""The learned estimator: front-end, network, loss and what a checkpoint needs in order to predict."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isnan
from typing import Any, NamedTuple

import lightning as L
import torch
from torch import Tensor

from gear_damping.errors import InputError, Problem
from gear_damping.identification.catalogue import kind_of, make_wavelet
from gear_damping.identification.estimators.base import LearnedEstimator, RecordNetwork
from gear_damping.identification.familiarity import Components
from gear_damping.identification.features import FrontEnd
from gear_damping.identification.networks import DampingNetwork
from gear_damping.identification.sizes import MOST_CELLS
from gear_damping.identification.trained_on import TrainedOn
from gear_damping.identification.windows import gather_windows, window_starts, windows_of_runs

# A rate that is wrong by this fraction moves every frequency, and with it the damping, by the same.
_RATE_TOLERANCE = 1e-3
_WINDOWS_AT_ONCE = 4096  # that are evaluated together, so that memory stays bounded
CONSTANT, COSINE = "constant", "cosine"  # how the learning rate goes over the epochs
_PLAIN = (bool, int, float, str, list, tuple)


@dataclass(frozen=True)
class EstimatorConfig:
    """The estimator that is to be trained.

    Args:
        estimator: Its name in the catalogue.
        settings: The numbers that it is built by; its own defaults where absent.
        wavelet: Kind and plain arguments of the transform (`catalogue.make_wavelet`), for those that transform.
        plugins: The user's own estimator files.
        whole_run_columns: Where the protocol allows it, transform whole runs, as the paper does; False
            transforms each window by itself under every protocol.
    """

    estimator: str = "raw_lstm"
    settings: Mapping[str, float | int] = field(default_factory=dict)
    wavelet: Mapping[str, Any] = field(
        default_factory=lambda: {
            "kind": "ricker", "frequency_min_hz": 500.0, "frequency_max_hz": 10000.0, "n_scales": 32
        }
    )  # fmt: skip
    plugins: tuple[str, ...] = ()
    whole_run_columns: bool = True

    def __post_init__(self) -> None:
        kind_of(self.estimator, self.plugins)(self.settings)
        # Of subclasses too: a numpy float is a float, and a checkpoint that holds one is refused on loading.
        odd = {name: value for name, value in self.wavelet.items() if type(value) not in _PLAIN}
        if odd:
            raise ValueError(f"wavelet must hold plain numbers, texts and lists, got {odd!r}: convert them")


RAW_LSTM = EstimatorConfig("raw_lstm")
CWT_LSTM = EstimatorConfig("cwt_lstm")


class RecordPrediction(NamedTuple):
    """Damping ratio of a record (% of critical).

    The mean and standard deviation over its windows, and each; of a network of whole records, what it says, the
    standard deviation that it states, and its 95 % interval.
    """

    damping_ratio_percent: float
    spread_percent: float
    per_window_percent: Tensor
    interval95: tuple[float, float] | None = None


class DampingModule(L.LightningModule):
    """An estimator of the catalogue, trained on the RMSE of the damping ratio in %, or on its network's likelihood.

    All arguments are plain values and are stored in the checkpoint with the weights, the normalisation
    buffers and the learning curve (`history`): a checkpoint is all that a prediction needs.

    Args:
        estimator: Its name.
        data: What it is trained on, as plain values: the `id` of the runs, their `sampling_rate` (Hz), the `window`
            that it sees at once (samples), `whole_run` (columns are of the whole run, the paper's protocol, not of the
            window), the ranges that it has seen (`trained_on`, of `TrainedOn.plain`; None: not known), and of the
            records that it has seen their `record` (samples) and `components` (0 or absent: not known).
        settings: The numbers that it is built by.
        wavelet: Settings of the transform, for those that transform.
        learning_rate: Step of Adam.
        plugins: Files of the user that may declare the estimator. A checkpoint does not hold them: it runs no code.
    """

    def __init__(
        self,
        estimator: str,
        data: dict[str, Any],
        settings: dict[str, float | int] | None = None,
        wavelet: dict[str, Any] | None = None,
        learning_rate: float = 1e-3,
        plugins: Sequence[str] = (),
    ) -> None:
        super().__init__()
        self.save_hyperparameters(logger=False, ignore=["plugins"])
        self.plugins = tuple(plugins)
        made = kind_of(estimator, plugins)(settings or {})
        self.front_end = _front_end(made, data["sampling_rate"], wavelet, plugins)
        self.network = made.network(self.front_end.n_features)
        components = data.get("components", 0)
        self.components = Components(data["record"], components) if components else None
        self.history: list[dict[str, float]] = []
        self.schedule = CONSTANT
        self._squares = {"train": _Mean(), "val": _Mean()}
        self._losses = {"train": _Mean(), "val": _Mean()}
        self._said: list[tuple[Tensor, Tensor, Tensor]] = []

    @property
    def data(self) -> dict[str, Any]:
        """What it is trained on, as plain values."""
        return self.hparams["data"]

    @property
    def trained_on(self) -> TrainedOn:
        """The kind of record that it is for, and the ranges that it has seen."""
        return TrainedOn.from_plain(self.data["trained_on"])

    def forward(self, inputs: Tensor) -> Tensor:
        """Damping ratio (%) of windows (batch, window), or of columns (batch, window, feature)."""
        return self.network(self.front_end(inputs))

    def training_step(self, batch: tuple[Tensor, Tensor], _: int) -> Tensor:
        """Loss of one batch."""
        loss, found = self.network.loss(self.front_end(batch[0]), batch[1])
        self._count("train", loss, found, batch[1])
        return loss if self.trainer.world_size == 1 else loss * self._weight(loss.detach(), len(found))

    def validation_step(self, batch: tuple[Tensor, Tensor], _: int) -> None:
        """Collect the errors, so that the figures are those of the whole set, not a mean over batches."""
        features = self.front_end(batch[0])
        if self.network.is_likelihood:
            found, deviation = self.network.distribution(features)
            loss = self.network.unlikelihood(found, deviation, batch[1])
            self._said.append((found, deviation, batch[1]))
        else:
            loss, found = self.network.loss(features, batch[1])
        self._count("val", loss, found, batch[1])

    def _count(self, part: str, loss: Tensor, found: Tensor, labels: Tensor) -> None:
        square = (found - labels).square()
        self._squares[part].add(square)
        self._losses[part].add(loss.expand_as(square))

    def on_train_epoch_end(self) -> None:
        """Log the epoch, add it to the learning curve, and take the widths of intervals from the validation runs.

        Once an epoch: logging each step costs about as much as the step.
        """
        rate = self.trainer.optimizers[0].param_groups[0]["lr"]
        many = self.trainer.world_size > 1
        errors = {part: self._mean(part, squares) ** 0.5 for part, squares in self._squares.items()}
        losses = {part: self._mean(part, values) for part, values in self._losses.items()}
        shown = losses if self.network.is_likelihood else errors
        epoch = {
            "train_loss": shown["train"],
            "val_loss": shown["val"],
            "val_rmse_percent": errors["val"],
            "learning_rate": rate,
        }
        if self._said:
            self.network.calibrate(*(torch.cat(column) for column in zip(*self._said, strict=True)))
            self._said.clear()
        self.log_dict(
            {name: epoch[name] for name in ("train_loss", "val_loss", "learning_rate")}, batch_size=1, sync_dist=many
        )
        self.log("val_rmse_percent", errors["val"], batch_size=1, prog_bar=True, sync_dist=many)
        self.history.append(epoch)

    def _weight(self, loss: Tensor, members: int) -> Tensor:
        """What makes the mean of the gradients of all processes that of the loss of the whole batch.

        Of a mean that is the share of the members, n W / N; of the root of one, L, also L / L of the whole batch.
        """
        own = torch.stack([torch.full_like(loss, members), members * loss.square()])
        number, squares = self.trainer.strategy.reduce(own, reduce_op="sum")
        share = members * self.trainer.world_size / number
        is_root = type(self.network).loss is DampingNetwork.loss
        return share * loss / (squares / number).sqrt() if is_root else share

    def _mean(self, part: str, values: "_Mean") -> float:
        """The mean of an epoch; of training over what every process saw, each having seen its share."""
        if part == "train" and self.trainer.world_size > 1:
            sums = torch.tensor([float(values.total), values.count], device=self.device)
            values.total, values.count = self.trainer.strategy.reduce(sums, reduce_op="sum").tolist()
        return values.take()

    def configure_optimizers(self) -> dict[str, Any]:
        """Adam, fused into one call for all weights: three times less per step for a network this small."""
        adam = torch.optim.Adam(self.parameters(), lr=self.hparams["learning_rate"], fused=True)
        if self.schedule == CONSTANT:
            return {"optimizer": adam}
        falls = torch.optim.lr_scheduler.CosineAnnealingLR(adam, int(self.trainer.estimated_stepping_batches))
        return {"optimizer": adam, "lr_scheduler": {"scheduler": falls, "interval": "step"}}

    def on_save_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Put the learning curve into the checkpoint."""
        checkpoint["history"] = list(self.history)

    def on_load_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Take the learning curve from the checkpoint."""
        self.history = list(checkpoint["history"])

    @torch.inference_mode()
    def predict_record(self, values: Tensor, sampling_rate: float, stride: int = 1) -> RecordPrediction:
        """Predict the damping ratio of one record of any length.

        The deviation over overlapping windows is no interval of confidence: the windows share samples, and a
        network that is sure of itself can be wrong in all of them.

        A network of whole records reads its beginning, as long as those that it was trained on.

        Args:
            values: Samples of the record, (time,), in the unit of the training signals.
            sampling_rate: Samples per second (Hz), that of the training signals to 0.1 %.
            stride: Samples between windows.

        Raises:
            InputError: another rate, fewer samples than a window, or samples that are not finite.
        """
        values = torch.as_tensor(values, dtype=torch.float32, device=self.device)
        self._check_record(values, sampling_rate)
        was_training = self.training
        self.eval()
        if self.network.is_likelihood:
            said = self._of_its_beginning(values[: self.data["window"]])
            self.train(was_training)
            return said
        record = self.front_end.columns(values[None]) if self.data["whole_run"] else values[None]
        starts = window_starts(0, len(values), self.data["window"], stride)
        index = windows_of_runs(torch.zeros(1, dtype=torch.long), starts).to(self.device)
        cells = self.data["window"] * self.front_end.n_features
        parts = index.split(max(1, min(_WINDOWS_AT_ONCE, MOST_CELLS // cells)))
        each = torch.cat([self(gather_windows(record, part, self.data["window"])) for part in parts]).cpu()
        self.train(was_training)
        return RecordPrediction(float(each.mean()), float(each.std(correction=0)), each)

    def _of_its_beginning(self, values: Tensor) -> RecordPrediction:
        found, deviation = self.network.distribution(self.front_end(values[None]))
        low, high = map(float, self.network.interval(found, deviation, 0.95))
        return RecordPrediction(float(found), float(deviation), found.cpu(), None if isnan(low) else (low, high))

    def _check_record(self, values: Tensor, sampling_rate: float) -> None:
        trained, window = self.data["sampling_rate"], self.data["window"]
        problems = []
        if values.ndim != 1 or len(values) < window:
            rule = f"must be one channel of at least {window} samples, got shape {tuple(values.shape)}"
            problems.append(Problem("values", rule, remedy="use a longer record"))
        elif not bool(values.isfinite().all()):
            problems.append(Problem("values", "must be finite", remedy="cut out the broken samples"))
        if not abs(sampling_rate / trained - 1) <= _RATE_TOLERANCE:
            rule = f"the estimator was trained at {trained:g} Hz and the record has {sampling_rate:g} Hz"
            remedy = f"resample the record to {trained:g} Hz, or train at {sampling_rate:g} Hz"
            if sampling_rate < trained:
                remedy = f"train at {sampling_rate:g} Hz: what a record does not hold, no way to resample it adds"
            problems.append(Problem("sampling_rate", rule, sampling_rate, remedy))
        if problems:
            raise InputError(problems)


def _front_end(
    made: LearnedEstimator, sampling_rate: float, wavelet: dict[str, Any] | None, plugins: Sequence[str]
) -> FrontEnd:
    if isinstance(made, RecordNetwork):
        return made.front_end(sampling_rate)
    return made.front_end(None if wavelet is None else make_wavelet(wavelet, sampling_rate, plugins))


class _Mean:
    """Sum and number of values, kept on the device until the epoch ends."""

    def __init__(self) -> None:
        self.total: Tensor | float = 0.0
        self.count = 0

    def add(self, values: Tensor) -> None:
        self.total = self.total + values.detach().sum()
        self.count += values.numel()

    def take(self) -> float:
        mean = float(self.total) / max(self.count, 1)
        self.total, self.count = 0.0, 0
        return mean
