"""Several processes that fit one network: each takes its share of every batch, and gradients are averaged (DDP)."""

import os
import pickle
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from lightning.pytorch.plugins.environments import LightningEnvironment
from torch import Tensor
from torch.multiprocessing.spawn import start_processes

LOOPBACK = {"linux": "lo", "darwin": "lo0"}  # the processes are of one machine: no other interface is needed


@dataclass(frozen=True)
class Share:
    """Which part of every batch a process takes.

    Args:
        rank: Number of the process, from 0.
        of: How many there are.
    """

    rank: int = 0
    of: int = 1

    def part(self, batch: Tensor) -> Tensor:
        """Every `of`-th member, (batch, …); where there are fewer members than processes some are taken twice."""
        if self.of == 1:
            return batch
        return batch[torch.arange(self.rank, max(len(batch), self.of), self.of, device=batch.device) % len(batch)]


WHOLE = Share()


def in_processes(count: int, work: Callable[..., None], *arguments: Any) -> None:
    """Call `work(share, *arguments)` in so many processes at once, and wait for all.

    Args:
        count: How many.
        work: A function of a module; its process finds the others by the environment, as Lightning expects it.
        arguments: What can be pickled.

    Raises:
        RuntimeError: one of them failed; the others are ended.
        KeyboardInterrupt: as it was sent; all of them are ended.
    """
    with tempfile.TemporaryDirectory(prefix="gear_damping_") as folder:
        kept = Path(folder) / "arguments"  # a file: shared memory is small in many containers
        kept.write_bytes(pickle.dumps((work, arguments)))
        context = start_processes(
            _begin, (count, kept, LightningEnvironment().main_port), count, join=False, start_method="spawn"
        )
        try:
            while not context.join():
                pass
        finally:
            for process in context.processes:
                if process.is_alive():
                    process.terminate()
                process.join()


def _begin(rank: int, count: int, kept: Path, port: int) -> None:
    """What a new process does."""
    world = {"LOCAL_RANK": rank, "NODE_RANK": 0, "WORLD_SIZE": count, "MASTER_ADDR": "127.0.0.1", "MASTER_PORT": port}
    os.environ.update({name: str(value) for name, value in world.items()})
    if sys.platform in LOOPBACK:
        os.environ.setdefault("GLOO_SOCKET_IFNAME", LOOPBACK[sys.platform])
    torch.set_num_threads(max(1, torch.get_num_threads() // count))
    work, arguments = pickle.loads(kept.read_bytes())
    work(Share(rank, count), *arguments)
