"""What the user's files and machine can do to a run: one message, exit code 1, no traceback."""

import errno
import json
import os
import resource

import pytest

from gear_damping.errors import InputError, Problem
from gear_damping.tasks import dispatch, run_folder
from gear_damping.tasks.command import main

SMALL = ["simulator.n_runs=2", "simulator.n_samples=200", "progress=false"]
BROKEN_EFFECT = '''
from gear_damping.physics.parameter import Parameter
from gear_damping.physics.terms import DampingForce


class OwnDamping(DampingForce):
    name = "own_damping"
    equation = "F_d = c delta'"
    reference = "none"
    parameters = (Parameter("coefficient", "N*s/m", 1.0, "c", 0, 1e12),)

    def prepare(self, values, base):
        """{prepare}"""
        {prepare}
        return dict(values)

    def damping_force(self, now, p):
        """{force}"""
        {force}
        return p["coefficient"] * now.delta_rate
'''


def place(tmp_path):
    return [f"hydra.run.dir={tmp_path / 'run'}", f"data_folder={tmp_path / 'data'}"]


@pytest.fixture
def said(caplog, capsys):
    """What one failing command said: a message in the house's form and no traceback."""

    def read():
        text = caplog.text + capsys.readouterr().err
        assert text.count("This cannot run") == 1
        assert "remedy: " in text
        assert "Traceback" not in text
        assert "a defect of gear_damping" not in text
        return text

    return read


def broken_effect(tmp_path, prepare="pass", force="pass"):
    path = tmp_path / "own_damping.py"
    path.write_text(BROKEN_EFFECT.replace("{prepare}", prepare).replace("{force}", force))
    return [f"simulator.plugins=[{path}]", "simulator.own_damping={}"], path


@pytest.mark.parametrize("task", ["train", "simulate"])
def test_a_line_of_the_users_effect_that_fails_in_a_task_is_named(task, tmp_path, said):
    plugin, path = broken_effect(tmp_path, force="p['missing']")
    size = ["simulator.n_runs=12", *SMALL[1:], "protocol.window=50"]
    assert main([f"task={task}", *plugin, *size, *place(tmp_path)]) == 1
    text = said()
    assert f"simulator.plugins = '{path}': line " in text
    assert "in damping_force, fails with KeyError: 'missing'" in text
    assert f"(from command line: simulator.plugins=[{path}])" in text
    assert json.loads((tmp_path / "run" / "run.json").read_text())["status"] == "failed"


def test_a_line_of_the_users_effect_that_fails_while_the_settings_are_read_is_named(tmp_path, said):
    plugin, _ = broken_effect(tmp_path, prepare="1 / 0")
    assert main(["task=simulate", *plugin, *SMALL, *place(tmp_path)]) == 1
    assert "in prepare, fails with ZeroDivisionError" in said()


def test_what_the_users_effect_returns_is_suspected_too(tmp_path, caplog, capsys):
    plugin, path = broken_effect(tmp_path, force="return None")
    assert main(["task=simulate", *plugin, *SMALL, *place(tmp_path)]) == 1
    text = caplog.text + capsys.readouterr().err
    assert f"a defect of what {path} returns, or of gear_damping" in text
    assert "not of your input" not in text


def test_a_text_as_checkpoint_is_refused(tmp_path, said):
    text = tmp_path / "notes.txt"
    text.write_text("no checkpoint\n")
    assert main(["task=evaluate", f"checkpoint={text}", *SMALL, *place(tmp_path)]) == 1
    words = said()
    assert f"checkpoint = '{text}': must be a checkpoint of a trained estimator" in words
    assert f"(from command line: checkpoint={text})" in words


def test_a_file_that_cannot_be_written_is_named(tmp_path, said):
    """A limit on the size of files fails as a full disk does: without the name of the file."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, limits[1]))
    try:
        code = main(["task=simulate", "simulator.n_runs=2", "simulator.n_samples=9000", *SMALL[2:], *place(tmp_path)])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert code == 1
    text = said()
    assert f"{tmp_path / 'data'}{os.sep}" in text
    assert f".npz: {os.strerror(errno.EFBIG)}" in text
    assert not list((tmp_path / "data").iterdir())  # nothing half-written
    assert json.loads((tmp_path / "run" / "run.json").read_text())["status"] == "failed"


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left"), PermissionError(13, "denied", "a.csv")])
def test_an_error_of_the_machine_names_the_file_or_the_folder(error, tmp_path, monkeypatch, said):
    def full(*_):
        raise error

    monkeypatch.setattr(dispatch, "task_of", lambda settings: full)
    assert main(["task=simulate", *SMALL, *place(tmp_path)]) == 1
    assert (error.filename or str(tmp_path / "run")) in said()


def test_a_folder_that_is_full_from_the_beginning_is_said(tmp_path, monkeypatch, said):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device", "run.json")

    monkeypatch.setattr("gear_damping.tasks.run_folder.write_json", full)
    assert main(["task=simulate", *SMALL, *place(tmp_path)]) == 1
    assert "run.json: No space left on device" in said()


def test_a_problem_found_in_a_task_gets_its_place_only_where_the_key_has_one(tmp_path, monkeypatch, said):
    def refused(*_):
        raise InputError([Problem("simulator", "diverged", remedy="x"), Problem("seed", "is odd", 1)])

    monkeypatch.setattr(dispatch, "task_of", lambda settings: refused)
    assert main(["task=simulate", "seed=1", *SMALL, *place(tmp_path)]) == 1
    text = said()
    assert "- simulator: diverged; remedy: x\n" in text
    assert "- seed = 1: is odd (from command line: seed=1)" in text


@pytest.mark.parametrize(
    ("script", "why"),
    [(None, "git cannot be run: No such file or directory"),
     ("echo 'fatal: dubious ownership' >&2; exit 128", "git fails: fatal: dubious ownership")],
    ids=["absent", "refusing"],
)  # fmt: skip
def test_a_checkout_without_git_is_run_and_states_no_revision(script, why, tmp_path, monkeypatch, caplog):
    (tmp_path / "bin").mkdir()
    if script:
        (tmp_path / "bin" / "git").write_text(f"#!/bin/sh\n{script}\n")
        (tmp_path / "bin" / "git").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}:/nowhere")
    monkeypatch.setattr(run_folder, "__file__", str(tmp_path / "a" / "b" / "run_folder.py"))
    (tmp_path / ".git").mkdir()
    run_folder._without_git.cache_clear()
    assert [run_folder.git_state() for _ in range(2)] == 2 * [{"revision": None, "dirty": None}]
    assert caplog.text.count(why) == 1
    assert "run.json states no revision" in caplog.text
