"""Threads of PyTorch sleep while they wait, and are no more than the cores that a container may use."""

import os
import subprocess
import sys

import pytest

from gear_damping.threads import settle_threads


@pytest.mark.parametrize(("given", "left"), [({}, "passive"), ({"OMP_WAIT_POLICY": "active"}, "active")])
def test_threads_that_wait_sleep_unless_the_user_says_otherwise(given, left, tmp_path):
    environment = dict(given)
    settle_threads(environment, tmp_path)
    assert environment == {"OMP_WAIT_POLICY": left}


@pytest.mark.parametrize(
    ("files", "threads"),
    [
        ({"cpu.max": "150000 100000\n"}, "2"),
        ({"cpu.max": "20000 100000\n"}, "1"),
        ({"cpu.max": "max 100000\n"}, None),
        ({"cpu.max": "1600000 100000\n"}, None),  # twice the cores that there are
        ({"cpu/cpu.cfs_quota_us": "300000\n", "cpu/cpu.cfs_period_us": "100000\n"}, "3"),
        ({"cpu/cpu.cfs_quota_us": "-1\n", "cpu/cpu.cfs_period_us": "100000\n"}, None),
    ],
)
def test_a_container_has_as_many_threads_as_cores_are_allowed(files, threads, tmp_path, monkeypatch):
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr("os.cpu_count", lambda: 8)
    environment = {}
    settle_threads(environment, tmp_path)
    assert environment.get("OMP_NUM_THREADS") == threads
    asked = {"OMP_NUM_THREADS": "7"}
    settle_threads(asked, tmp_path)
    assert asked["OMP_NUM_THREADS"] == "7"


def test_the_package_settles_them_before_pytorch_is_loaded():
    left = {name: value for name, value in os.environ.items() if name != "OMP_WAIT_POLICY"}
    told = "import gear_damping, os, sys; print(os.environ['OMP_WAIT_POLICY'], 'torch' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", told], env=left, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["passive", "False"]
