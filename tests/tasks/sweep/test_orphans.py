"""Workers on this machine whose launching process is killed end by themselves."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from gear_damping.tasks.lease import begun
from gear_damping.tasks.sweep import orphan

ROOT = Path(__file__).resolve().parents[3]
SLOW = """
import os
import time
from pathlib import Path

SUFFIXES = (".slow",)


def read(path, max_bytes):
    Path(path).with_suffix(".pid").write_text(str(os.getpid()))
    time.sleep(600)
"""
SOON = 60.0  # s that a busy machine may take for what takes a few


def waited_for(what):
    """What `what()` gives as soon as that is something; nothing after a while."""
    over = time.monotonic() + SOON
    while not (found := what()) and time.monotonic() < over:
        time.sleep(0.05)
    return found


def numbers(folder):
    """Of the processes at work."""
    return [int(text) for path in folder.glob("*.pid") if (text := path.read_text())]


@pytest.mark.slow
@pytest.mark.timeout(200)
def test_workers_whose_launcher_is_killed_end(tmp_path):
    (tmp_path / "slow.py").write_text(SLOW)
    for name in "ab":
        (tmp_path / f"{name}.slow").write_text("1")
    paths = ",".join(str(tmp_path / f"{name}.slow") for name in "ab")
    words = [
        sys.executable, "-m", "gear_damping", "--multirun", "task=inspect", f"measurement.path={paths}",
        f"hydra.sweep.dir={tmp_path / 'sweep'}", f"measurement.plugins=[{tmp_path / 'slow.py'}]",
        "hydra/launcher=joblib", "hydra.launcher.n_jobs=2",
    ]  # fmt: skip
    at_work = []
    with subprocess.Popen(words, cwd=ROOT, stderr=subprocess.DEVNULL) as launcher:
        try:
            assert waited_for(lambda: len(numbers(tmp_path)) == 2), "no worker began"
            at_work = numbers(tmp_path)
            assert launcher.pid not in at_work
            launcher.send_signal(signal.SIGKILL)
            launcher.wait()
            assert waited_for(lambda: not any(begun(pid) for pid in at_work)), "they live on"
        finally:
            launcher.kill()
            for pid in at_work:
                if begun(pid):
                    os.kill(pid, signal.SIGKILL)


@pytest.mark.parametrize(
    ("target", "pid", "watched"),
    [("hydra_plugins.hydra_joblib_launcher.joblib_launcher.JoblibLauncher", 1, True),
     ("hydra_plugins.hydra_joblib_launcher.joblib_launcher.JoblibLauncher", None, False),
     ("hydra_plugins.hydra_submitit_launcher.submitit_launcher.SlurmLauncher", 1, False)],
)  # fmt: skip
def test_only_a_worker_of_this_machine_looks_after_its_launcher(target, pid, watched, monkeypatch):
    """The workers of a cluster go on, and a launcher that does its jobs itself (pid: None) has nobody to look after."""
    begun_threads = []
    monkeypatch.setattr(orphan.threading.Thread, "start", lambda thread: begun_threads.append(thread))
    monkeypatch.setenv(orphan.LAUNCHER, f"{pid or os.getpid()} 5")
    orphan._watch.cache_clear()
    for _ in range(2):
        orphan.end_with_launcher({"_target_": target})
    orphan._watch.cache_clear()
    assert len(begun_threads) == watched


def test_the_environment_is_as_before_when_a_launch_is_over(monkeypatch):
    monkeypatch.delenv(orphan.LAUNCHER, raising=False)
    with orphan.launching():
        assert os.environ[orphan.LAUNCHER].split()[0] == str(os.getpid())
    assert orphan.LAUNCHER not in os.environ
