"""Starts one process for each engine and lets them run in turn, so that all meet the same machine."""

import json
import os
import select
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
OWN = Path(sys.executable)
PEERS = Path(os.environ.get("BENCH_PYTHON", ROOT / ".venv-bench" / "bin" / "python"))
LONGEST = 600  # seconds that one call of an engine may take
ONE_THREAD = {
    "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1",
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1",
    "TF_NUM_INTRAOP_THREADS": "1", "TF_NUM_INTEROP_THREADS": "1", "TF_CPP_MIN_LOG_LEVEL": "3",
    "SSQ_PARALLEL": "0", "JAX_PLATFORMS": "cpu", "KERAS_BACKEND": "tensorflow", "CUDA_VISIBLE_DEVICES": "",
}  # fmt: skip


class PeerError(RuntimeError):
    """An engine that cannot run here; the message is what it raised."""


class Process:
    """One engine in its own process."""

    def __init__(self, python: Path, module: str, engine: str, options: dict) -> None:
        if not python.exists():
            raise PeerError("no environment of peers: run `make bench-setup`")
        environment = os.environ | ONE_THREAD | {"PYTHONPATH": str(ROOT)}
        command = [str(python), "-W", "ignore", "-m", "benchmarks.worker"]
        self.process = subprocess.Popen(
            command, cwd=ROOT, env=environment, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip
        try:
            self._ask({"op": "load", "module": module, "engine": engine, "options": options})
        except PeerError:
            self.close()
            raise

    def run(self, keep: Path | None = None) -> dict:
        """CPU and wall seconds of one call, and the peak memory so far."""
        return self._ask({"op": "run", "keep": None if keep is None else str(keep)})

    def result(self) -> tuple[dict, np.ndarray]:
        """As `run`, with what the engine returned."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "result.npy"
            said = self.run(path)
            return said, np.load(path)

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()

    def _ask(self, order: dict) -> dict:
        try:
            self.process.stdin.write(json.dumps(order) + "\n")
            self.process.stdin.flush()
        except BrokenPipeError as gone:
            raise PeerError("its process ended") from gone
        if not select.select([self.process.stdout], [], [], LONGEST)[0]:
            raise PeerError(f"it took longer than {LONGEST} s")
        line = self.process.stdout.readline()
        answer = json.loads(line) if line else {"ok": False, "why": "its process ended"}
        if not answer["ok"]:
            raise PeerError(answer["why"])
        return answer


@dataclass
class Contestant:
    """An engine with the settings at which it is measured; without a process where it cannot run."""

    name: str
    process: Process | None
    items: float
    about: dict = field(default_factory=dict)
    times: list[dict] = field(default_factory=list)

    def leave(self, reason: str) -> None:
        """Take no further part, for this reason."""
        self.about["reason"] = reason
        self.times.clear()
        self.close()

    def close(self) -> None:
        if self.process is not None:
            self.process.close()
        self.process = None


def absent(name: str, reason: object) -> Contestant:
    """An engine that cannot take part: it gets a row with the reason."""
    return Contestant(name, None, 1, {"reason": str(reason)})


def interleave(contestants: list[Contestant], rounds: int) -> None:
    """Run everyone once, then everyone again, …"""
    for _ in range(rounds):
        for contestant in contestants:
            if contestant.process is None:
                continue
            try:
                contestant.times.append(contestant.process.run())
            except PeerError as problem:
                contestant.leave(str(problem))


def rows(work: str, batch: int, contestants: list[Contestant]) -> list[dict]:
    """The rows of results.json; medians, with half the interquartile range.

    Where an engine could not run its figures are None and `reason` says why.
    """
    found = [_row(work, batch, contestant) for contestant in contestants]
    ours = next((row["cpu_ms_per_item"] for row in found if row["engine"] == "ours"), None)
    for row in found:
        own = row["cpu_ms_per_item"]
        row["ratio_to_ours"] = own / ours if own and ours else None
    return found


def _row(work: str, batch: int, contestant: Contestant) -> dict:
    cpu, wall = (
        [1e3 * times[kind] / contestant.items for times in contestant.times] for kind in ("cpu", "wall")
    )  # fmt: skip
    about = dict(contestant.about)
    row = {
        "work": work, "engine": contestant.name, "batch": batch, "error_p90": about.pop("error_p90", None),
        "cpu_ms_per_item": _median(cpu), "wall_ms_per_item": _median(wall), "ratio_to_ours": None,
    }  # fmt: skip
    return row | {"cpu_spread": half_interquartile(cpu), "rounds": len(cpu), **about}


def _median(values: list[float]) -> float | None:
    return statistics.median(values) if values else None


def half_interquartile(values: list[float]) -> float | None:
    """Half the interquartile range, relative to the median."""
    if not values:
        return None
    low, high = np.percentile(values, [25, 75])
    return float((high - low) / 2 / abs(np.median(values)))
