"""Who works on a job: one at a time, whoever is gone is replaced, whoever lives is waited for."""

import json
import os
import subprocess
import sys
import threading
import time

import pytest

from gear_damping.tasks import lease
from gear_damping.tasks.lease import NAME, is_held, leased


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    for name, seconds in (("BEAT", 0.05), ("SILENCE", 0.6), ("LOOK", 0.02)):
        monkeypatch.setattr(lease, name, seconds)


def noted(folder, **content):
    known = {"host": lease.host(), "pid": os.getpid(), "begun": lease.begun(os.getpid()), "token": "x", "beats": 0}
    folder.mkdir(exist_ok=True)
    (folder / NAME).write_text(json.dumps(known | content))


def seconds_to_take(folder):
    begun = time.monotonic()
    with leased(folder):
        assert json.loads((folder / NAME).read_text())["token"] != "x"
        return time.monotonic() - begun


def test_a_lease_is_held_and_left(tmp_path):
    with leased(tmp_path):
        assert is_held(tmp_path)
    assert not is_held(tmp_path)
    assert os.listdir(tmp_path) == []


@pytest.mark.timeout(60)
def test_a_process_that_is_gone_is_replaced_without_waiting(tmp_path, monkeypatch):
    monkeypatch.setattr(lease, "SILENCE", 1e9)
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    noted(tmp_path, pid=gone.pid, begun="1")
    assert not is_held(tmp_path)
    seconds_to_take(tmp_path)


@pytest.mark.timeout(60)
def test_a_later_process_with_the_same_number_is_another(tmp_path, monkeypatch):
    monkeypatch.setattr(lease, "SILENCE", 1e9)
    noted(tmp_path, begun="1")
    seconds_to_take(tmp_path)


def test_a_silent_worker_of_another_host_is_replaced_after_a_while(tmp_path):
    noted(tmp_path, host="elsewhere")
    assert is_held(tmp_path)
    last = (tmp_path / NAME).stat().st_mtime
    os.utime(tmp_path / NAME, (last - 2, last - 2))  # longer ago than the silence of one that is dead
    assert not is_held(tmp_path)
    assert seconds_to_take(tmp_path) >= 0.6


def test_a_lease_that_was_cut_off_is_replaced_after_a_while(tmp_path):
    (tmp_path / NAME).write_text('{"host": "el')
    assert is_held(tmp_path)
    assert seconds_to_take(tmp_path) >= 0.6


def test_a_worker_that_lives_is_waited_for_however_long(tmp_path, monkeypatch):
    """Seen from another host it lives by its beats alone."""
    order = []

    def work():
        with leased(tmp_path):
            order.append("first begins")
            time.sleep(1.5)  # longer than the silence of one that is dead
            order.append("first ends")

    worker = threading.Thread(target=work)
    worker.start()
    while not order:
        time.sleep(0.01)
    monkeypatch.setattr(lease, "_is_gone", lambda content: False)
    with leased(tmp_path):
        order.append("second begins")
    worker.join()
    assert order == ["first begins", "first ends", "second begins"]


def test_of_many_that_want_it_one_has_it(tmp_path):
    """Also where all of them find a dead one."""
    noted(tmp_path, begun="1")
    inside, most = [], []

    def work():
        with leased(tmp_path):
            inside.append(1)
            most.append(len(inside))
            time.sleep(0.02)
            inside.pop()

    workers = [threading.Thread(target=work) for _ in range(8)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert most == [1] * 8
    assert os.listdir(tmp_path) == []


def test_who_was_replaced_neither_beats_nor_takes_the_lease_away(tmp_path):
    with leased(tmp_path):
        noted(tmp_path, host="elsewhere")
        time.sleep(0.2)
        assert json.loads((tmp_path / NAME).read_text())["token"] == "x"
    assert json.loads((tmp_path / NAME).read_text())["token"] == "x"


def test_a_file_system_without_links_does_too(tmp_path, monkeypatch):
    def no_links(source, target):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", no_links)
    with leased(tmp_path):
        assert is_held(tmp_path)
    assert not is_held(tmp_path)
