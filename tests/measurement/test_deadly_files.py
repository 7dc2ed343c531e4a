"""A file that kills the library that reads it ends as a message, and the process goes on."""

import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from gear_damping.errors import InputError
from gear_damping.measurement.formats import registry
from gear_damping.measurement.formats.registry import read_table, refuse_deadly


class Columns:
    """Stands in for a table whose second column is deadly."""

    names = ("a", "b")

    def values(self, index):
        if index == 1:
            os.kill(os.getpid(), signal.SIGSEGV)
        raise ValueError("unreadable")


def never_ends(path, max_bytes):
    while True:
        time.sleep(1)


def kills_at_once(path, max_bytes):
    os.kill(os.getpid(), signal.SIGABRT)


@pytest.mark.parametrize(
    ("read", "name"), [(kills_at_once, "SIGABRT"), (lambda path, most: Columns(), "SIGSEGV")], ids=["file", "column"]
)
def test_a_reader_that_dies_is_a_message(read, name, tmp_path):
    (tmp_path / "run.mat").write_bytes(b"x")
    with pytest.raises(InputError, match=name) as said:
        refuse_deadly(read, tmp_path / "run.mat", 99)
    assert "run.mat" in str(said.value)
    assert "export it again" in str(said.value)


def test_a_reader_that_does_not_end_is_a_message_and_leaves_no_process(tmp_path, monkeypatch):
    (tmp_path / "run.h5").write_bytes(b"x" * 200)
    monkeypatch.setattr(registry, "PATIENCE", 0.1)
    monkeypatch.setattr(registry, "SLOWEST", 1000.0)
    before, begun = children(), time.monotonic()
    with pytest.raises(InputError, match="does not end"):
        refuse_deadly(never_ends, tmp_path / "run.h5", 999)
    assert time.monotonic() - begun > 0.3  # a larger file may take longer
    assert children() <= before


def children() -> set[str]:
    """Processes that this one has begun and that are still there; other tests may have left some that serve them."""
    return {pid for task in Path("/proc/self/task").iterdir() for pid in (task / "children").read_text().split()}


@pytest.mark.parametrize("error", [ValueError, MemoryError, InputError("too large")])
def test_what_a_reader_raises_is_said_by_the_reader_itself(error, tmp_path):
    def read(path, max_bytes):
        raise error

    (tmp_path / "run.mat").write_bytes(b"x")
    refuse_deadly(read, tmp_path / "run.mat", 99)


def test_a_deadly_format_is_tried_first_and_another_is_not(tmp_path, monkeypatch):
    savemat(tmp_path / "run.mat", {"x": np.arange(9.0)})
    np.savez(tmp_path / "run.npz", x=np.arange(9.0))
    tried = []
    door = "gear_damping.measurement.formats.registry.refuse_deadly"
    monkeypatch.setattr(door, lambda read, path, most: tried.append(path.name))
    assert read_table(tmp_path / "run.mat").names == ("x",)
    assert read_table(tmp_path / "run.npz").names == ("x",)
    (tmp_path / "run.own").write_text("x")
    read_table(tmp_path / "run.own", known={".own": lambda path, most: None})
    assert tried == ["run.mat"]
