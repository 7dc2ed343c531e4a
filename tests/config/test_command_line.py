"""Words of a command: what they stand for, and the remedy where one cannot be taken."""

import pytest

from gear_damping.config.command_line import read_command_line


@pytest.mark.parametrize(
    ("key", "is_offered"),
    [
        ("simulator.pinion_speed_rpm", False), ("simulator.backlash.gap_um", False), ("seed", False),
        ("simulator.pitch_error.values", True), ("simulator.torque_variation.step_times_ms", True),
        ("plan.speeds_rpm", True), ("plan.wanted_percent", False), ("evaluation.snr_db", True), ("figures", True),
        ("model.names", True), ("simulator.plugins", True), ("nothing.such.key", False), ("plan", False),
    ],
)  # fmt: skip
def test_a_list_is_offered_for_keys_that_take_one(key, is_offered):
    (problem,) = read_command_line([f"{key}=1000,2000"]).problems
    assert "several values" in problem.rule
    assert ("[a,b]" in problem.remedy) == is_offered
    assert "add --multirun (-m) for a sweep" in problem.remedy


def test_a_key_that_is_given_again_with_another_value_is_said():
    typed = read_command_line(["task=inspect", "seed=1", "measurement.path=a.csv", "measurement.path=b.csv", "seed=1"])
    assert typed.overruled == ("measurement.path is given 2 times: the last, b.csv, counts",)
    assert typed.overrides == ("++task=inspect", "++measurement.path=b.csv", "++seed=1")


def test_a_swept_key_that_is_given_again_with_one_value_is_swept_no_more():
    typed = read_command_line(["-m", "simulator.n_runs=2,3", "simulator.n_runs=4", "seed=1,2"])
    assert typed.overrides == ("++simulator.n_runs=4", "++seed=1,2")
