"""What is answered without the libraries that simulate and learn: seen by which modules a fresh process has loaded."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HEAVY = ("torch", "lightning", "torchdiffeq")
WRONG = """system: oscillator
records:
  - file: decay.csv
    chanels:
      time: {column: time, unit: s}
      displacement: {column: x, unit: mmm}
  - file: decay.csv
    channels:
      time: {column: time, unit: s}
      displacement: {column: x, unit: mmm}
"""


def answered(commands, folder):
    """Exit codes of commands that one fresh process runs, what it says, and which heavy modules it has at the end."""
    code = f"""
import sys
from gear_damping.tasks.command import main
codes = [main(words) for words in {commands!r}]
print("codes", codes, "loaded", [name for name in {HEAVY!r} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert "Traceback" not in done.stderr
    return done.stdout.splitlines()[-1], done.stderr, list(folder.glob("run*"))


@pytest.fixture(scope="module")
def wrong(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wrong")
    path = folder / "measurement.yaml"
    path.write_text(WRONG)
    places = [f"measurement.path={path}", f"hydra.run.dir={folder / 'run'}"]
    tasks = ["identify", "explain", "inspect"]
    return path, answered([[f"task={task}", *places] for task in tasks], folder)


def test_a_wrong_yaml_is_answered_before_torch_is_imported(wrong):
    _, (last, _, _) = wrong
    assert last == "codes [1, 1, 1] loaded []"


def test_a_wrong_yaml_is_answered_as_a_whole_and_leaves_nothing(wrong):
    path, (_, said, left) = wrong
    answers = said.split("This cannot run, ")[1:]
    assert len(answers) == 3
    assert len(set(answers)) == 1  # every task says the same
    for words in (
        "2 problems:",
        f"- records[0].chanels: unknown key; remedy: did you mean 'channels'? (from {path})",
        "- records[1].channels.displacement.unit: unknown unit 'mmm'; remedy: did you mean 'mm'?",
    ):
        assert words in answers[0]
    assert left == []


def test_a_yaml_that_is_no_yaml_is_answered_too(tmp_path):
    (tmp_path / "a.yaml").write_text("system: [oscillator\n")
    (tmp_path / "b.yaml").write_bytes(b"system: \xff\xfe\n")
    (tmp_path / "c.wav").write_bytes(b"RIFF\xff\xfe")
    commands = [["task=explain", f"measurement.path={tmp_path / name}"] for name in ("a.yaml", "b.yaml", "c.wav")]
    last, said, _ = answered([*commands, ["task=inspect", "seed=-1"]], tmp_path)
    assert last == "codes [1, 1, 1, 1] loaded []"
    assert f"remedy: of a file of data, task=inspect measurement.path={tmp_path / 'c.wav'} writes one" in said
    assert "not valid YAML at line 2, column 1" in said
    assert "save it as UTF-8 (invalid start byte)" in said
    assert "remedy: save it as UTF-8" in said
    assert f"(from command line: measurement.path={tmp_path}" in said
    assert "seed = -1: " in said
    assert "task=inspect needs a measurement; remedy: measurement.path=PATH/FILE" in said


@pytest.mark.slow
def test_a_sweep_over_measurements_is_not_refused_for_its_first(tmp_path):
    (tmp_path / "a.yaml").write_text(WRONG)
    (tmp_path / "b.csv").write_text("time,x\n" + "".join(f"{k / 100},{k % 7 - 3}\n" for k in range(99)))
    swept = f"measurement.path={tmp_path / 'a.yaml'},{tmp_path / 'b.csv'}"
    last, said, _ = answered([["--multirun", "task=inspect", swept, f"hydra.sweep.dir={tmp_path / 'out'}"]], tmp_path)
    assert last.startswith("codes [1] ")
    assert "unknown key" in said
    assert (tmp_path / "out" / "1" / "measurement.yaml").exists()


def entered(words):
    """What a fresh process says of a command, its exit code, and whether it has imported Hydra."""
    code = f"""
import sys
from gear_damping.__main__ import entry
try:
    entry({words!r})
except SystemExit as stop:
    print("code", stop.code, "hydra", "hydra" in sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    return done.stdout.splitlines()[-1], done.stderr


def test_a_wrong_yaml_is_answered_before_hydra_is_imported(wrong):
    path, (_, said, _) = wrong
    last, early = entered(["task=explain", f"measurement.path={path}"])
    assert last == "code 1 hydra False"
    assert early == f"This cannot run, {said.split('This cannot run, ')[1]}"  # what the whole configuration says too


@pytest.mark.parametrize(
    ("word", "also"), [("sede=3", "sede"), ("--cfgg", "--cfgg"), ("hydra.run.dir={}/run", "hydra.run.dir")]
)
def test_what_else_is_wrong_beside_a_wrong_yaml_is_said_too(wrong, word, also):
    last, said = entered(["task=explain", f"measurement.path={wrong[0]}", word.format(wrong[0])])
    assert last == "code 1 hydra True"
    assert also in said


def test_a_file_that_is_no_yaml_names_the_command_line_as_its_source(tmp_path):
    (tmp_path / "b.yaml").write_bytes(b"system: \xff\xfe\n")
    last, said = entered(["task=explain", f"measurement.path={tmp_path / 'b.yaml'}"])
    assert last == "code 1 hydra False"
    assert f"(from command line: measurement.path={tmp_path / 'b.yaml'})" in said
