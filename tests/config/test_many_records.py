"""A folder or a pattern as `measurement.path` of a sweep."""

from pathlib import Path

import pytest

from gear_damping.config.command_line import parse, read_command_line
from gear_damping.tasks.command import main


@pytest.fixture
def folder(tmp_path):
    for name in ("b/measurement.yaml", "a c/measurement.yaml", "it's/measurement.yaml", "a c/other.yaml", "x.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    return tmp_path


def paths(value, *more):
    """The paths of the jobs, as Hydra gives them to each."""
    found = read_command_line(["--multirun", "task=explain", f"measurement.path={value}", *more])
    assert not found.problems
    (override,) = (one for one in found.overrides if "measurement.path" in one)
    parsed = parse(override)
    values = parsed.sweep_string_iterator() if parsed.is_sweep_override() else [override.partition("=")[2]]
    return [parse(f"key={one}").value() for one in values]


def test_a_folder_stands_for_every_measurement_below_it(folder):
    assert paths(folder) == [str(folder / name / "measurement.yaml") for name in ("a c", "b", "it's")]
    assert paths(f"'{folder}'") == paths(folder)


def test_a_folder_without_one_stands_for_its_yaml_files(folder):
    for path in folder.glob("*/measurement.yaml"):
        path.unlink()
    assert paths(folder / "a c") == [str(folder / "a c" / "other.yaml")]


def test_a_pattern_stands_for_the_files_that_match(folder):
    assert paths(f"{folder}/*/*.yaml") == sorted(map(str, folder.glob("*/*.yaml")))
    assert paths(f"{folder}/?.csv") == [str(folder / "x.csv")]


def test_what_stands_for_none_is_left_as_it_is_and_a_folder_of_one_run_is_told_of_sweeps(folder, caplog):
    (folder / "empty").mkdir()
    for value in ("empty", "*.mat"):
        assert paths(f"{folder}/{value}") == [f"{folder}/{value}"]
    assert main(["task=explain", f"measurement.path={folder}"]) == 1
    assert "is a folder, no file; remedy: give the path of a measurement.yaml, or --multirun" in caplog.text
    assert main(["task=explain", f"measurement.path={folder}/*.csv"]) == 1
    assert "or --multirun for a job for each file that matches" in caplog.text


def test_a_list_and_a_name_that_no_file_can_bear_are_left_to_others(folder):
    assert paths("a.yaml,b.yaml") == ["a.yaml", "b.yaml"]
    assert paths("x" * 5000) == ["x" * 5000]


def test_a_path_with_a_comma_is_one_path_of_one_run_and_two_of_a_sweep():
    one = read_command_line(["task=inspect", "measurement.path=runs/5,5Nm.yaml", "hydra.run.dir=out,5"])
    assert "runs/5,5Nm.yaml" in {parse(word).value() for word in one.overrides if "measurement.path" in word}
    assert "out,5" in {parse(word).value() for word in one.overrides if "hydra.run.dir" in word}
    many = read_command_line(["--multirun", "task=inspect", "measurement.path=a.yaml,b.yaml"])
    assert any(parse(word).is_sweep_override() for word in many.overrides if "measurement.path" in word)


def test_a_path_may_begin_at_home():
    words = read_command_line(["task=inspect", "measurement.path=~/a.yaml", "hydra.run.dir=~/b (1)"]).overrides
    read = {parse(word).key_or_group: parse(word).value() for word in words}
    assert read["measurement.path"] == f"{Path.home()}/a.yaml"
    assert read["hydra.run.dir"] == f"{Path.home()}/b (1)"
