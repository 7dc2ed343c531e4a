"""`python -m tests.pages.material FOLDER`: short runs of every kind, whose pages the browser then looks at."""

import math
import os
import sys
from pathlib import Path

from gear_damping.tasks.command import main

QUICK = ["training=smoke", "training.max_epochs=2", "simulator.n_runs=16", "simulator.n_samples=200", "progress=false"]
SHOWN = "figures=[figure_04,figure_05,figure_12,table_1]"


def make(folder: Path) -> None:
    """One run of every task, and a sweep, below a folder; what is there already is kept.

    Raises:
        RuntimeError: a run failed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    os.chdir(folder)
    _measurement()
    _run("train", ["experiment=backlash", *QUICK])
    (training,) = Path("outputs/train/backlash").iterdir()
    quick = [word for word in QUICK if not word.startswith("training")]
    asked = ["task=evaluate", "experiment=backlash", f"checkpoint={training}", "evaluation.snr_db=[30,10]"]
    _run("evaluate", [*asked, *quick])
    rig = ["measurement.path=measurement.yaml", "simulator=oscillator", "family=none", "progress=false"]
    _run("identify", ["task=identify", *rig])
    _run("identify", ["task=identify", "model=classical", "name=classical", *rig], "classical")
    _run("explain", ["task=explain", *rig])
    _run("sweep", ["--multirun", "experiment=noise", "simulator.load_noise.snr_db=1,20", *QUICK])
    _run("simulate", ["task=simulate", "experiment=backlash", "write_measurement=true", *quick])
    tests = ["plan.speeds_rpm=[1500,4500]", "plan.torques=[75,150]", "plan.most_tests=2"]
    _run("plan", ["experiment=plan", *tests, "progress=false"])
    _run("paper", ["experiment=paper_figures", *QUICK, "protocol.windows_per_epoch=64", SHOWN])
    _run("inspect", ["task=inspect", "measurement.path=decay.csv", "name=bare"], "bare")
    _run("inspect", ["task=inspect", "measurement.path=measurement.yaml", "name=declared"], "declared")
    Path("broken.npz").write_text("no archive\n")
    _run("inspect", ["task=inspect", "measurement.path=broken.npz", "name=failing"], "failing", code=1)


def _run(task: str, words: list[str], name: str = "*", code: int = 0) -> None:
    if any(Path("outputs", task).glob(f"{name}/*/run.json")) or any(Path("outputs", task).glob(f"{name}/*/sweep.json")):
        return
    if main(words) != code:
        raise RuntimeError(f"{' '.join(words)} did not end with {code}")


def _measurement() -> None:
    """Two free decays with a hardening spring, the second held out."""
    rows = {"decay": 0.9, "other": 0.7}
    for name, size in rows.items():
        x, v, lines = size, 0.0, ["time,x"]
        for k in range(1500):
            lines.append(f"{k / 50},{x + 1e-3 * math.sin(12.9898 * k * k)}")
            for _ in range(20):
                v -= 1e-3 * (0.2 * v + 6 * x + 3 * x**3)
                x += 1e-3 * v
        Path(f"{name}.csv").write_text("\n".join(lines) + "\n")
    channels = "{time: {column: time, unit: s}, displacement: {column: x, unit: m}}"
    Path("measurement.yaml").write_text(
        "system: oscillator\nrecords:\n"
        f"- {{file: decay.csv, role: fit, channels: {channels}}}\n"
        f"- {{file: other.csv, role: holdout, channels: {channels}}}\n"
    )


if __name__ == "__main__":
    make(Path(sys.argv[1]).absolute())
