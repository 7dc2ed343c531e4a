"""Several processes that fit one network: each takes its share of every batch, and gradients are averaged (DDP)."""

import os
import pickle
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import torch
from lightning.pytorch.plugins.environments import LightningEnvironment
from torch import Tensor

from gear_damping.errors import written_whole

ARGUMENTS, ERROR = "arguments", ".error"  # files by which the processes speak
LOOK = 0.1  # s between two looks at them
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
    """Call `work(share, *arguments)` in so many new processes at once, and wait for all.

    Args:
        count: How many.
        work: A function of a module; its process finds the others by the environment, as Lightning expects it.
        arguments: What can be pickled.

    Raises:
        RuntimeError: one of them failed; the others are ended.
        KeyboardInterrupt: as it was sent; all of them are ended.
    """
    with tempfile.TemporaryDirectory(prefix="gear_damping_") as folder:
        kept = Path(folder)
        (kept / ARGUMENTS).write_bytes(pickle.dumps((work, arguments)))  # shared memory is small in many containers
        port = LightningEnvironment().main_port
        begun = [_begun(Share(rank, count), kept, port) for rank in range(count)]
        try:
            while any(process.poll() is None for process in begun):
                _refuse_failed(begun, kept)
                time.sleep(LOOK)
            _refuse_failed(begun, kept)
        finally:
            for process in begun:
                process.kill()
                process.wait()
                process.stdin.close()


def _begun(share: Share, kept: Path, port: int) -> subprocess.Popen:
    """A new process, which ends when its standard input does. No fork: torch's threads do not live through one."""
    world = {"LOCAL_RANK": share.rank, "NODE_RANK": 0, "WORLD_SIZE": share.of, "MASTER_ADDR": "127.0.0.1"}
    own = {name: str(value) for name, value in (world | {"MASTER_PORT": port}).items()}
    own["PYTHONPATH"] = os.pathsep.join(filter(None, sys.path))
    if sys.platform in LOOPBACK:
        own["GLOO_SOCKET_IFNAME"] = LOOPBACK[sys.platform]
    said = None if share.rank == 0 else subprocess.DEVNULL  # what all say is said once
    words = [sys.executable, "-m", __name__, str(kept), str(share.rank), str(share.of), str(torch.get_num_threads())]
    return subprocess.Popen(words, env=os.environ | own, stdin=subprocess.PIPE, stdout=said, stderr=said)


def _refuse_failed(begun: Sequence[subprocess.Popen], kept: Path) -> None:
    failed = [rank for rank, process in enumerate(begun) if process.poll() not in (None, 0)]
    if not failed:
        return
    told = sorted(kept.glob(f"*{ERROR}"))  # one that only lost the others tells less
    said = told[0].read_text() if told else f"exit code {begun[failed[0]].returncode}"
    raise RuntimeError(f"one of {len(begun)} processes of a training failed:\n{said}")


def main(folder: str, *numbers: str) -> None:
    """What a new process does."""
    threading.Thread(target=_end_with_the_parent, daemon=True).start()
    kept, (rank, count, threads) = Path(folder), map(int, numbers)
    torch.set_num_threads(max(1, threads // count))
    work, arguments = pickle.loads((kept / ARGUMENTS).read_bytes())
    try:
        work(Share(rank, count), *arguments)
    except Exception:  # for the process that began this one
        with written_whole(kept / f"{time.time_ns()}_{rank}{ERROR}") as path:
            path.write_text(traceback.format_exc())
        os._exit(1)  # the others may never come to where this one is waited for


def _end_with_the_parent() -> None:
    """Two fits would write into one folder, were the parent killed and begun again."""
    os.read(0, 1)  # nothing is ever written there
    os._exit(1)


if __name__ == "__main__":
    # By its name, not as `__main__`: what was pickled knows this module so.
    import_module("gear_damping.identification.processes").main(*sys.argv[1:])
