"""The index of all runs: what it lists, that it never fails a run, and that two that end at once both stand in it."""

import errno
import json
import os
import re
import subprocess
import sys
import threading

import pytest

from gear_damping.tasks import run_folder, run_index
from gear_damping.tasks.command import main
from gear_damping.tasks.lease import leased
from gear_damping.tasks.run_index import INDEX, refresh_index, write_index

WORKER = """
import sys, time
from pathlib import Path
from gear_damping.tasks.lease import leased

with leased(Path(sys.argv[1])):
    print("at work", flush=True)
    time.sleep(600)
"""
DECAY = "time,x\n" + "".join(f"{k / 100},{0.9**k}\n" for k in range(100))


def run(folder, status="finished", task="train", **more):
    folder.mkdir(parents=True, exist_ok=True)
    known = {"status": status, "task": task, "config": {"name": folder.parent.name}, "metrics": {}, "wall_time_s": 2.0,
             "started": "2026-01-02T03:04:05+00:00"}  # fmt: skip
    (folder / "run.json").write_text(json.dumps(known | more))
    return folder


def rows(root):
    """Text of the cells of each row."""
    body = (root / INDEX).read_text().partition("<tbody>")[2].partition("</tbody>")[0]
    plain = re.sub(r"[ \n]+", " ", re.sub(r"<(?!/tr>)[^>]*>", " ", body))
    return [row.strip() for row in plain.split("</tr>") if row.strip()]


def test_runs_and_sweeps_are_rows_and_what_only_looks_is_none(tmp_path):
    run(tmp_path / "train" / "backlash" / "1", metrics={"rmse_percent": 0.125, "epochs": 3})
    run(tmp_path / "train" / "noise" / "2", "failed", error="- snr_db: too hot\n- more")
    run(tmp_path / "mine" / "3", "running")
    run(tmp_path / "collect" / "custom" / "4", task="collect")
    sweep = tmp_path / "sweep" / "noise" / "5"
    note = {"overrides": [], "keys": ["seed"], "jobs": 3, "version": "1"}
    for number, status in enumerate(("finished", "failed")):
        run(sweep / str(number), status, config={"name": "noise"})
    (sweep / "sweep.json").write_text(json.dumps(note))
    (tmp_path / "data").mkdir()
    assert write_index(tmp_path) == 4
    found = "\n".join(rows(tmp_path))
    for said in (
        "train backlash finished 2 s rmse_percent 0.125, epochs 3", "train noise failed 2 s snr_db: too hot",
        "train mine cut off", "sweep of train noise 1 of 3 jobs 4 s 3 jobs, 1 failed, over seed",
    ):  # fmt: skip
        assert said in found


def test_links_lead_to_what_is_there(tmp_path):
    folder = run(tmp_path / "train" / "a#b" / "1")
    for name in ("report.html", "response.png", "predicted_against_true.png"):
        (folder / name).touch()
    write_index(tmp_path)
    page = (tmp_path / INDEX).read_text()
    links = set(re.findall(r'(?:href|src)="([^"#]*)"', page))
    assert links == {f"train/a%23b/1/{name}" for name in ("report.html", "predicted_against_true.png", "")}


@pytest.mark.parametrize("text", ["", "[]", "{", '{"status": 1, "metrics": 3}', '{"status": "finished"}', "\0"])
def test_a_damaged_run_is_a_row(tmp_path, text):
    folder = run(tmp_path / "train" / "a" / "1")
    (folder / "run.json").write_text(text)
    (tmp_path / "sweep" / "b" / "2").mkdir(parents=True)
    (tmp_path / "sweep" / "b" / "2" / "sweep.json").write_text(text)
    assert write_index(tmp_path) == 2
    assert "\n".join(rows(tmp_path)).count("unreadable") == 2


def test_a_run_goes_on_as_long_as_its_process_does(tmp_path):
    """The one lies in this process, the other in one that was killed over it."""
    worker = [sys.executable, "-c", WORKER, str(run(tmp_path / "killed" / "1", "running"))]
    with subprocess.Popen(worker, stdout=subprocess.PIPE) as killed, leased(run(tmp_path / "alive" / "1", "running")):
        killed.stdout.readline()
        write_index(tmp_path)
        assert [row.count("running") for row in rows(tmp_path)] == [1, 1]
        killed.kill()
        killed.wait()
        write_index(tmp_path)
        found = "\n".join(rows(tmp_path))
        assert "train alive running" in found
        assert "train killed cut off" in found
    assert (tmp_path / "killed" / "1" / "lease.json").exists()  # nobody took it away


def test_a_job_that_is_cut_off_is_counted_in_the_row_of_its_sweep(tmp_path):
    sweep = tmp_path / "sweep" / "noise" / "5"
    for number, status in enumerate(("finished", "running")):
        run(sweep / str(number), status)
    (sweep / "sweep.json").write_text(json.dumps({"overrides": [], "keys": ["seed"], "jobs": 2, "version": "1"}))
    write_index(tmp_path)
    assert "1 of 2 jobs 4 s 2 jobs, 1 cut off, over seed" in rows(tmp_path)[0]


def test_a_run_that_could_not_say_how_it_ended_is_dead(tmp_path, monkeypatch):
    """As on a full disk, where run.json keeps what the beginning said: nothing can be written after that."""
    (tmp_path / "decay.csv").write_text(DECAY)
    plainly = run_folder.write_json

    def full(path, content):
        if content["status"] != "running":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        return plainly(path, content)

    monkeypatch.setattr(run_folder, "write_json", full)
    data, folder = f"measurement.path={tmp_path / 'decay.csv'}", tmp_path / "outputs" / "inspect" / "1"
    assert main(["task=inspect", data, f"hydra.run.dir={folder}"]) == 1
    assert json.loads((folder / "run.json").read_text())["status"] == "running"
    write_index(tmp_path / "outputs")
    assert "inspect custom cut off" in rows(tmp_path / "outputs")[0]


def test_a_run_elsewhere_leaves_no_index(tmp_path):
    refresh_index([tmp_path / "elsewhere"], tmp_path / "outputs")
    assert list(tmp_path.iterdir()) == []


def test_a_run_never_fails_for_its_index(tmp_path, monkeypatch, caplog):
    folder = run(tmp_path / "train" / "a" / "1")

    def full(*paths):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    refresh_index([folder], tmp_path)
    assert "could not be brought up to date" in caplog.text
    assert sorted(path.name for path in tmp_path.iterdir()) == ["train"]


def test_a_run_that_ends_meanwhile_stands_in_it(tmp_path, monkeypatch):
    """It wrote its index first, and the other would put an older one in its place."""
    run(tmp_path / "train" / "a" / "1")
    plainly, between = run_index.written_whole, [lambda: run(tmp_path / "train" / "b" / "2")]

    def late(path, **how):
        while between:
            between.pop()()
        return plainly(path, **how)

    monkeypatch.setattr(run_index, "written_whole", late)
    assert write_index(tmp_path) == 2


def test_of_many_that_end_at_once_all_stand_in_it(tmp_path):
    def end(number):
        refresh_index([run(tmp_path / "train" / f"run_{number}" / "1")], tmp_path)

    ending = [threading.Thread(target=end, args=(number,)) for number in range(8)]
    for one in ending:
        one.start()
    for one in ending:
        one.join()
    found = "\n".join(rows(tmp_path))
    assert all(f"run_{number}" in found for number in range(8))
    assert sorted(path.name for path in tmp_path.iterdir()) == [INDEX, "train"]


def test_each_run_brings_it_up_to_date_and_a_command_makes_it_anew(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "decay.csv").write_text(DECAY)
    assert main(["task=inspect", "measurement.path=decay.csv", "name=first"]) == 0
    assert len(rows(tmp_path / "outputs")) == 1
    assert main(["--multirun", "task=inspect", "measurement.path=decay.csv", "name=second"]) == 0
    found = "\n".join(rows(tmp_path / "outputs"))
    assert "sweep of inspect second finished" in found
    (tmp_path / "outputs" / INDEX).unlink()
    assert main(["task=collect"]) == 0
    assert "\n".join(rows(tmp_path / "outputs")) == found
