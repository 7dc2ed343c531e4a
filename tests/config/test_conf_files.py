"""Every file of conf/ composes and passes the check."""

import pytest

from gear_damping.config.locate import conf_folder, groups
from gear_damping.config.settings import read_settings
from gear_damping.tasks.composed import composed

NETWORKS = ("both", "cwt_lstm", "raw_lstm", "record_cwt_lstm")  # of conf/model: these are trained
CHOICES = [(group, choice) for group, choices in groups().items() for choice in choices]


@pytest.mark.parametrize(("group", "choice"), CHOICES)
def test_choice_is_valid(group, choice):
    overrides = [f"{group}={choice}"]
    if choice == "oscillator":
        overrides += ["family=none", "++task=simulate"]
    if choice == "none" and group == "family":
        overrides += ["++simulator.damping_law=null"]
    if group == "model" and choice not in NETWORKS:
        overrides += ["++task=identify", "measurement=ship_roll_21337"]
    if group == "measurement" and choice != "none":
        overrides += ["++task=identify"]
    if group == "explain":
        overrides += ["++task=explain", "measurement=silverbox"]
    if group == "plan" or choice == "plan":
        overrides += ["++task=plan"]
    settings = read_settings(*composed(overrides))
    assert settings.simulator.n_runs >= 1
    assert (settings.plan is not None) == (settings.task == "plan")


def test_every_experiment_begins_with_its_command():
    for path in (conf_folder() / "experiment").glob("*.yaml"):
        lines = path.read_text().splitlines()
        assert lines[0] == "# @package _global_"
        assert lines[1].startswith("# python -m gear_damping")
        assert f"experiment={path.stem}" in lines[1]


def test_the_measurements_that_come_along_are_found():
    for choice in groups()["measurement"]:
        settings = read_settings(*composed([f"measurement={choice}", *(["task=identify"] if choice != "none" else [])]))
        assert choice == "none" or settings.measurement_path.is_file()
