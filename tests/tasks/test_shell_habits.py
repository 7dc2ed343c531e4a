"""What a user of a shell tries first: completion, help, and the configuration as it will run."""

import os
import subprocess
import sys

import pytest
import yaml

from gear_damping.config.keys import TASKS
from gear_damping.config.locate import groups
from gear_damping.tasks.command import help_text, main


def asked(words, line):
    """What the shell is offered after a line."""
    environment = {**os.environ, "COMP_LINE": line, "COMP_POINT": str(len(line))}
    command = [sys.executable, "-m", "gear_damping", *words]
    found = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return found.stdout


def test_the_shell_completes_an_experiment():
    offered = asked(["-sc", "query=bash"], "gear-damping experiment=").split()
    assert set(offered) == {f"experiment={name}" for name in groups()["experiment"]}
    assert "experiment=backlash" in offered


def test_completion_is_for_the_installed_script(capfd):
    assert main(["-sc", "install=bash"]) == 0
    assert capfd.readouterr().out.rstrip().endswith("-F hydra_bash_completion gear-damping")


@pytest.mark.parametrize("words", [["-sc"], ["-sc", "install=tcsh"], ["--shell-completion", "query=bash", "seed=1"]])
def test_another_word_for_completion_ends_in_one_message(words, caplog):
    assert main(words) == 1
    assert "takes one word: install=bash, or fish or zsh; remedy: eval" in caplog.text
    assert "Traceback" not in caplog.text


def test_help_names_every_task_group_and_choice():
    words = help_text().replace(",", " ").split()
    assert {*TASKS, *groups(), *(choice for choices in groups().values() for choice in choices)} <= set(words)
    assert help_text().count("  python -m gear_damping ") >= 5


QUICK = ["--cfg", "job", "--resolve"]


@pytest.mark.parametrize(
    ("task", "more"),
    [("train", []), ("simulate", ["simulator.backlash.gap=80um"]), ("evaluate", ["checkpoint=FILE"]),
     ("identify", ["measurement.path=FILE"]), ("explain", ["measurement.path=FILE"]), ("plan", ["experiment=plan"]),
     ("inspect", ["measurement.path=FILE"]), ("paper", ["experiment=paper_figures"]), ("collect", ["sweep=FOLDER"])],
)  # fmt: skip
def test_what_will_run_is_printed(task, more, tmp_path, capfd):
    file = tmp_path / "measurement.yaml"
    channels = "channels: {displacement: {column: x, unit: m}}"
    file.write_text(f"system: oscillator\nrecords:\n- {{file: a.csv, sampling_rate: 1 kHz, {channels}}}\n")
    words = [word.replace("FILE", str(file)).replace("FOLDER", str(tmp_path)) for word in more]
    assert main([f"task={task}", *words, *QUICK]) == 0
    shown = yaml.safe_load(capfd.readouterr().out)
    assert shown["task"] == task
    assert "${" not in str(shown)
    assert set(groups()) - {"experiment"} <= set(shown)


def test_what_cannot_run_is_not_printed_and_said_as_when_it_is_run(tmp_path, caplog, capfd):
    wrong = ["simulator.backlash.gap=80xx", "seeds=0"]
    assert main([*wrong, f"hydra.run.dir={tmp_path / 'run'}"]) == 1
    said = caplog.text
    caplog.clear()
    assert main([*wrong, *QUICK]) == 1
    assert caplog.text == said
    assert "80xx" in said
    assert not capfd.readouterr().out


def test_a_sweep_cannot_be_shown_as_one_job(caplog):
    assert main(["--multirun", "seed=0,1", *QUICK]) == 1
    assert "--multirun: runs many jobs, and --cfg shows one" in caplog.text


def test_who_reads_the_first_lines_alone_gets_no_traceback():
    command = f"{sys.executable} -m gear_damping --help | head -n 1"
    found = subprocess.run(command, shell=True, capture_output=True, text=True, timeout=60)
    assert found.stdout.count("\n") == 1
    assert "Traceback" not in found.stderr
