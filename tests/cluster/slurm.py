"""`make test-slurm`: sweeps through the job arrays of a real SLURM, one job killed and requeued, the launcher killed.

python -m tests.cluster.slurm
"""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from pathlib import Path

from tests.cluster.disturbed import ROOT, command, compared, count, run
from tests.cluster.disturbed import main as disturbed

JOBS = 12


def requeued(sweep: Path, over: threading.Event) -> list[str]:
    """Kill the first job that is at work and has it requeued by SLURM; returns its number."""
    while not over.wait(0.1):
        at_work = {path.parent.name for path in sweep.glob("*/lease.json")}
        asked = ["squeue", "-h", "-r", "-t", "R", "-o", "%i"]
        for job in subprocess.run(asked, capture_output=True, text=True, check=True).stdout.split():
            if job.rpartition("_")[2] in at_work:
                time.sleep(0.5)
                done = subprocess.run(["scontrol", "requeue", job], capture_output=True, text=True, check=False)
                if done.returncode == 0:
                    return [job]
    return []


def killed_job(out: Path) -> list[str]:
    """A sweep of which SLURM kills and requeues a job, beside one that is left alone; returns what was wrong."""
    place, alone = out / "requeued", out / "slurm" / "alone"
    place.mkdir(parents=True, exist_ok=True)
    over, found = threading.Event(), []
    watching = threading.Thread(target=lambda: found.extend(requeued(place / "sweep", over)))
    watching.start()
    code = run(command(place, JOBS, "slurm"), place / "log.txt")
    over.set()
    watching.join()
    done = count(place / "sweep")
    print(f"requeued {', '.join(found) or 'nothing'}: exit {code}, {done} of {JOBS} finished", flush=True)
    wrong = [] if found else ["no job was requeued"]
    return wrong + ([] if code == 0 else [f"exit {code}"]) + compared(place, alone)


def main() -> int:
    """Start SLURM where there is none; 0 where nothing was wrong."""
    subprocess.run([str(ROOT / "tests" / "cluster" / "slurm.sh")], check=True)
    out = ROOT / "outputs" / "disturbed"
    if disturbed(["--launcher", "slurm", "--jobs", str(JOBS), "--out", str(out)]):
        return 1
    wrong = killed_job(out)
    print("\n".join(wrong) or "a job that was killed and requeued left the same table")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
