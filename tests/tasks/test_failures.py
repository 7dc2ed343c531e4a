"""What the user's files and machine can do to a run: one message, exit code 1, no traceback."""

import errno
import json
import os
import resource

import pytest

from gear_damping.config.source import Origin
from gear_damping.errors import InputError, Problem
from gear_damping.measurement.files import Files, read_yaml
from gear_damping.measurement.formats.registry import MAX_BYTES, read_table
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

    def damping_force(self, at, p):
        """{force}"""
        {force}
        return p["coefficient"] * at.delta_rate
'''


def place(tmp_path):
    return [*own(tmp_path), f"data_folder={tmp_path / 'data'}"]


def own(tmp_path):
    """The folder of a run that keeps no simulated data."""
    return [f"hydra.run.dir={tmp_path / 'run'}"]


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
    size = ["simulator.n_runs=12", *SMALL[1:]]
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


MADE = "make room"  # the remedy of an output that cannot be written


@pytest.mark.parametrize("task", ["inspect", "identify", "explain"])
def test_a_file_of_formats_that_is_missing_is_named_by_its_key(task, tmp_path, said):
    data = tmp_path / "a.csv"
    data.write_text("t,x\n0,1\n0.1,2\n")
    missing = tmp_path / "nowhere.py"
    words = [f"task={task}", f"measurement.path={data}", f"measurement.plugins=[{missing}]", *own(tmp_path)]
    assert main(words) == 1
    text = said()
    assert f"measurement.plugins = '{missing}': no such file; remedy: give the path of a .py file" in text
    assert f"(from command line: measurement.plugins=[{missing}])" in text
    assert MADE not in text
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("task", ["train", "simulate", "evaluate", "collect"])
@pytest.mark.parametrize("word", ["measurement=silverbox", "measurement.plugins=[a.py]", "measurement.channel=force"])
def test_a_measurement_is_refused_where_nothing_looks_at_it(task, word, tmp_path, said):
    assert main([f"task={task}", word, "progress=false", *own(tmp_path)]) == 1
    key, _, value = word.partition("=")
    where = "task=identify" if key == "measurement.channel" else "task=identify, task=explain, task=inspect"
    assert f"{key} = '{value}': has no effect in task={task}: it acts in {where};" in said()


def test_an_input_that_the_machine_does_not_give_is_named_by_the_key_of_the_configuration(tmp_path, monkeypatch, said):
    """Wherever it is met: no text of reading is that of an output."""
    path = tmp_path / "extended_simulator.yaml"

    def unreadable(*_):
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    monkeypatch.setattr(dispatch, "task_of", lambda settings: unreadable)
    monkeypatch.setattr(dispatch, "_settings", lambda config, origin: None)
    assert main(["task=collect", f"sweep={path}", *own(tmp_path)]) == 1
    text = said()
    assert f"sweep = '{path}': cannot be read: Permission denied; remedy: see that it is there" in text
    assert f"(from command line: sweep={path})" in text
    assert MADE not in text


@pytest.mark.parametrize("name", ["other.csv", None])
def test_an_error_of_the_machine_that_is_not_known_to_be_of_an_output_is_not_said_to_be(
    name, tmp_path, monkeypatch, said
):
    def failing(*_):
        raise OSError(errno.EIO, "Input/output error", name)

    monkeypatch.setattr(dispatch, "task_of", lambda settings: failing)
    assert main(["task=simulate", *SMALL, *place(tmp_path)]) == 1
    text = said()
    assert "cannot be read or written: Input/output error" in text
    assert MADE not in text
    assert name is None or f"file = '{name}'" in text


@pytest.mark.parametrize("key", ["measurement.path", "checkpoint"])
def test_a_file_whose_digest_cannot_be_taken_is_an_input(key, tmp_path):
    folder = run_folder.RunFolder(tmp_path / "run", {}, Origin())
    with pytest.raises(InputError) as raised:
        folder.add_inputs([tmp_path / "gone.csv"], key)
    [problem] = raised.value.problems
    assert (problem.key, problem.value) == (key, str(tmp_path / "gone.csv"))
    assert problem.rule == "cannot be read: No such file or directory"


READING = {"yaml": read_yaml, "table": read_table, "digest": lambda path: Files(path.parent, MAX_BYTES).sha256(path)}


@pytest.mark.parametrize("reader", READING)
def test_a_measured_file_that_the_machine_does_not_give_is_an_input(reader, tmp_path, monkeypatch):
    """Root may read everything: what the machine says is put in the place of a missing right."""
    path = tmp_path / ("measurement.yaml" if reader == "yaml" else "a.csv")
    path.write_text("t,x\n0,1\n1,2\n")

    def refused(self, *_, **__):
        raise PermissionError(errno.EACCES, "Permission denied", str(self))

    for name in ("open", "read_bytes", "read_text"):
        monkeypatch.setattr(type(path), name, refused)
    with pytest.raises(InputError, match=r"cannot be read: Permission denied"):
        READING[reader](path)


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
