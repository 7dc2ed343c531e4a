"""What Lightning needs in order to be a quiet, reproducible and interruptible part of a program."""

import io
import logging
import signal
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import lightning as L
import torch
from lightning.pytorch.callbacks import Callback, EarlyStopping, ModelCheckpoint
from lightning.pytorch.loggers import TensorBoardLogger
from lightning.pytorch.plugins.io import TorchCheckpointIO

from gear_damping.errors import written_whole
from gear_damping.identification.seeding import derived_seed

# Below this batch size a second thread costs more than it brings: LSTM of 60 units on 30 samples, windows
# per second with 1 and 2 threads: 28k and 22k at batch 32, 37k and 49k at 256.
THREADS_PAY_FROM = 128


class EpochSeeds(Callback):
    """Seeds dropout from the number of the epoch, so that a resumed fit goes on as if never interrupted."""

    def __init__(self, seed: int, first_checkpoint: Path) -> None:
        self.seed, self.first_checkpoint = seed, first_checkpoint

    def on_train_start(self, trainer: L.Trainer, pl_module: L.LightningModule) -> None:
        """Leave something to resume from an interruption in the first epoch."""
        if trainer.current_epoch == 0:
            trainer.save_checkpoint(self.first_checkpoint)

    def on_train_epoch_start(self, trainer: L.Trainer, pl_module: L.LightningModule) -> None:
        """Seed the epoch."""
        own = [] if trainer.global_rank == 0 else [trainer.global_rank]  # each process drops others
        torch.manual_seed(derived_seed(self.seed, "dropout", trainer.current_epoch, *own))


class EventsLogger(TensorBoardLogger):
    """TensorBoard events directly in a folder, without the file of hyperparameters that Lightning adds.

    Args:
        folder: Where the events go.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, name="", version="", default_hp_metric=False)

    def save(self) -> None:
        """Write out what is still in memory."""
        self.experiment.flush()


class Patience(EarlyStopping):
    """Early stopping whose patience is that of this fit, also where it resumes one that had another."""

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Take over what was counted."""
        super().load_state_dict({**state_dict, "patience": self.patience})


class PortableCheckpoint(ModelCheckpoint):
    """`folder`/`name`.ckpt at the end of each epoch, or of each best one.

    It can go on in another folder: the paths that it remembers move with the files.

    Args:
        folder: Where the file goes.
        name: Name of the file without its ending.
        monitor: Keep the epoch in which this is lowest; None keeps the last one.
    """

    def __init__(self, folder: Path, name: str, monitor: str | None = None) -> None:
        super().__init__(folder, name, monitor=monitor, save_on_train_epoch_end=True, enable_version_counter=False)

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Take over what a checkpoint says of best and last, with the folder of this fit."""
        folder = Path(self.dirpath)

        def moved(path: str) -> str:
            return str(folder / Path(path).name) if path else ""

        best_k = {moved(path): score for path, score in state_dict["best_k_models"].items()}
        paths = {name: moved(state_dict[name]) for name in ("best_model_path", "last_model_path")}
        kth = moved(state_dict["kth_best_model_path"])
        changed = {"dirpath": self.dirpath, "best_k_models": best_k, "kth_best_model_path": kth, **paths}
        super().load_state_dict({**state_dict, **changed})


class WholeCheckpoints(TorchCheckpointIO):
    """Checkpoints that are written beside their place and then put there: Lightning goes by way of another disk."""

    def save_checkpoint(self, checkpoint: dict[str, Any], path: str | Path, storage_options: Any = None) -> None:
        """Write a checkpoint whole or not at all."""
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        with written_whole(path) as unfinished, unfinished.open("wb") as file:
            content = io.BytesIO()  # torch's own writer dies of a full disk without saying why
            torch.save(checkpoint, content)
            file.write(content.getbuffer())


@contextmanager
def own_randomness(seed: int) -> Iterator[None]:
    """Seed torch's generators inside, and leave them outside as they were."""
    with torch.random.fork_rng(devices=range(torch.cuda.device_count())):
        torch.manual_seed(seed)
        yield


@contextmanager
def threads(batch_size: int) -> Iterator[None]:
    """One thread for batches that more would slow down; the caller's setting otherwise."""
    before = torch.get_num_threads()
    torch.set_num_threads(1 if batch_size < THREADS_PAY_FROM else before)
    try:
        yield
    finally:
        torch.set_num_threads(before)


@contextmanager
def quiet_lightning() -> Iterator[None]:
    """No banners and tips; what its loggers warn of reaches the application's handlers, once."""
    for name in ("lightning", "lightning.pytorch", "lightning.fabric"):
        logger = logging.getLogger(name)
        logger.handlers.clear()
        logger.propagate = True
        logger.setLevel(logging.WARNING)
    with warnings.catch_warnings():
        # Lightning 2.6 asks torch 2.13 about its trees in a way that torch wants to retire.
        warnings.filterwarnings("ignore", message=r"`isinstance\(treespec, LeafSpec\)` is deprecated")
        # A fit shares its folder with the TensorBoard events, and a resumed one overwrites its own files.
        warnings.filterwarnings("ignore", message="Checkpoint directory .* exists and is not empty")
        # On a login node of a cluster; a job of one process needs no `srun`.
        warnings.filterwarnings("ignore", message="The `srun` command is available")
        yield


@contextmanager
def interruptible() -> Iterator[None]:
    """Let an interruption reach the caller: Lightning mutes Ctrl-C for good and leaves through sys.exit."""
    in_main_thread = threading.current_thread() is threading.main_thread()
    handler = signal.getsignal(signal.SIGINT)
    try:
        yield
    except SystemExit as leaving:
        if isinstance(leaving.__context__, KeyboardInterrupt):
            raise KeyboardInterrupt from leaving
        raise
    finally:
        if in_main_thread:
            signal.signal(signal.SIGINT, handler)
