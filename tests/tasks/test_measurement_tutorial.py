"""The tutorial of docs/measurement.md as a reader follows it: its files written, its commands run in their order."""

import json
import os
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

from gear_damping.measurement.files import DATA_VARIABLE, data_root
from gear_damping.measurement.load import load_measurement
from gear_damping.tasks.command import main

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "measurement.md").read_text(encoding="utf-8")
TUTORIAL, GEARS = PAGE.split("<!-- reference: begin")[0].split("## A gear pair")
YAML_FILE = Path("swing/measurement.yaml")
SLOW = "task=explain"
pytestmark = [
    pytest.mark.real_record,
    pytest.mark.skipif(
        not data_root().is_dir(),
        reason=f"the measured records are not at {data_root()}; set GEAR_DAMPING_DATA to their folder",
    ),
]


def steps():
    """The indented commands and the content of the fenced YAML, in the order of the page."""
    found = []
    for number, part in enumerate(TUTORIAL.split("```")):
        if number % 2:  # a fence
            found += [("yaml", part.removeprefix("yaml\n"))] if part.startswith("yaml\n") else []
        else:
            found += [("command", line.strip()) for line in part.splitlines() if line.startswith("    ")]
    return found


def follow(command):
    """Run one command of the page; the shell's own ones by what they do."""
    words = shlex.split(os.path.expandvars(command))
    if words[0] == "mkdir":
        Path(words[1]).mkdir()
    elif words[0] == "cp":
        shutil.copy(words[1], words[2])
    else:
        assert words[:3] == ["python", "-m", "gear_damping"], command
        assert main([*words[3:], "progress=false"]) == 0, command


@pytest.fixture
def reader(tmp_path, monkeypatch):
    """Follows the page in an empty folder, without what is slow unless asked."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(DATA_VARIABLE, str(data_root()))

    def read(slow):
        for kind, content in steps():
            if kind == "yaml":
                YAML_FILE.write_text(content)
            elif slow or SLOW not in content:
                follow(content)
        return tmp_path / "swing"

    return read


def metrics(folder):
    return json.loads((folder / "run.json").read_text())["metrics"]


def test_the_page_has_its_steps():
    kinds = [content.split()[0] if kind == "command" else kind for kind, content in steps()]
    assert kinds == ["mkdir", "cp", "python", "yaml", "python", "python", "python"]


def test_the_commands_of_the_tutorial_run_and_give_what_it_says(reader):
    swing = reader(slow=False)
    told = (swing / "inspected" / "inspection.txt").read_text()
    shown = re.search(r"```\n(q3_10.*?)```", TUTORIAL, re.DOTALL)[1]
    assert told.startswith(shown)
    assert (swing / "inspected" / "measurement.yaml").read_text().count('"???"') == 1
    assert metrics(swing / "declared") == {"system": "oscillator", "records": 2, "data_problems": 0}
    found = metrics(swing / "identified")
    frequency = f"{found['natural_frequency_hz']:.3f}".lstrip("0")
    assert f"{found['damping_ratio_percent']:.1f} % (9.8 … 10.8) at {frequency} Hz" in TUTORIAL
    for part in ("fit", "holdout"):
        assert f"{1000 * found[f'rmse_{part}']:.1f} mV" in TUTORIAL


def test_the_gear_pair_of_the_page_is_read_as_it_says(tmp_path):
    """Its files are made up: a steady turn, and counts of two encoders that mesh without any error."""
    (tmp_path / "measurement.yaml").write_text(GEARS.split("```")[1].removeprefix("yaml\n"))
    time = np.arange(2000) / 25e3
    table = {"te": 5 + np.sin(2 * np.pi * 23 * 1100 / 60 * time)}
    write_csv(tmp_path / "steady.csv", table)
    turns = 20 * time
    counts = {"count1": np.floor(turns * 2**20), "count2": np.floor(turns * 23 / 41 * 2**20)}
    write_csv(tmp_path / "encoders.csv", {"t": time, "T1": 60 + time} | counts)
    steady, encoders = load_measurement(tmp_path / "measurement.yaml").records
    np.testing.assert_allclose(steady.channels["transmission_error"].values, 1e-6 * table["te"], rtol=1e-12)
    assert steady.conditions["pinion_speed"].value == pytest.approx(1100 * np.pi / 30, rel=1e-12)
    assert {"transmission_error", "pinion_angle", "pinion_torque"} <= set(encoders.channels)
    assert (steady.gear_torque_mode, encoders.gear_torque_mode) == ("balanced", "balanced")
    assert (steady.role, encoders.role) == ("fit", "holdout")


def write_csv(path, table):
    rows = np.column_stack(list(table.values()))
    np.savetxt(path, rows, delimiter=",", header=",".join(table), comments="", fmt="%.17g")


@pytest.mark.slow
def test_the_tutorial_ends_in_its_verdict(reader):
    swing = reader(slow=True)
    assert "`verdict: consistent`" in TUTORIAL
    assert metrics(swing / "explained")["verdict"] == "consistent"
    assert (swing / "explained" / "report.html").exists()
