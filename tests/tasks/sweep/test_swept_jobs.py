"""Sweeps from the command line: cut off and begun again, collected, and what each job leaves on the terminal."""

import csv
import hashlib
import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from gear_damping.config.source import Origin
from gear_damping.tasks.command import main
from gear_damping.tasks.run_folder import RunFolder
from gear_damping.tasks.sweep.folder import Place
from gear_damping.tasks.sweep.job import limit_cores, run_swept

ROOT = Path(__file__).resolve().parents[3]
NAMES = ("a", "b", "c", "d")


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Four files of a decay, sampled at 100 to 400 Hz."""
    folder = tmp_path_factory.mktemp("measured")
    for rate, name in enumerate(NAMES, 1):
        rows = (f"{k / (100 * rate)},{math.exp(-k / 99) * math.cos(k / 7)}\n" for k in range(200))
        (folder / f"{name}.csv").write_text("time,x\n" + "".join(rows))
    return folder


def command(measured, folder, *more, names=NAMES):
    paths = ",".join(str(measured / f"{name}.csv") for name in names)
    return ["--multirun", "task=inspect", f"measurement.path={paths}", f"hydra.sweep.dir={folder / 'sweep'}", *more]


def hashes(folder):
    return {
        path: hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.glob("*/**/*"))
        if path.is_file() and ".hydra" not in path.parts
    }


def rows_of(sweep):
    return list(csv.DictReader((sweep / "sweep.csv").read_text().splitlines()))


@pytest.fixture
def said(caplog, capsys):
    """Everything that was said so far, through logging or on stderr."""
    return lambda: caplog.text + capsys.readouterr().err


@pytest.fixture(scope="module")
def undisturbed(measured, tmp_path_factory):
    folder = tmp_path_factory.mktemp("undisturbed")
    assert main(command(measured, folder)) == 0
    return folder / "sweep"


def test_a_sweep_that_is_killed_and_begun_again_gives_the_same_table(tmp_path, measured, undisturbed):
    words = [sys.executable, "-m", "gear_damping", *command(measured, tmp_path)]
    alone = os.environ | {"OMP_NUM_THREADS": "1"}
    with subprocess.Popen(words, cwd=ROOT, env=alone, stderr=subprocess.DEVNULL) as running:
        while not (tmp_path / "sweep" / "1" / "run.json").exists():
            assert running.poll() is None
            time.sleep(0.01)
        running.send_signal(signal.SIGKILL)
    finished = [path.parent for path in (tmp_path / "sweep").glob("*/run.json") if "finished" in path.read_text()]
    assert finished
    assert not (tmp_path / "sweep" / "sweep.csv").exists()
    before = {path: digest for folder in finished for path, digest in hashes(folder.parent).items()
              if path.parent == folder}  # fmt: skip
    assert main(command(measured, tmp_path)) == 0
    assert (tmp_path / "sweep" / "sweep.csv").read_text() == (undisturbed / "sweep.csv").read_text()
    after = hashes(tmp_path / "sweep")
    assert {path: after[path] for path in before} == before


def test_a_complete_sweep_in_a_named_folder_is_left_as_it_is(measured, undisturbed):
    before = hashes(undisturbed)
    assert main(command(measured, undisturbed.parent)) == 0
    assert hashes(undisturbed) == before


def test_another_sweep_in_the_same_folder_is_refused(measured, undisturbed, said):
    assert main(command(measured, undisturbed.parent, names="ab")) == 1
    assert "holds another sweep" in said()


def test_the_table_has_the_figures_of_any_task_and_the_reason_of_what_failed(tmp_path, undisturbed, said):
    rows = rows_of(undisturbed)
    assert [Path(row["measurement.path"]).stem for row in rows] == [*NAMES]
    assert [row["sampling_rate"] for row in rows] == ["100.0", "200.0", "300.0", "400.0"]
    assert (undisturbed / "sweep.png").is_file()
    command = json.loads((undisturbed / "2" / "run.json").read_text())["command"]
    assert command == f"python -m gear_damping task=inspect measurement.path={rows[2]['measurement.path']}"
    (undisturbed / "2" / "run.json").rename(tmp_path / "kept")
    try:
        record = json.loads((tmp_path / "kept").read_text())
        (undisturbed / "2" / "run.json").write_text(json.dumps(record | {"status": "failed", "error": "too hot"}))
        place = [f"hydra.run.dir={tmp_path / 'run'}"]
        assert main(["task=collect", f"sweep={undisturbed}", *place]) == 0
        assert "3 of 4 jobs are finished" in said()
        rows = rows_of(undisturbed)
        assert [row["error"] for row in rows] == ["", "", "too hot", ""]
        assert not json.loads((undisturbed / "sweep.json").read_text())["complete"]
        (undisturbed / "2" / "run.json").write_text(json.dumps(record | {"status": "running"}))
        assert main(["task=collect", f"sweep={undisturbed}", *place]) == 0
        assert rows_of(undisturbed)[2]["status"] == "cut off"
    finally:
        (tmp_path / "kept").rename(undisturbed / "2" / "run.json")


@pytest.mark.parametrize(
    ("words", "rule"),
    [
        (["task=collect", "sweep=tests"], "holds no sweep"),
        (["task=simulate", "sweep=tests"], "acts in task=collect"),
    ],
)
def test_what_is_no_sweep_is_refused(words, rule, tmp_path, said):
    assert main([*words, f"hydra.run.dir={tmp_path / 'run'}"]) == 1
    assert rule in said()


@pytest.fixture
def done(monkeypatch):
    """Stands in for a job; notes what it was told."""
    told = []

    def job(config, origin, folder):
        told.append(dict(config))
        RunFolder(folder, config, Origin()).close("finished", {"x": 1.0})
        return 0

    monkeypatch.setattr("gear_damping.tasks.sweep.job.run_job", job)
    return told


def left(folder, config, status):
    record = RunFolder(folder, config, Origin())
    record.close(status)


CONFIG = {"task": "train", "seed": 1, "progress": True, "resume": None}


@pytest.mark.parametrize(
    ("status", "config", "again"),
    [
        ("finished", CONFIG, False),
        ("finished", CONFIG | {"progress": False, "resume": "there"}, False),
        ("finished", CONFIG | {"seed": 2}, True),
        ("failed", CONFIG, True),
        ("running", CONFIG, True),
        ("interrupted", CONFIG, True),
    ],
)
def test_only_what_is_finished_is_not_done_again(status, config, again, tmp_path, done):
    left(tmp_path / "0", config, status)
    assert run_swept(CONFIG, None, Place(tmp_path / "0", tmp_path, "seed=1")) == 0
    assert len(done) == again


@pytest.mark.parametrize(
    ("launcher", "threads"),
    [({}, "none"), ({"n_jobs": -1}, "1"), ({"n_jobs": 2}, "3"), ({"n_jobs": 99}, "1"), ({"cpus_per_task": 5}, "5")],
)
def test_each_job_is_limited_to_its_cores(launcher, threads, monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: range(6))
    monkeypatch.setenv("OMP_NUM_THREADS", "none")
    monkeypatch.delitem(sys.modules, "torch", raising=False)
    limit_cores(launcher)
    assert os.environ["OMP_NUM_THREADS"] == threads


def test_a_training_goes_on_from_its_checkpoint(tmp_path, done):
    checkpoint = tmp_path / "0" / "raw_lstm" / "seed_0" / "last.ckpt"
    checkpoint.parent.mkdir(parents=True)
    checkpoint.touch()
    run_swept(CONFIG, None, Place(tmp_path / "0", tmp_path, ""))
    run_swept(CONFIG, None, Place(tmp_path / "1", tmp_path, ""))
    assert [told["resume"] for told in done] == [str(tmp_path / "0"), None]


def test_what_an_unfinished_job_left_for_people_to_edit_is_kept(tmp_path, done):
    config = CONFIG | {"task": "explain"}
    left(tmp_path / "0", config, "interrupted")
    (tmp_path / "0" / "extended_simulator.yaml").write_text("of before")
    run_swept(config, None, Place(tmp_path / "0", tmp_path, ""))
    assert (tmp_path / "0" / "extended_simulator.yaml.cut_off").read_text() == "of before"


def test_a_job_has_one_line_with_a_bar_and_the_rest_in_its_log(measured, tmp_path):
    """The terminal is read as a user sees it."""
    words = [sys.executable, "-m", "gear_damping", *command(measured, tmp_path, names=("a", "nothing"))]
    said = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert said.returncode == 1
    lines = [line for line in said.stderr.splitlines() if line.startswith("[")]
    place = f"measurement.path={measured}"
    assert lines[0].startswith(f"[##########..........] 1/2 0: {place}/a.csv: finished, system oscillator, columns 2 (")
    assert lines[1].startswith(f"[##########..........] 1/2 1: {place}/nothing.csv: failed, measurement.path = ")
    assert "everything lies in" not in said.stderr
    assert "everything lies in" in (tmp_path / "sweep" / "0" / "log.txt").read_text()
    assert "the same command goes on from here" in said.stderr


def test_a_pattern_of_files_is_swept_over(measured, tmp_path):
    sweep = tmp_path / "sweep"
    words = ["--multirun", "task=inspect", f"measurement.path={measured}/[ab].csv", f"hydra.sweep.dir={sweep}"]
    assert main(words) == 0
    rows = rows_of(sweep)
    assert [row["measurement.path"] for row in rows] == [str(measured / f"{name}.csv") for name in "ab"]
    assert {row["status"] for row in rows} == {"finished"}
