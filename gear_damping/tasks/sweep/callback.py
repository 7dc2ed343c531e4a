"""Tells where the sweep of this process lies, and notes there what it is before its first job begins."""

from pathlib import Path
from typing import Any

from hydra.experimental.callback import Callback
from omegaconf import DictConfig

from gear_damping.tasks.sweep.folder import read_sweep, sweep_of

begun: list[Path] = []  # folders of the sweeps of this process


class NoteSweep(Callback):
    """Hydra calls it when a sweep begins."""

    def on_multirun_start(self, config: DictConfig, **kwargs: Any) -> None:
        """Note the sweep; one that goes on keeps its note."""
        folder, sweep = Path(config.hydra.sweep.dir), sweep_of(list(config.hydra.overrides.task))
        begun.append(folder)
        there = read_sweep(folder)
        if there is None or not there.is_same(sweep):
            sweep.write(folder)
