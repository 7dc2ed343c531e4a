"""The folder of a sweep: that of the same command where it was cut off, never that of another."""

from dataclasses import replace

import pytest

from gear_damping.tasks.sweep import folder as place
from gear_damping.tasks.sweep.folder import place_of, problem_with_place, read_sweep, sweep_of, unfinished

COMMAND = ["experiment=noise", "++simulator.load_noise.snr_db=10,20,30", "++seed=0,1"]


@pytest.fixture
def sweep():
    return sweep_of(COMMAND)


def test_a_sweep_knows_its_keys_and_jobs(sweep):
    assert sweep.keys == ["simulator.load_noise.snr_db", "seed"]
    assert sweep.jobs == 6
    assert sweep_of(["model=glob(*)", "++seed=0,1"]).jobs is None


def test_what_changes_no_number_makes_no_other_sweep(sweep):
    more = ["hydra/launcher=joblib", "hydra.launcher.n_jobs=2", "++progress=false", "++data_folder=elsewhere"]
    assert sweep.is_same(sweep_of([*COMMAND, *more]))
    assert not sweep.is_same(sweep_of([*COMMAND, "++training.patience=3"]))


def test_the_newest_folder_that_was_cut_off_is_gone_on_with(sweep, tmp_path):
    for name, kept in {
        "1": sweep,
        "2": sweep,
        "3": replace(sweep, complete=True),
        "4": replace(sweep, version="another"),
        "5": sweep_of(["++seed=0,1"]),
    }.items():
        kept.write(tmp_path / "noise" / name)
    assert unfinished(sweep, tmp_path) == tmp_path / "noise" / "2"
    assert unfinished(sweep_of(["++seed=0,1,2"]), tmp_path) is None


def test_a_note_that_was_cut_off_is_none(tmp_path):
    (tmp_path / place.NOTE).write_text('{"overrides": [')
    assert read_sweep(tmp_path) is None


def test_a_folder_of_another_sweep_is_refused_with_the_remedy(sweep, tmp_path):
    assert problem_with_place(sweep, tmp_path) is None
    sweep.write(tmp_path)
    assert problem_with_place(sweep, tmp_path) is None
    other = problem_with_place(sweep_of(["++seed=0,1"]), tmp_path)
    assert (other.key, other.rule) == ("hydra.sweep.dir", "holds another sweep")
    assert "another folder" in other.remedy
    later = problem_with_place(replace(sweep, version="another"), tmp_path)
    assert later.rule == "holds this sweep by another version"


def test_the_folder_that_a_command_names_is_the_last_one():
    assert place_of(COMMAND) is None
    assert place_of([*COMMAND, "hydra.sweep.dir=a", "hydra.sweep.dir=b"]) == "b"
