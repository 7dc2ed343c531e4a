"""A sweep whose launcher is killed at random, beside one that is left alone: complete, the same table, nothing touched.

python -m tests.cluster.disturbed --launcher joblib --jobs 60 --kills 3
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
QUICK = (
    "experiment=noise", "model=raw_lstm", "training=smoke", "training.max_epochs=3", "simulator.n_runs=12",
    "simulator.n_samples=120", "protocol.windows_per_epoch=128",
)  # fmt: skip
RATIOS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)  # % of critical
LEVELS = tuple(range(1, 51, 5))  # dB
LONGEST = 1800.0  # s that a sweep may take

Hook = Callable[[Path], None]  # told the folder of the sweep while it runs


def command(folder: Path, jobs: int, launcher: str, more: Sequence[str] = ()) -> list[str]:
    """A sweep over noise and damping ratio; `folder` keeps what it leaves."""
    count = next(n for n in range(2, len(RATIOS) + 1) if jobs % n == 0 and jobs // n <= len(LEVELS))
    ratios, levels = RATIOS[:count], LEVELS[: jobs // count]
    swept = [f"simulator.load_noise.snr_db={_listed(levels)}", f"simulator.damping_ratio_percent={_listed(ratios)}"]
    place = [f"hydra.sweep.dir={folder / 'sweep'}", f"data_folder={folder / 'data'}"]
    launched = {"basic": [], "joblib": ["hydra/launcher=joblib"],
                "slurm": ["hydra/launcher=slurm", "hydra.launcher.mem_gb=null"]}[launcher]  # fmt: skip
    return [sys.executable, "-m", "gear_damping", "--multirun", *QUICK, *swept, *place, *launched, *more]


def _listed(values: Sequence[float]) -> str:
    return ",".join(f"{value:g}" for value in values)


def run(words: Sequence[str], log: Path, until: Callable[[], bool] = lambda: False) -> int:
    """Run a command; it is killed without a warning once `until` holds. Returns its exit code."""
    alone = os.environ | {"OMP_NUM_THREADS": "1"}
    with log.open("ab") as file, subprocess.Popen(words, cwd=ROOT, env=alone, stdout=file, stderr=file) as running:
        begun = time.monotonic()
        while running.poll() is None:
            if until():
                running.send_signal(signal.SIGKILL)
            if time.monotonic() - begun > LONGEST:
                running.kill()
                raise TimeoutError(f"not over after {LONGEST:g} s; see {log}")
            time.sleep(0.05)
    return running.returncode


def finished(sweep: Path) -> dict[str, str]:
    """A digest of everything in the folders of finished jobs, by file."""
    found = {}
    for path in sweep.glob("*/run.json"):
        if _status(path) != "finished":
            continue
        for file in sorted(path.parent.rglob("*")):
            if file.is_file() and not file.name.startswith("lease.json") and ".hydra" not in file.parts:
                found[str(file.relative_to(sweep))] = hashlib.sha256(file.read_bytes()).hexdigest()
    return found


def _status(path: Path) -> str:
    try:
        return json.loads(path.read_text())["status"]
    except (OSError, ValueError):  # it is being written
        return "running"


def count(sweep: Path) -> int:
    """Jobs that are finished."""
    return sum(_status(path) == "finished" for path in sweep.glob("*/run.json"))


def disturbed(folder: Path, jobs: int, launcher: str, kills: int, seed: int, more: Sequence[str] = ()) -> list[str]:
    """Kill the launcher so many times, each time after some more jobs; returns what was wrong, in words."""
    source, log, sweep = random.Random(seed), folder / "log.txt", folder / "sweep"
    words, wrong = command(folder, jobs, launcher, more), []
    for number in range(kills):
        before = finished(sweep) if sweep.exists() else {}
        goal = count(sweep) + source.randint(1, max(1, jobs // (kills + 1)))
        code = run(words, log, lambda goal=goal: count(sweep) >= goal)
        after = finished(sweep)
        print(f"kill {number + 1}: exit {code}, {count(sweep)} of {jobs} finished", flush=True)
        wrong += [f"{name} was touched" for name, digest in before.items() if after.get(name) != digest]
    before = finished(sweep)
    code = run(words, log)
    after = finished(sweep)
    wrong += [f"{name} was touched" for name, digest in before.items() if after.get(name) != digest]
    wrong += [] if code == 0 else [f"exit {code}"]
    wrong += [] if count(sweep) == jobs else [f"{count(sweep)} of {jobs} jobs are finished"]
    return wrong


def compared(folder: Path, other: Path) -> list[str]:
    """What differs between the tables of two sweeps."""
    one, two = ((place / "sweep" / "sweep.csv").read_text().splitlines() for place in (folder, other))
    return [f"- {a}\n+ {b}" for a, b in zip(one, two, strict=False) if a != b] + (
        [] if len(one) == len(two) else [f"{len(one)} rows and {len(two)} rows"]
    )


def main(given: Sequence[str] | None = None) -> int:
    """Run both; 0 where nothing was wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.cluster.disturbed", description=__doc__.splitlines()[0])
    parser.add_argument("--launcher", default="joblib", choices=("basic", "joblib", "slurm"))
    parser.add_argument("--jobs", type=int, default=60)
    parser.add_argument("--kills", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0, help="of the moments at which it is killed")
    parser.add_argument("--out", type=Path, default=ROOT / "outputs" / "disturbed")
    options = parser.parse_args(given)
    place = options.out / options.launcher
    shutil.rmtree(place, ignore_errors=True)
    alone, killed = place / "alone", place / "killed"
    for folder in (alone, killed):
        folder.mkdir(parents=True)
    begun = time.monotonic()
    code = run(command(alone, options.jobs, options.launcher), alone / "log.txt")
    print(f"left alone: exit {code}, {count(alone / 'sweep')} of {options.jobs} finished", flush=True)
    wrong = disturbed(killed, options.jobs, options.launcher, options.kills, options.seed)
    wrong += compared(killed, alone)
    for line in wrong:
        print(line)
    seconds = time.monotonic() - begun
    print(f"{options.jobs} jobs on {options.launcher}, killed {options.kills} times: "
          f"{'as it should be' if not wrong else f'{len(wrong)} faults'} ({seconds:.0f} s)")  # fmt: skip
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
