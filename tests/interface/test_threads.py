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


@pytest.mark.parametrize(
    ("first", "policy", "inside"), [("torch", None, 1), ("gear_damping", None, 3), ("torch", "passive", 3)]
)
def test_beside_a_pytorch_that_was_loaded_before_and_spins_one_thread_works(first, policy, inside):
    left = {name: value for name, value in os.environ.items() if name != "OMP_WAIT_POLICY"}
    left |= {"OMP_WAIT_POLICY": policy} if policy else {}
    told = f"""
import {first}
import gear_damping, torch
from gear_damping.threads import no_spinning
torch.set_num_threads(3)
with no_spinning():
    print(torch.get_num_threads())
print(torch.get_num_threads())
"""
    done = subprocess.run([sys.executable, "-c", told], env=left, capture_output=True, text=True, check=True)
    assert done.stdout.split() == [str(inside), "3"]


def test_an_explanation_has_one_thread_beside_those_that_spin(tmp_path, monkeypatch):
    import torch

    import gear_damping.explanation.explain as explaining
    from tests.explanation.test_coasting import coasts

    monkeypatch.setattr("gear_damping.threads.spins", True)
    monkeypatch.setattr(explaining, "_of_evidence", lambda *evidence: torch.get_num_threads())
    before = torch.get_num_threads()
    torch.set_num_threads(2)
    try:
        assert explaining.explain(coasts(tmp_path, 0.16, 0.0014, 0.005)) == 1
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(before)
